// The order of the bodies along the arm, by their distances.
#include <fmt/format.h>

#include <Eigen/Core>
#include <optional>

#include "arm/body_order.h"
#include "context.h"
#include "policy.h"
#include "shape.h"

namespace softarm::check {
namespace {

void check_order(Context& context) {
  const std::vector<Place> places = shape_in(context, shape_span(context)).places;
  const auto ratio = length_ratio(places);
  if (!ratio || *ratio > kPolicy.geometry.most_order || *ratio < kPolicy.geometry.least_order) return;
  std::vector<Eigen::Vector3d> p_base;
  std::vector<double> arclength_m;
  for (const Place& place : places) {
    p_base.push_back(place.p_base);
    arclength_m.push_back(place.arclength_m);
  }
  const std::optional<arm::BodyOrder> other = arm::other_order(p_base, arclength_m);
  if (!other) return;
  const std::vector<std::size_t>& best = other->order;
  std::string is, fits;
  for (std::size_t k = 0; k < best.size(); ++k) {
    is += (k ? ", " : "") + context.tracks[places[k].track].name;
    fits += (k ? ", " : "") + context.tracks[places[best[k]].track].name;
  }
  CheckFinding& finding = context.add(
      "body_order", "",
      fmt::format("from base to tip the arm file has {}, the recording {}: distances between neighbours are "
                  "off by {:.0f} mm (rms) in the arm file's order, by {:.0f} mm in the recording's",
                  is, fits, 1e3 * other->as_is_m, 1e3 * other->least_m));
  finding.figure = other->as_is_m;
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
