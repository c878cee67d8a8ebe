// The equilibrium of one instant with effects in it, also where they depend on the shape that they cause.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "extended_model.h"
#include "held_places.h"
#include "softarm/rod/solver.h"

namespace softarm::model {

/// How finely an arm is cut, and what is looked at: as the effects in it ask.
struct Mesh {
  int pieces = FineRod::kPieces;
  bool strains = true;      ///< the pieces' middles are part of its shapes
  double settled_m = 1e-7;  ///< change of the stations at which a shape agrees with what it causes

  /// What these effects need, for shapes that are right to `settled_m`.
  static Mesh of(const std::vector<Present>& effects, double settled_m);
};

/// To which positions along a rod of pieces are integrated, over its length, by an estimate that is several
/// times too large: far below what is seen of bodies, and the same in all predictions.
constexpr double kIntegrated = 1e-5;

/// How a shape answers what it causes; kept from one instant to the next, where it changes little.
struct Feedback {
  double share = 1.0;   ///< of what follows that is assumed next
  double answer = 1.0;  ///< share of a change of the shape by which it changes anew; 1: not known
  bool mixes = false;   ///< it answered so much that shapes had to be mixed
  Eigen::MatrixXd compliance_m_per_n = {};  ///< of the places that are held; empty: not known
};

class InstantSolver {
 public:
  explicit InstantSolver(const arm::Arm& arm, const Mesh& mesh = {});

  /// What one instant is solved with.
  struct Context {
    const arm::Arm& arm;
    const std::vector<Memory>& memories;
    const Dynamics& dynamics;
    const Motion& motion;
    Feedback& feedback;
    /// What stands in for what the laws make of the inputs, one per segment of the arm; nullptr: nothing
    /// does.
    const std::vector<arm::SegmentPrediction>* given = nullptr;
  };

  /// The rod that laws, effects and dynamics make of an instant.
  /// @param held of places, with what forces; nullptr: with those that belong to `shape`
  /// @return false where the inputs lie beyond the laws
  bool make(const arm::Arm& arm, const std::vector<Present>& effects, const std::vector<Memory>& memories,
            const Dynamics& dynamics, const Instant& instant, const Shape* shape, const Motion& motion,
            rod::Rod& out, const std::vector<arm::SegmentPrediction>* given = nullptr,
            const Eigen::VectorXd* held = nullptr);
  /// The equilibrium of now.instant: its shape and tip; `rod` and `values` are left as they belong to it.
  /// @param start the tip's orientation, believed to be near, or nullptr
  /// @param near a shape believed to be near, or nullptr
  bool settle(const Context& at, const std::vector<Present>& effects, const Eigen::Quaterniond* start,
              const Shape* near, Predicted& now);

  /// The arm's bodies on the last solution, before effects move where they are seen.
  void bodies_of_solution(Bodies& out) const;

  FineRod fine;
  std::vector<arm::MeasuredBody> bodies;
  /// Stations: the bodies, the pieces' ends, the base.
  rod::Solver values;
  rod::Rod rod;

 private:
  static std::vector<double> stations(const arm::Arm& arm, const FineRod& fine);
  static rod::SolverOptions options(const arm::Arm& arm, const Mesh& mesh);
  void shape_of_solution(const Motion& motion, Shape& shape) const;
  bool solve(const Eigen::Quaterniond* start);
  /// Assumes a shape and sees what it causes, until both agree.
  bool agree(const Context& at, const std::vector<Present>& effects, Shape assumed, Predicted& now);
  /// The same by taking for granted what followed, where that soon ends: most springs are soft.
  bool agree_at_once(const Context& at, const std::vector<Present>& effects, Predicted& now);
  /// The same where places are held, by Newton's method on the forces that hold them: however stiff a wall
  /// is. What else needs the shape must be soft.
  /// @param forces_n to begin with; those that were found
  bool agree_by_forces(const Context& at, const std::vector<Present>& effects, const HeldPlaces& places,
                       Eigen::VectorXd& forces_n, Predicted& now);
  /// From now.shape and now.q_tip: by forces where places are held, and else, or where that fails and they
  /// are not all that needs the shape, by mixing.
  bool agree_from(const Context& at, const std::vector<Present>& effects, const HeldPlaces& places,
                  Eigen::VectorXd forces_n, Predicted& now);
  /// With places held by these forces, from now.q_tip: positions of the places, m; empty where there is no
  /// equilibrium.
  Eigen::VectorXd hold(const Context& at, const std::vector<Present>& effects, const HeldPlaces& places,
                       const Eigen::VectorXd& forces_n, const Predicted& now, Shape& followed);
  /// How the places yield to forces there, m/N, by differences; empty where there is no equilibrium.
  Eigen::MatrixXd yielding(const Context& at, const std::vector<Present>& effects, const HeldPlaces& places,
                           const Eigen::VectorXd& forces_n, const Eigen::VectorXd& positions_m,
                           const Predicted& now);

  const Mesh mesh_;
};

}  // namespace softarm::model
