#include "shape.h"

#include <algorithm>
#include <utility>

#include "policy.h"

namespace softarm::check {
namespace {

std::vector<Place> places_in(const Context& context, const CheckSpan& span) {
  std::vector<Place> places;
  const auto base = context.rod_base();
  if (!base) return places;
  const Eigen::Isometry3d from_mocap = base->inverse();
  for (std::size_t b = 1; b < context.tracks.size(); ++b) {
    const Track& track = context.tracks[b];
    if (track.body->kind == arm::BodyKind::kSkinMarker) continue;
    const auto p = track.mean_position(span.from_s, span.to_s);
    if (!p) continue;
    Place place{b, track.arclength_m, from_mocap * *p, std::nullopt};
    if (const auto q = track.mean_orientation(span.from_s, span.to_s)) {
      Eigen::Isometry3d body = Eigen::Isometry3d::Identity();
      body.translation() = *p;
      body.linear() = q->toRotationMatrix();
      const Eigen::Isometry3d section = from_mocap * body * track.body->section_in_body;
      place.p_base = section.translation();
      place.q_base = Eigen::Quaterniond(section.linear()).normalized();
    }
    places.push_back(place);
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.arclength_m < b.arclength_m; });
  return places;
}

}  // namespace

Shape shape_in(const Context& context, const CheckSpan& span) {
  std::vector<Place> all = places_in(context, span);
  Shape shape;
  for (const Place& place : all) {
    const bool far = place.p_base.norm() > context.of_length(kPolicy.geometry.most_ratio);
    (far ? shape.far_away : shape.places).push_back(place);
  }
  const auto ratio = length_ratio(shape.places);
  if (2 * shape.far_away.size() < all.size() && ratio && *ratio < kPolicy.geometry.most_others) return shape;
  return {std::move(all), {}};
}

std::optional<double> length_ratio(const std::vector<Place>& places) {
  if (places.empty() || !(places.back().arclength_m > 0.0)) return std::nullopt;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  double sum = 0.0;
  for (const Place& place : places) {
    sum += (place.p_base - last).norm();
    last = place.p_base;
  }
  return sum / places.back().arclength_m;
}

CheckSpan shape_span(const Context& context) {
  return context.rest().value_or(CheckSpan{0.0, std::min(kPolicy.rest.first_s, context.duration_s)});
}

}  // namespace softarm::check
