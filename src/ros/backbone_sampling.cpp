#include "backbone_sampling.h"

#include <algorithm>

namespace softarm {

estimate::BackbonePoint backbone_at(const std::vector<estimate::BackbonePoint>& backbone,
                                    double arclength_m) {
  const auto after =
      std::upper_bound(backbone.begin(), backbone.end(), arclength_m,
                       [](double s, const estimate::BackbonePoint& point) { return s < point.arclength_m; });
  if (after == backbone.begin()) return backbone.front();
  if (after == backbone.end()) return backbone.back();
  const estimate::BackbonePoint& a = *(after - 1);
  const estimate::BackbonePoint& b = *after;
  const double u = (arclength_m - a.arclength_m) / (b.arclength_m - a.arclength_m);
  // The arm may be longer than at zero input: tangents are scaled to the distance that is really there.
  const double length_m = (b.p_base - a.p_base).norm();
  const Eigen::Vector3d ta = length_m * (a.q_base * Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d tb = length_m * (b.q_base * Eigen::Vector3d::UnitZ());
  const double u2 = u * u;
  const double u3 = u2 * u;
  estimate::BackbonePoint point;
  point.arclength_m = arclength_m;
  point.p_base = (2 * u3 - 3 * u2 + 1) * a.p_base + (u3 - 2 * u2 + u) * ta + (3 * u2 - 2 * u3) * b.p_base +
                 (u3 - u2) * tb;
  point.q_base = a.q_base.slerp(u, b.q_base);
  point.curvature_per_m = (1 - u) * a.curvature_per_m + u * b.curvature_per_m;
  return point;
}

std::vector<estimate::BackbonePoint> resample_backbone(const std::vector<estimate::BackbonePoint>& backbone,
                                                       int count) {
  std::vector<estimate::BackbonePoint> samples;
  const double from = backbone.front().arclength_m;
  const double to = backbone.back().arclength_m;
  for (int i = 0; i < count; ++i)
    samples.push_back(backbone_at(backbone, from + (to - from) * i / (count - 1)));
  return samples;
}

}  // namespace softarm
