#include "body_order.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace softarm::arm {
namespace {

constexpr std::size_t kMostBodies = 7;  // 5040 orders
constexpr double kOutOfOrder = 0.08;    // of the outermost arclength: misfit of a wrong order
constexpr double kRightOrder = 0.1;     // of the squared misfit is left with the right one

/// How badly an order fits: distances of neighbours, against their spacing.
double misfit_of(const std::vector<Eigen::Vector3d>& p_base, const std::vector<double>& arclength_m,
                 const std::vector<std::size_t>& order) {
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  double last_s = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Eigen::Vector3d& p = p_base[order[k]];
    const double spacing = arclength_m[k] - last_s, chord = (p - last).norm();
    sum += chord > spacing ? std::pow(chord - spacing, 2) : std::pow(kShortChord * (spacing - chord), 2);
    last = p;
    last_s = arclength_m[k];
  }
  return sum;
}

}  // namespace

std::optional<BodyOrder> other_order(const std::vector<Eigen::Vector3d>& p_base,
                                     const std::vector<double>& arclength_m) {
  if (p_base.size() < 2 || p_base.size() > kMostBodies) return std::nullopt;
  std::vector<std::size_t> order(p_base.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const double as_is = misfit_of(p_base, arclength_m, order);
  BodyOrder best{order, 0.0, as_is};
  while (std::next_permutation(order.begin(), order.end())) {
    const double misfit = misfit_of(p_base, arclength_m, order);
    if (misfit < best.least_m) best = {order, 0.0, misfit};
  }
  if (std::is_sorted(best.order.begin(), best.order.end()) ||
      as_is < std::pow(kOutOfOrder * arclength_m.back(), 2) || best.least_m > kRightOrder * as_is)
    return std::nullopt;
  const auto count = static_cast<double>(p_base.size());
  best.as_is_m = std::sqrt(as_is / count);
  best.least_m = std::sqrt(best.least_m / count);
  return best;
}

}  // namespace softarm::arm
