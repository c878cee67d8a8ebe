// Places of an arm that walls and hoses hold: their forces, found together with the shape, and how those
// answer to a change of it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "effect.h"

namespace softarm::model {

/// What held places add to derivatives of a rod: their forces answer. With D of anything by the rod, D_f by
/// their forces, C and D_x of the places by these and by the rod, K of the forces by the places, it is
/// D_f K (1 - C K)^-1 D_x. P parameters of the rod, n places.
struct HeldAnswer {
  Eigen::MatrixXd forces;  ///< P x 3n, shares: D_f = D forces
  Eigen::MatrixXd answer;  ///< 3n x 3n, K (1 - C K)^-1, N/m; empty: nothing is held
  Eigen::MatrixXd places;  ///< 3n x P, D_x, m per unit of each parameter

  /// @param by_rod derivatives of anything while the forces stay, P columns
  /// @return the same while they answer
  Eigen::MatrixXd added_to(const Eigen::MatrixXd& by_rod) const;
};

/// The places that effects of a model hold (Effect::holds_places), effect by effect. Vectors have three
/// components for each of them: forces, N, and positions, m, rod's base frame.
class HeldPlaces {
 public:
  /// @param effects and memories must outlive it
  HeldPlaces(const FineRod& fine, const std::vector<Present>& effects, const std::vector<Memory>& memories);

  bool empty() const { return holding_.empty(); }
  Eigen::Index size() const { return 3 * static_cast<Eigen::Index>(holding_.size()); }
  void add(const Eigen::VectorXd& forces_n, rod::Rod& rod) const;
  Eigen::VectorXd positions_m(const rod::Rod& rod, const Shape& shape) const;
  /// What holds them where they are.
  Eigen::VectorXd forces_n(const Eigen::VectorXd& positions_m) const;

  /// Derivative of the forces by the positions, N/m.
  Eigen::MatrixXd stiffness_n_per_m(const Eigen::VectorXd& positions_m) const;
  /// How the forces change with how far the places would move if the forces stayed, N/m.
  /// @param compliance_m_per_n by which the places yield to forces there
  Eigen::MatrixXd answer_n_per_m(const Eigen::VectorXd& positions_m,
                                 const Eigen::MatrixXd& compliance_m_per_n) const;
  /// Derivative of positions_m() by the parameters of a solver, see position_by_stations().
  Eigen::MatrixXd positions_by(const rod::Rod& rod, const Shape& shape, const rod::Solver& solver,
                               int first_end) const;
  /// Shares of each place's force that the stations take, and of their displacements in its own: stations x
  /// places.
  Eigen::MatrixXd shares() const;
  /// By how far the places move, by shares(), where the stations do.
  /// @param of_stations three rows per station; a column per mode, say, in its units
  /// @return three rows per place, the same columns
  Eigen::MatrixXd displacements(const Eigen::MatrixXd& of_stations) const;

  /// What they add to the derivatives that a solver has of a rod; empty where nothing is held.
  /// @param columns of FineRod::parameters(), by which the solver differentiates, in its order: forces on
  /// the stations that places share theirs with must be among them
  /// @param first_end as in position_by_stations()
  HeldAnswer answer_by(const rod::Rod& rod, const Shape& shape, const rod::Solver& solver, int first_end,
                       const std::vector<Eigen::Index>& columns) const;

  /// By how much the forces have to change so that places which yield by `compliance_m_per_n` are held by
  /// what belongs to where they then are: Newton's step, exact for laws with kinks.
  /// @param positions_m that the forces `forces_n` make
  Eigen::VectorXd step_n(const Eigen::VectorXd& positions_m, const Eigen::VectorXd& forces_n,
                         const Eigen::MatrixXd& compliance_m_per_n) const;

 private:
  struct Holding {
    const Present* present;
    const Memory* memory;
    std::size_t which;  ///< of the effect's places
    double place_m;
  };
  const FineRod& fine_;
  std::vector<Holding> holding_;
};

}  // namespace softarm::model
