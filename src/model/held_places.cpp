#include "held_places.h"

#include "math/linear_algebra.h"

namespace softarm::model {
namespace {

constexpr int kNewtonSteps = 30;
constexpr int kNewtonHalvings = 20;   // a wall may be a million times as stiff as the arm
constexpr double kLawProbe_m = 1e-7;  // of laws' derivatives
constexpr double kPlaceFound_m = 1e-11;

}  // namespace

Eigen::MatrixXd HeldAnswer::added_to(const Eigen::MatrixXd& by_rod) const {
  if (answer.size() == 0) return by_rod;
  return by_rod + by_rod * forces * (answer * places);
}

HeldPlaces::HeldPlaces(const FineRod& fine, const std::vector<Present>& effects,
                       const std::vector<Memory>& memories)
    : fine_(fine) {
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (!effects[i].effect->holds_places()) continue;
    const std::vector<double> places_m = effects[i].effect->held_places_m(fine, effects[i].values);
    for (std::size_t k = 0; k < places_m.size(); ++k)
      holding_.push_back({&effects[i], &memories[i], k, places_m[k]});
  }
}

void HeldPlaces::add(const Eigen::VectorXd& forces_n, rod::Rod& rod) const {
  for (std::size_t i = 0; i < holding_.size(); ++i)
    fine_.add_force(holding_[i].place_m, forces_n.segment<3>(3 * static_cast<Eigen::Index>(i)), rod);
}

Eigen::VectorXd HeldPlaces::positions_m(const rod::Rod& rod, const Shape& shape) const {
  Eigen::VectorXd positions(size());
  for (std::size_t i = 0; i < holding_.size(); ++i)
    positions.segment<3>(3 * static_cast<Eigen::Index>(i)) =
        position_at(fine_, rod, shape, holding_[i].place_m);
  return positions;
}

Eigen::VectorXd HeldPlaces::forces_n(const Eigen::VectorXd& positions_m) const {
  Eigen::VectorXd forces(size());
  for (std::size_t i = 0; i < holding_.size(); ++i) {
    const Holding& one = holding_[i];
    const auto at = 3 * static_cast<Eigen::Index>(i);
    forces.segment<3>(at) = one.present->effect->holding_force_n(fine_, one.present->values, one.which,
                                                                 positions_m.segment<3>(at), *one.memory);
  }
  return forces;
}

Eigen::MatrixXd HeldPlaces::stiffness_n_per_m(const Eigen::VectorXd& positions_m) const {
  // No force depends on where another place is: all are moved at once.
  const Eigen::VectorXd here = forces_n(positions_m);
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(size(), size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd beside = positions_m;
    for (Eigen::Index i = 0; i < size(); i += 3) beside[i + axis] += kLawProbe_m;
    const Eigen::VectorXd change = forces_n(beside) - here;
    for (Eigen::Index i = 0; i < size(); i += 3)
      slope.block<3, 1>(i, i + axis) = change.segment<3>(i) / kLawProbe_m;
  }
  return slope;
}

Eigen::MatrixXd HeldPlaces::answer_n_per_m(const Eigen::VectorXd& positions_m,
                                           const Eigen::MatrixXd& compliance_m_per_n) const {
  // Places that would move by d move by x = d + compliance stiffness x. At worst the condition of the matrix
  // is the stiffness of a wall over that of the arm.
  const Eigen::MatrixXd stiffness = stiffness_n_per_m(positions_m),
                        one = Eigen::MatrixXd::Identity(size(), size());
  return stiffness * math::least_squares_columns(one - compliance_m_per_n * stiffness, one);
}

Eigen::MatrixXd HeldPlaces::positions_by(const rod::Rod& rod, const Shape& shape, const rod::Solver& solver,
                                         int first_end) const {
  Eigen::MatrixXd by(size(), solver.dp(first_end).cols());
  for (std::size_t i = 0; i < holding_.size(); ++i)
    by.middleRows<3>(3 * static_cast<Eigen::Index>(i)) =
        position_by_stations(fine_, rod, shape, holding_[i].place_m, solver, first_end);
  return by;
}

Eigen::MatrixXd HeldPlaces::shares() const {
  Eigen::MatrixXd list(fine_.stations(), static_cast<Eigen::Index>(holding_.size()));
  for (std::size_t i = 0; i < holding_.size(); ++i)
    for (int j = 0; j < fine_.stations(); ++j)
      list(j, static_cast<Eigen::Index>(i)) = fine_.share(holding_[i].place_m, j);
  return list;
}

Eigen::MatrixXd HeldPlaces::displacements(const Eigen::MatrixXd& of_stations) const {
  const Eigen::MatrixXd share = shares();
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(size(), of_stations.cols());
  for (Eigen::Index i = 0; i < share.cols(); ++i)
    for (Eigen::Index j = 0; j < share.rows(); ++j)
      if (share(j, i) > 0.0) by.middleRows<3>(3 * i) += share(j, i) * of_stations.middleRows<3>(3 * j);
  return by;
}

HeldAnswer HeldPlaces::answer_by(const rod::Rod& rod, const Shape& shape, const rod::Solver& solver,
                                 int first_end, const std::vector<Eigen::Index>& columns) const {
  HeldAnswer held;
  if (empty()) return held;
  const Eigen::MatrixXd share = shares();
  held.forces.setZero(static_cast<Eigen::Index>(columns.size()), size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const rod::Parameter& parameter = fine_.parameters()[static_cast<std::size_t>(columns[c])];
    if (parameter.kind != rod::ParameterKind::kLoadForce) continue;
    for (Eigen::Index i = 0; i < share.cols(); ++i)
      held.forces(static_cast<Eigen::Index>(c), 3 * i + parameter.component) =
          share(parameter.index - FineRod::kFirstStation, i);
  }
  held.places = positions_by(rod, shape, solver, first_end);
  held.answer = answer_n_per_m(positions_m(rod, shape), held.places * held.forces);
  return held;
}

Eigen::VectorXd HeldPlaces::step_n(const Eigen::VectorXd& positions_m, const Eigen::VectorXd& forces_n,
                                   const Eigen::MatrixXd& compliance_m_per_n) const {
  // x = positions + compliance (law(x) - forces), by Newton's method with a search along its direction.
  const auto off = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return x - positions_m - compliance_m_per_n * (this->forces_n(x) - forces_n);
  };
  Eigen::VectorXd x = positions_m, error = off(x);
  for (int step = 0; step < kNewtonSteps && error.lpNorm<Eigen::Infinity>() > kPlaceFound_m; ++step) {
    const Eigen::MatrixXd slope =
        Eigen::MatrixXd::Identity(size(), size()) - compliance_m_per_n * stiffness_n_per_m(x);
    const Eigen::VectorXd direction = math::least_squares(slope, -error);
    if (!direction.allFinite()) break;
    double share = 1.0;
    Eigen::VectorXd next = x + direction, next_error = off(next);
    for (int i = 0; i < kNewtonHalvings && next_error.norm() >= error.norm(); ++i) {
      share *= 0.5;
      next = x + share * direction;
      next_error = off(next);
    }
    if (next_error.norm() >= error.norm()) break;
    x = next;
    error = next_error;
  }
  return this->forces_n(x) - forces_n;
}

}  // namespace softarm::model
