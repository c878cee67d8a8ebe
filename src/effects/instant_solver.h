// The equilibrium of one instant with effects in it, also where they depend on the shape that they cause.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "softarm/effects/extended_model.h"
#include "softarm/rod/solver.h"

namespace softarm::effects {

class InstantSolver {
 public:
  explicit InstantSolver(const Arm& arm);

  /// What one instant is solved with.
  struct Context {
    const Arm& arm;
    const std::vector<Memory>& memories;
    const Dynamics& dynamics;
    const Motion& motion;
    double& share;  ///< of what follows that is assumed next; kept from one instant to the next
    /// What stands in for what the laws make of the inputs, one per segment of the arm; nullptr: nothing
    /// does.
    const std::vector<SegmentPrediction>* given = nullptr;
  };

  /// The rod that laws, effects and dynamics make of an instant.
  /// @return false where the inputs lie beyond the laws
  bool make(const Arm& arm, const std::vector<Present>& effects, const std::vector<Memory>& memories,
            const Dynamics& dynamics, const Instant& instant, const Shape* shape, const Motion& motion,
            rod::Rod& out, const std::vector<SegmentPrediction>* given = nullptr);
  /// The equilibrium of now.instant: its shape and tip; `rod` and `values` are left as they belong to it.
  /// @param start the tip's orientation, believed to be near, or nullptr
  /// @param near a shape believed to be near, or nullptr
  bool settle(const Context& at, const std::vector<Present>& effects, const Eigen::Quaterniond* start,
              const Shape* near, Predicted& now);

  FineRod fine;
  std::vector<MeasuredBody> bodies;
  /// Stations: the bodies, the pieces' middles, their ends, the base.
  rod::Solver values;
  rod::Rod rod;

 protected:
  static rod::SolverOptions solver_options();
  static std::vector<double> body_stations(const Arm& arm);

 private:
  static std::vector<double> stations(const Arm& arm, const FineRod& fine);
  Shape shape_of_solution(const Motion& motion) const;
  bool solve(const Eigen::Quaterniond* start);
  /// Assumes a shape and sees what it causes, until both agree.
  bool agree(const Context& at, const std::vector<Present>& effects, Shape assumed, Predicted& now);
};

}  // namespace softarm::effects
