// The solver's state and steps; solver.cpp holds the public side, continuation.cpp how an equilibrium is
// found, solution.cpp what is read from it.
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <utility>
#include <vector>

#include "math/so3.h"
#include "softarm/rod/solver.h"
#include "sweep.h"

namespace softarm::rod {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

inline Matrix3d unknown_lanes(const kernel::Lanes v[3]) {
  Matrix3d m;
  for (int k = 0; k < kUnknownLanes; ++k) m.col(k) = lane(v, k);
  return m;
}

struct Solver::Impl {
  Impl(const Rod& layout, std::vector<double> stations_m, std::vector<Parameter> wanted,
       const SolverOptions& o)
      : options(o),
        parameters(std::move(wanted)),
        sweep(layout, stations_m, parameters, o.max_refinement),
        scaled(layout),
        states(stations_m.size()),
        dp(stations_m.size(), Eigen::Matrix3Xd::Zero(3, static_cast<int>(parameters.size()))),
        drotation(dp),
        drotation_tip(Eigen::Matrix3Xd::Zero(3, static_cast<int>(parameters.size()))),
        dbase(drotation_tip) {
    sweep.set_rod(layout, layout);
    sweep.refine(1);
  }

  enum class Newton { kConverged, kFar, kDiverged };

  /// Newton on the base's orientation with the rod of the last set_rod; q_tip is updated. On kConverged the
  /// last sweep lies within a linear correction (`correction`) of equilibrium.
  /// @param accept_rad a correction below this ends the iteration
  Newton newton(const Quaterniond& q_base, double largest_change, double accept_rad);

  /// Largest rotation of any breakpoint for a rotation of the tip and, unless lane_index is -1, a unit of
  /// that lane. Under large loads the tip hardly turns where the rest does.
  double largest_turn(const Vector3d& tip, int lane_index) const;

  /// False where an odd number of modes is unstable (see Solver::stable).
  bool no_odd_instability() const;

  /// Rotation of the tip per unit of load scale, at the last sweep.
  Vector3d tip_per_load_scale() const;

  /// Newton with as fine a grid as the accuracy asks for. @param position_tolerance over the rod's length
  Newton newton_refined(const Quaterniond& q_base, double largest_change, double accept_rad,
                        double position_tolerance);

  /// Tip orientation of the rod without loads: the product of its arcs.
  Quaterniond unloaded_tip(const Rod& rod) const;

  SolveStatus cold(const Rod& rod);

  /// From `start`, whose tip is near q_start, to `rod`.
  SolveStatus from(const Rod& start, const Quaterniond& q_start, const Rod& rod);

  /// Follows the path of equilibria from t = 0, where the last newton() converged, to t = 1.
  /// @param by_loads the load-scale lane is the path's direction; else the predictor is a secant
  /// @param near_path_rad how near to the path its points on the way must be
  template <typename SetPath>
  SolveStatus follow(const SetPath& set_path, bool by_loads, double near_path_rad);

  void finish(const Rod& rod);

  /// Applies the last Newton correction to the nodes, and moves the rod so that its base lies in p_base.
  void correct_nodes(const Rod& rod);

  void shoot(const Rod& rod);

  void fill_derivatives();

  RodState state(double s, int segment, double flex, const Node& node) const;

  RodState state_at_breakpoint(int k) const;

  SolverOptions options;
  std::vector<Parameter> parameters;
  Sweep sweep;
  Rod scaled;
  double length = 0.0;
  int sweeps = 0;
  double position_error = 0.0;
  Quaterniond q_tip = Quaterniond::Identity();
  Vector3d correction = Vector3d::Zero();
  Matrix3d base_per_tip = Matrix3d::Identity();
  Matrix3d inverse = Matrix3d::Identity();
  std::vector<RodState> states;
  std::vector<Eigen::Matrix3Xd> dp, drotation;
  Eigen::Matrix3Xd drotation_tip;
  Vector3d base_error = Vector3d::Zero();
  Eigen::Matrix3Xd dbase;
};

}  // namespace softarm::rod
