#include "effect.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softarm::model {
namespace {

constexpr double kNoCorrelation = 1e-9;  // one that is smaller is round-off of none

}  // namespace

std::vector<Values> Effect::grid(const arm::Arm&, const FineRod&) const {
  const Info& i = info();
  Values values = Values::Zero(static_cast<Eigen::Index>(i.parameters.size()));
  for (std::size_t k = static_cast<std::size_t>(i.sizes); k < i.parameters.size(); ++k)
    values[static_cast<Eigen::Index>(k)] = i.parameters[k].usual;
  return {values};
}

Eigen::Vector3d position_at(const FineRod& fine, const rod::Rod& rod, const Shape& shape, double s_m) {
  const std::vector<Piece>& pieces = fine.pieces();
  std::size_t j = 0;
  while (j + 1 < pieces.size() && s_m > pieces[j].s_to_m) ++j;
  const rod::RodState& end = shape.stations[j];
  const double h = pieces[j].s_to_m - pieces[j].s_from_m,
               x = std::clamp((s_m - pieces[j].s_from_m) / h, 0.0, 1.0);
  const Eigen::Vector3d p0 = j > 0 ? shape.stations[j - 1].p : rod.p_base;
  const Eigen::Vector3d t0 =
      j > 0 ? Eigen::Vector3d((shape.stations[j - 1].q * shape.stations[j - 1].v).normalized())
            : Eigen::Vector3d(rod.q_base * Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d t1 = (end.q * end.v).normalized();
  // Of an arc with that chord: the derivative by x.
  const double arc = (end.p - p0).norm() * (1.0 + (t1 - t0).squaredNorm() / 24.0);
  const Eigen::Vector3d d0 = arc * t0, d1 = arc * t1;
  const double x2 = x * x, x3 = x2 * x;
  return (2.0 * x3 - 3.0 * x2 + 1.0) * p0 + (x3 - 2.0 * x2 + x) * d0 + (3.0 * x2 - 2.0 * x3) * end.p +
         (x3 - x2) * d1;
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
