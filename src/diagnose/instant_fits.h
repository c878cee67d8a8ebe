// Every instant fitted by itself, as the estimator does: EI, M0, phi and L free in each.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "joint_model.h"

namespace softarm::diagnose {

/// A number of one segment at one instant beside what the arm's laws say.
struct Estimated {
  double value = 0.0, law = 0.0, sd = 0.0;
};

/// What the fit of one instant says of one segment; absent where the instant does not identify it.
struct SegmentFit {
  std::optional<Estimated> stiffness_nm2, moment_nm, direction_rad, length_m;
};

struct InstantFit {
  std::size_t trial = 0, block = 0;
  std::vector<SegmentFit> segments;
  double square = 0.0;  ///< of the distances that are left, each over its standard deviation
  double weight = 0.0;  ///< sum over the bodies of 1 / variance, m^-2
  int rows = 0;         ///< coordinates that were fitted
};

/// How many numbers a fit of one instant has free.
int unknowns_of_instant(const arm::Arm& arm);

/// All used blocks of all trials that can be fitted by themselves, through the same rod. What inertia and the
/// viscoelastic lag do, as `at` has it, is taken off the measured positions first: a still arm is fitted.
/// @param at a fit without effects, whose constants the laws take
std::vector<InstantFit> fit_instants(const JointModel& model, const Linearised& at, unsigned jobs);

}  // namespace softarm::diagnose
