// The ends of the unknowns' ranges: fits may come to rest there, and first-order steps must not pass them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "joint_model.h"

namespace softarm::diagnose {

/// Range of an unknown's move, in scales.
struct Room {
  double low = 0.0, high = 0.0;
};
std::vector<Room> rooms_of(const Linearised& at);

/// The least of s - 2 g x + x H x within the rooms, by active sets (Stark and Parker 1995, bounded-variable
/// least squares).
/// @param information H, positive definite
/// @param rooms each with 0 in it, from where it looks
/// @param move x
double least_within(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient, double square,
                    const std::vector<Room>& rooms, Eigen::VectorXd& move);

/// The unknowns that rest at an end of their range because the trials draw them beyond it.
std::vector<bool> held_at_ends(const Linearised& at);

/// Of those how far inside the range they may be, in scales, as a standard deviation: the likelihood falls
/// off exponentially from the end, or, where the trials hardly draw, as it does about its greatest value. 0
/// of all others.
Eigen::VectorXd spread_at_ends(const Linearised& at);
/// Whether it is one that the trials draw beyond the end by more than a standard deviation.
std::vector<bool> drawn_beyond(const Linearised& at);

/// The information of a fit, its unknowns no further from the ends at which they rest than they may be: what
/// rests there absorbs little of what an effect does.
Eigen::MatrixXd information_within_ranges(const Linearised& at);

/// Takes unknowns for known in the normal equations: they do not move, nor do others on their account.
void hold(const std::vector<bool>& held, Eigen::MatrixXd& information, Eigen::VectorXd& gradient);

}  // namespace softarm::diagnose
