#include <algorithm>
#include <map>

#include "marker_bodies.h"

namespace softarm {
namespace {

constexpr std::size_t kFewestForAPose = 3;
constexpr double kLeastSpreadM = 1e-3;

/// A body and the markers that make it up.
struct Body {
  int index;
  std::vector<arm::LabelledMarker> markers;
  bool has_places;
};

Body body_of(const arm::Arm& arm, const std::string& name, int index) {
  const auto& markers = index == trial::FrameAssembler::kBaseBody
                            ? arm.base.labelled_markers
                            : arm.bodies.at(static_cast<std::size_t>(index)).labelled_markers;
  if (markers.empty()) return {index, {{name, std::nullopt}}, false};
  return {index, markers, markers.front().p_body.has_value()};
}

/// Points seen, and where they sit on the body; the first reason why one is not seen.
struct Seen {
  std::vector<Eigen::Vector3d> p_mocap, p_body;
  const char* lost = nullptr;
  double server_s = 0.0;  // sum
  std::size_t with_time = 0;
};

using ByLabel = std::map<std::string, const ReportedMarker*>;

ByLabel by_label(const std::vector<ReportedMarker>& markers) {
  ByLabel found;
  for (const ReportedMarker& marker : markers) {
    for (const std::string& label : marker.labels) {
      const auto [entry, is_new] = found.emplace(label, &marker);
      if (!is_new) entry->second = nullptr;  // two answer to it
    }
  }
  return found;
}

Seen look(const Body& body, const ByLabel& markers) {
  Seen seen;
  const auto lose = [&](const char* reason) {
    if (!seen.lost) seen.lost = reason;
  };
  for (const arm::LabelledMarker& wanted : body.markers) {
    const auto found = markers.find(wanted.label);
    if (found == markers.end()) {
      lose("not_reported");
      continue;
    }
    const ReportedMarker* marker = found->second;
    if (!marker) {
      lose("ambiguous_label");
    } else if (marker->lost) {
      lose(marker->lost);
    } else if (!marker->p_mocap.allFinite()) {
      lose("nan");
    } else if (marker->p_mocap.isZero(0.0)) {
      lose("all_zero");
    } else {
      seen.p_mocap.push_back(marker->p_mocap);
      seen.p_body.push_back(wanted.p_body.value_or(Eigen::Vector3d::Zero()));
      if (marker->server_s) {
        seen.server_s += *marker->server_s;
        ++seen.with_time;
      }
    }
  }
  return seen;
}

/// Whether the points leave no turn about a line open.
bool spreads(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    if ((p - points.front()).norm() > along.norm()) along = p - points.front();
  }
  return std::any_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
    return along.normalized().cross(p - points.front()).norm() > kLeastSpreadM;
  });
}

/// The body's pose by least squares (Umeyama 1991) and the rms misfit, m.
Eigen::Isometry3d fitted(const Seen& seen, double* rms_m) {
  const auto count = static_cast<Eigen::Index>(seen.p_body.size());
  Eigen::Matrix3Xd from(3, count), to(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    from.col(i) = seen.p_body[static_cast<std::size_t>(i)];
    to.col(i) = seen.p_mocap[static_cast<std::size_t>(i)];
  }
  const Eigen::Isometry3d pose(Eigen::umeyama(from, to, false));
  *rms_m = std::sqrt(((pose * from) - to).squaredNorm() / static_cast<double>(count));
  return pose;
}

Eigen::Vector3d centroid(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

}  // namespace

MarkerSink labelled_bodies(const arm::Arm& arm, const arm::BodySource& source, const Bodies& bodies) {
  std::vector<Body> wanted;
  for (const auto& [name, index] : bodies) wanted.push_back(body_of(arm, name, index));
  return [wanted, source](trial::Stamp stamp, const std::vector<ReportedMarker>& markers,
                          trial::FrameAssembler& assembler) {
    const ByLabel labels = by_label(markers);
    for (const Body& body : wanted) {
      const Seen seen = look(body, labels);
      const bool by_server = source.stamp == arm::StampSource::kServer && seen.with_time > 0;
      const trial::Stamp when = by_server ? seen.server_s / static_cast<double>(seen.with_time) : stamp;
      if (!body.has_places) {
        if (seen.lost) {
          assembler.add_missing_body(body.index, when, seen.lost);
        } else {
          assembler.add_body(body.index, when, centroid(seen.p_mocap), std::nullopt);
        }
        continue;
      }
      if (seen.p_mocap.size() < kFewestForAPose || !spreads(seen.p_body)) {
        assembler.add_missing_body(body.index, when, seen.lost ? seen.lost : "too_few_markers");
        continue;
      }
      double rms_m = 0.0;
      const Eigen::Isometry3d pose = fitted(seen, &rms_m);
      if (rms_m <= source.marker_tolerance_m) {
        assembler.add_body(body.index, when, pose.translation(), Eigen::Quaterniond(pose.linear()));
      } else {
        assembler.add_missing_body(body.index, when, "markers_misfit");
      }
    }
  };
}

}  // namespace softarm
