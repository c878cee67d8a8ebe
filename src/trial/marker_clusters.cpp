#include "marker_clusters.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace softarm::trial {
namespace {

constexpr double kRadiusToleranceM = 0.0015;
constexpr double kRadiusToleranceRel = 0.03;
constexpr double kSmallestArea = 0.25;  // of the triangle, in radii squared: a flatter one gives no centre

struct Circle {
  Eigen::Vector3d centre;
  double radius_m;
  double area_m2;
};

/// Circumscribed circle of a triangle.
std::optional<Circle> circumcircle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                   const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = b - a, v = c - a, normal = u.cross(v);
  const double n2 = normal.squaredNorm();
  if (!(n2 > 1e-18)) return {};
  const Eigen::Vector3d to_centre =
      (u.squaredNorm() * v.cross(normal) + v.squaredNorm() * normal.cross(u)) / (2.0 * n2);
  return Circle{a + to_centre, to_centre.norm(), 0.5 * std::sqrt(n2)};
}

}  // namespace

std::vector<Place> clusters_through(const std::vector<Eigen::Vector3d>& points, int markers, double radius_m,
                                    int kind) {
  const double tolerance_m = std::max(kRadiusToleranceM, kRadiusToleranceRel * radius_m);
  const double widest_m = 2.0 * (radius_m + tolerance_m);
  const int count = static_cast<int>(points.size());
  const auto at = [&](int i) -> const Eigen::Vector3d& { return points[static_cast<std::size_t>(i)]; };
  std::vector<Place> places;
  std::vector<int> triangles;  // that each place is the mean of
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      if ((at(i) - at(j)).norm() > widest_m) continue;
      for (int k = j + 1; k < count; ++k) {
        if ((at(i) - at(k)).norm() > widest_m || (at(j) - at(k)).norm() > widest_m) continue;
        const auto circle = circumcircle(at(i), at(j), at(k));
        if (!circle || std::abs(circle->radius_m - radius_m) > tolerance_m ||
            circle->area_m2 < kSmallestArea * radius_m * radius_m) {
          continue;
        }
        std::size_t same = 0;
        while (same < places.size() && (places[same].p - circle->centre).norm() > 2.0 * tolerance_m) ++same;
        if (same == places.size()) {
          places.push_back({Eigen::Vector3d::Zero(), {}, kind});
          triangles.push_back(0);
        }
        Place& place = places[same];
        place.p = (place.p * triangles[same] + circle->centre) / (triangles[same] + 1);
        ++triangles[same];
        for (int point : {i, j, k}) {
          if (std::find(place.points.begin(), place.points.end(), point) == place.points.end())
            place.points.push_back(point);
        }
      }
    }
  }
  // A circle of chance through markers of a fuller one is none.
  const auto is_part = [&](const Place& place) {
    return std::any_of(places.begin(), places.end(), [&](const Place& other) {
      return other.points.size() > place.points.size() && share_a_point(place, other);
    });
  };
  std::vector<Place> good;
  for (const Place& place : places) {
    if (static_cast<int>(place.points.size()) <= markers && !is_part(place)) good.push_back(place);
  }
  return good;
}

}  // namespace softarm::trial
