// The order of the bodies along the arm, by their distances.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "context.h"
#include "policy.h"
#include "shape.h"

namespace softarm::check {
namespace {

/// How badly an order fits: distances of neighbours, against their spacing. order[k] is the body that takes
/// the k-th place.
double misfit_of(const std::vector<Place>& places, const std::vector<std::size_t>& order) {
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  double last_s = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Eigen::Vector3d& p = places[order[k]].p_base;
    const double spacing = places[k].arclength_m - last_s, chord = (p - last).norm();
    sum += chord > spacing ? std::pow(chord - spacing, 2)
                           : std::pow(kPolicy.tracking.short_chord * (spacing - chord), 2);
    last = p;
    last_s = places[k].arclength_m;
  }
  return sum;
}

void check_order(Context& context) {
  const std::vector<Place> places = places_in(context, shape_span(context));
  const auto ratio = length_ratio(places);
  if (places.size() < 2 || places.size() > kPolicy.geometry.most_permuted || !ratio ||
      *ratio > kPolicy.geometry.most_order || *ratio < kPolicy.geometry.least_order)
    return;
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const double as_is = misfit_of(places, order);
  std::vector<std::size_t> best = order;
  double least = as_is;
  while (std::next_permutation(order.begin(), order.end())) {
    const double m = misfit_of(places, order);
    if (m < least) {
      least = m;
      best = order;
    }
  }
  const double arm_m = places.back().arclength_m;
  if (std::is_sorted(best.begin(), best.end()) ||
      as_is < std::pow(kPolicy.geometry.out_of_order * arm_m, 2) ||
      least > kPolicy.geometry.right_order * as_is)
    return;
  std::string is, fits;
  for (std::size_t k = 0; k < best.size(); ++k) {
    is += (k ? ", " : "") + context.tracks[places[k].track].name;
    fits += (k ? ", " : "") + context.tracks[places[best[k]].track].name;
  }
  CheckFinding& finding = context.add(
      "body_order", "",
      fmt::format(
          "from base to tip the arm file has {}, the recording {}: distances of neighbours are off by "
          "{:.0f} mm (rms), in that order by {:.0f} mm",
          is, fits, 1e3 * std::sqrt(as_is / places.size()), 1e3 * std::sqrt(least / places.size())));
  finding.figure = std::sqrt(as_is / places.size());
  finding.unit = "m";
  finding.remedy = "exchange the names in the mocap software, or the arclengths in the arm file";
  // Entries change their names, and keep their places.
  for (std::size_t k = 0; k < best.size(); ++k) {
    if (best[k] == k) continue;
    finding.setting += fmt::format("{}bodies[{}].name: {}", finding.setting.empty() ? "" : "; ",
                                   places[k].track - 1, context.tracks[places[best[k]].track].name);
  }
  // Everything that follows is about places along the arm: with the names as they should be.
  std::vector<Track> renamed(best.size());
  for (std::size_t k = 0; k < best.size(); ++k) renamed[k] = context.tracks[places[best[k]].track];
  for (std::size_t k = 0; k < best.size(); ++k) {
    Track& track = context.tracks[places[k].track];
    track.poses = renamed[k].poses;
  }
}

}  // namespace

Check make_order() {
  return {check_order, {{"body_order", Severity::kSerious}}};
}

}  // namespace softarm::check
