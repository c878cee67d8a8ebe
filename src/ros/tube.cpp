#include "tube.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "conversions.h"

namespace softarm {
namespace {

constexpr int kSides = 24;

struct Corner {
  geometry_msgs::Point p;
  std_msgs::ColorRGBA color;
};

void add_triangle(const Corner& a, const Corner& b, const Corner& c, visualization_msgs::Marker* marker) {
  for (const Corner* corner : {&a, &b, &c}) {
    marker->points.push_back(corner->p);
    marker->colors.push_back(corner->color);
  }
}

}  // namespace

double diameter_at(const arm::Arm& arm, double arclength_m) {
  double end = 0.0;
  for (const arm::Segment& segment : arm.segments) {
    end += segment.length_m;
    if (arclength_m <= end) return segment.diameter_m;
  }
  return arm.segments.back().diameter_m;
}

std_msgs::ColorRGBA shade_color(double shade, float alpha) {
  using Rgb = std::array<double, 3>;
  constexpr std::array<Rgb, 5> kScale{Rgb{0.20, 0.45, 0.95}, Rgb{0.10, 0.75, 0.75}, Rgb{0.45, 0.85, 0.30},
                                      Rgb{0.98, 0.80, 0.20}, Rgb{0.95, 0.25, 0.20}};
  const double at = std::clamp(shade, 0.0, 1.0) * (kScale.size() - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(at), kScale.size() - 2);
  const double u = at - static_cast<double>(low);
  const auto mix = [&](std::size_t i) {
    return static_cast<float>((1.0 - u) * kScale[low][i] + u * kScale[low + 1][i]);
  };
  std_msgs::ColorRGBA color;
  color.r = mix(0);
  color.g = mix(1);
  color.b = mix(2);
  color.a = alpha;
  return color;
}

void add_tube(const std::vector<TubeSection>& sections, float alpha, visualization_msgs::Marker* marker) {
  std::vector<std::array<Corner, kSides>> rims;
  for (const TubeSection& section : sections) {
    std::array<Corner, kSides> rim;
    for (int i = 0; i < kSides; ++i) {
      const double angle = 2.0 * M_PI * i / kSides;
      const Eigen::Vector3d offset(section.radius_m * std::cos(angle), section.radius_m * std::sin(angle),
                                   0.0);
      rim[static_cast<std::size_t>(i)] = {to_point(section.p + section.q * offset),
                                          shade_color(section.shade, alpha)};
    }
    rims.push_back(rim);
  }
  for (std::size_t k = 0; k < rims.size(); ++k) {
    for (std::size_t i = 0; i < kSides; ++i) {
      const std::size_t j = (i + 1) % kSides;
      if (k + 1 < rims.size()) {
        add_triangle(rims[k][i], rims[k][j], rims[k + 1][j], marker);
        add_triangle(rims[k][i], rims[k + 1][j], rims[k + 1][i], marker);
      }
      const Corner centre{to_point(sections[k].p), rims[k][i].color};
      if (k == 0) add_triangle(centre, rims[k][j], rims[k][i], marker);
      if (k + 1 == rims.size()) add_triangle(centre, rims[k][i], rims[k][j], marker);
    }
  }
}

}  // namespace softarm
