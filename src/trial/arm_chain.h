// How well points fit the arm's backbone, from its base to its tip, whatever it is doing.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace softarm::trial {

/// A place where a body may be: a marker, or the centre of a marker cluster.
struct Place {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< mocap frame, m
  std::vector<int> points;                      ///< the markers that it is made of
  int kind = 0;                                 ///< bodies take places of their own kind only
};

/// A body of the chain, in the order of the backbone.
struct ChainBody {
  double arclength_m = 0.0;
  double off_axis_m = 0.0;  ///< how far from the backbone the body's origin may be
  int kind = 0;
};

/// Per body: index of its place, or -1.
using Choice = std::vector<int>;

struct ChainLimits {
  double stretch = 0.35;
  double ambiguity = 6.0;
  double missing_cost = 12.0;
};

/// Whether two places have a marker in common.
bool share_a_point(const Place& a, const Place& b);

/// Cost, -2 ln of a likelihood up to a constant, of bodies at places: each link's length against the chord of
/// the arc that the turn of the links implies, the turns, and how curvature changes from link to link. The
/// soft limits are wide (10 % of length, 1.2 rad per link), because the arm may bend under any load.
/// @return nothing if two bodies are further apart than the stretched backbone, or the arm would fold
std::optional<double> chain_cost(const Eigen::Isometry3d& rod_base, const std::vector<ChainBody>& bodies,
                                 const std::vector<Place>& places, const Choice& choice,
                                 const ChainLimits& limits);

struct ChainAnswer {
  Choice choice;                ///< what all nearly best answers agree on
  std::vector<bool> ambiguous;  ///< they disagree on this body
};

/// Completes `known` (-1: to be found) by branch and bound over all places that are still free. What the best
/// answer and all those within `ambiguity` of it agree on is returned. A search that would take too long
/// finds nothing and calls everything ambiguous.
ChainAnswer find_chain(const Eigen::Isometry3d& rod_base, const std::vector<ChainBody>& bodies,
                       const std::vector<Place>& places, const Choice& known, const ChainLimits& limits);

}  // namespace softarm::trial
