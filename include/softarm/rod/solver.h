// Statics of a Rod: the one forward model.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <vector>

#include "softarm/export.h"
#include "softarm/rod/rod.h"

namespace softarm::rod {

enum class SolveStatus {
  kConverged,
  kNoConvergence,  ///< no equilibrium was reached; the solution holds nothing that may be used
  kInvalidInput,   ///< non-finite or negative values in the rod
};

/// State of the rod at one s, in the world frame.
struct RodState {
  double s_m = 0.0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d n = Eigen::Vector3d::Zero();   ///< internal force, N
  Eigen::Vector3d m = Eigen::Vector3d::Zero();   ///< internal moment, N m
  Eigen::Vector3d u = Eigen::Vector3d::Zero();   ///< curvature and twist, section frame, 1/m
  Eigen::Vector3d v = Eigen::Vector3d::UnitZ();  ///< shear and extension, section frame
};

struct SolverOptions {
  double orientation_tolerance_rad = 1e-10;  ///< base orientation error of a converged solution
  /// A Newton correction below this (of tip and base) is applied to the last sweep to first order instead of
  /// sweeping again.
  double linear_correction_rad = 1e-5;
  double position_tolerance =
      1e-7;                        ///< integration error of positions over the rod's length; refines the grid
  int max_refinement = 32;         ///< largest subdivision of the grid
  int max_newton_iterations = 12;  ///< per continuation step
  double largest_tip_change_rad = 0.8;  ///< a warm start whose tip turns further is reached by continuation
  double smallest_continuation_step = 1e-4;
  int max_sweeps = 300;  ///< of one continuation
};

/// Solves the statics by shooting from the tip.
///
/// 1. The tip's internal force and moment are known loads, so the three unknowns are the orientation of the
/// tip.
/// 2. Integrate (Runge-Kutta, order 8, over short steps 5) to the base, with the derivatives by the unknowns
/// and by the wanted parameters
///    in the same stages.
/// 3. Newton on the base's orientation. Close to the start of a warm solve this is one or two sweeps.
/// 4. If Newton would leave the neighbourhood of the start, follow the path of equilibria instead: from the
/// start's rod,
///    or from the unloaded rod, to this one, with steps as large as stay on the branch.
/// 5. Error estimate of the integration; refine the grid where it is too large.
///
/// All memory is allocated by the constructor. Not thread-safe.
class SOFTARM_EXPORT Solver {
 public:
  /// @param layout fixes the number of segments and loads, rest lengths, profiles and places of loads; values
  /// may change
  /// @param stations_m values of s at which positions and derivatives are wanted, any order, within the rod
  /// @param parameters what to differentiate by, in the order of the columns
  /// @throws std::invalid_argument for stations or loads off the rod, or an empty rod
  Solver(const Rod& layout, std::vector<double> stations_m, std::vector<Parameter> parameters,
         const SolverOptions& options = {});
  ~Solver();
  Solver(Solver&&) noexcept;
  Solver& operator=(Solver&&) noexcept;

  /// Cold: continuation from the unloaded rod, unless the loads are so small that Newton stays near it.
  SolveStatus solve(const Rod& rod);
  /// Warm: Newton from a tip orientation believed to be near. `from`, if given, is the rod that belongs to
  /// it, used for continuation when the tip turns out to be far; without it there is none, and too far is
  /// kNoConvergence.
  SolveStatus solve(const Rod& rod, const Eigen::Quaterniond& q_tip, const Rod* from = nullptr);

  /// One integration from a given tip orientation, without asking for the base's: the equilibrium of a rod
  /// whose base is turned by base_error(). Never fails for finite values; for fits that approach the boundary
  /// condition and the measurements together. Afterwards dp() and drotation() hold the tip fixed; dp_by_tip()
  /// and base_per_tip_rotation() are by its rotation.
  SolveStatus shoot(const Rod& rod, const Eigen::Quaterniond& q_tip);
  /// Rotation vector (world frame) from the wanted to the obtained base orientation.
  const Eigen::Vector3d& base_error() const;
  /// d base_error / d parameters at fixed tip (3 x P), up to the curvature of SO(3).
  Eigen::Ref<const Eigen::Matrix3Xd> dbase() const;
  /// d position of station i / d rotation of the tip.
  Eigen::Matrix3d dp_by_tip(int i) const;

  // The rest is valid after a kConverged solve, until the next.

  int stations() const;
  const RodState& station(int i) const;
  const Eigen::Quaterniond& q_tip() const;
  /// d position of station i / d parameters (3 x P), at equilibrium.
  Eigen::Ref<const Eigen::Matrix3Xd> dp(int i) const;
  /// Rotation vector (world frame) by which station i turns per unit of each parameter (3 x P).
  Eigen::Ref<const Eigen::Matrix3Xd> drotation(int i) const;
  /// The same of the tip: predicts q_tip for a change of parameters.
  Eigen::Ref<const Eigen::Matrix3Xd> drotation_tip() const;
  /// The state at any s in [0, rest length], to the accuracy of the solution. At a point load: the proximal
  /// side.
  RodState at(double s_m) const;
  /// Turn of the base per turn of the tip at fixed loads; singular at a buckling load.
  const Eigen::Matrix3d& base_per_tip_rotation() const;
  /// False if a conjugate point lies on the rod: the equilibrium is a saddle of the potential energy (dead
  /// loads).
  bool stable() const;
  int sweeps() const;      ///< integrations done by the last solve
  int refinement() const;  ///< subdivision of the grid in use

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softarm::rod
