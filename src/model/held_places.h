// Places of an arm that walls and hoses hold: their forces, found together with the shape.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "effect.h"

namespace softarm::model {

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
