#include "effect.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "math/so3.h"

namespace softarm::model {
namespace {

constexpr double kNoCorrelation = 1e-9;  // one that is smaller is round-off of none

/// A place on a piece: the cubic from the piece's begin (0) to its end (1), whose derivatives there have the
/// length of an arc with that chord.
struct OnPiece {
  OnPiece(const FineRod& fine, const rod::Rod& rod, const Shape& shape, double s_m) {
    const std::vector<Piece>& pieces = fine.pieces();
    while (piece + 1 < pieces.size() && s_m > pieces[piece].s_to_m) ++piece;
    const rod::RodState& end = shape.stations[piece];
    const double h = pieces[piece].s_to_m - pieces[piece].s_from_m,
                 x = std::clamp((s_m - pieces[piece].s_from_m) / h, 0.0, 1.0);
    p0 = piece > 0 ? shape.stations[piece - 1].p : rod.p_base;
    t0 = piece > 0 ? Eigen::Vector3d((shape.stations[piece - 1].q * shape.stations[piece - 1].v).normalized())
                   : Eigen::Vector3d(rod.q_base * Eigen::Vector3d::UnitZ());
    p1 = end.p;
    t1 = (end.q * end.v).normalized();
    arc = (p1 - p0).norm() * (1.0 + (t1 - t0).squaredNorm() / 24.0);
    const double x2 = x * x, x3 = x2 * x;
    of_p0 = 2.0 * x3 - 3.0 * x2 + 1.0;
    of_d0 = x3 - 2.0 * x2 + x;
    of_p1 = 3.0 * x2 - 2.0 * x3;
    of_d1 = x3 - x2;
  }
  std::size_t piece = 0;
  Eigen::Vector3d p0, t0, p1, t1;  ///< ends, and tangents there
  double arc, of_p0, of_d0, of_p1, of_d1;
};

}  // namespace

std::vector<Values> Effect::grid(const arm::Arm&, const FineRod&) const {
  const Info& i = info();
  Values values = Values::Zero(static_cast<Eigen::Index>(i.parameters.size()));
  for (std::size_t k = static_cast<std::size_t>(i.sizes); k < i.parameters.size(); ++k)
    values[static_cast<Eigen::Index>(k)] = i.parameters[k].usual;
  return {values};
}

Eigen::Vector3d position_at(const FineRod& fine, const rod::Rod& rod, const Shape& shape, double s_m) {
  const OnPiece at(fine, rod, shape, s_m);
  return at.of_p0 * at.p0 + at.of_d0 * (at.arc * at.t0) + at.of_p1 * at.p1 + at.of_d1 * (at.arc * at.t1);
}

Eigen::Matrix3Xd position_by_stations(const FineRod& fine, const rod::Rod& rod, const Shape& shape,
                                      double s_m, const rod::Solver& solver, int first_end) {
  const OnPiece at(fine, rod, shape, s_m);
  const int end = first_end + static_cast<int>(at.piece);
  const Eigen::Matrix3Xd p1 = solver.dp(end), t1 = -math::skew(at.t1) * solver.drotation(end);
  Eigen::Matrix3Xd p0 = Eigen::Matrix3Xd::Zero(3, p1.cols()), t0 = p0;
  if (at.piece > 0) {
    p0 = solver.dp(end - 1);
    t0 = -math::skew(at.t0) * solver.drotation(end - 1);
  }
  const Eigen::Vector3d chord = at.p1 - at.p0, turn = at.t1 - at.t0;
  const Eigen::RowVectorXd arc = at.arc / chord.squaredNorm() * (chord.transpose() * (p1 - p0)) +
                                 chord.norm() / 12.0 * (turn.transpose() * (t1 - t0));
  return at.of_p0 * p0 + at.of_p1 * p1 + at.arc * (at.of_d0 * t0 + at.of_d1 * t1) +
         (at.of_d0 * at.t0 + at.of_d1 * at.t1) * arc;
}

std::vector<Present> in_order(std::vector<Present> effects) {
  std::stable_sort(effects.begin(), effects.end(),
                   [](const Present& a, const Present& b) { return a.effect->rank() < b.effect->rank(); });
  return effects;
}

void observe(const arm::Arm& arm, const std::vector<Present>& effects, const Instant& instant,
             Bodies& bodies) {
  for (const Present& present : effects) {
    if (present.effect->observes()) present.effect->observe(arm, present.values, instant, bodies);
  }
}

double correlation(const Present& a, Eigen::Index i, const Present& b, Eigen::Index j) {
  const bool of_one_list = a.correlated.cols() == b.correlated.cols();
  if (!of_one_list || i >= a.correlated.rows() || j >= b.correlated.rows()) return 0.0;
  const double product = a.correlated.row(i).dot(b.correlated.row(j));
  return std::abs(product) > kNoCorrelation ? std::clamp(product, -1.0, 1.0) : 0.0;
}

}  // namespace softarm::model
