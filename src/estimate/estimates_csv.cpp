#include "estimates_csv.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace softarm::estimate {
namespace {

void append(std::string& row, const std::optional<double>& value) {
  row += ',';
  // NaN never leaves the program: an empty cell is how this file says that there is no value.
  if (value && std::isfinite(*value)) fmt::format_to(std::back_inserter(row), "{:.9g}", *value);
}

}  // namespace

std::optional<double> tip_angle_rad(const Estimate& estimate) {
  if (estimate.backbone.empty()) return std::nullopt;
  const Eigen::Vector3d base = estimate.backbone.front().q_base * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d tip = estimate.backbone.back().q_base * Eigen::Vector3d::UnitZ();
  return std::atan2(base.cross(tip).norm(), base.dot(tip));
}

void write_estimate_rows(std::ostream& out, const Estimate& estimate, std::size_t segments) {
  static const SegmentEstimate kNone;
  std::string rows;
  for (std::size_t i = 0; i < segments; ++i) {
    const bool present = i < estimate.segments.size();
    const SegmentEstimate& s = present ? estimate.segments[i] : kNone;
    fmt::format_to(std::back_inserter(rows), "{:.7f},{},{}", estimate.stamp_s, i + 1,
                   to_string(estimate.status));
    append(rows, s.moment_nm);
    append(rows, s.direction_rad);
    append(rows, s.bending_stiffness_nm2);
    append(rows, s.length_m);
    append(rows, estimate.payload_kg);
    append(rows, s.sd_moment_nm);
    append(rows, s.sd_direction_rad);
    append(rows, s.sd_bending_stiffness_nm2);
    append(rows, s.sd_length_m);
    append(rows, estimate.sd_payload_kg);
    fmt::format_to(std::back_inserter(rows), ",{},{}", s.identifiable_stiffness ? 1 : 0,
                   estimate.identifiable_payload ? 1 : 0);
    append(rows, tip_angle_rad(estimate));
    std::optional<double> x, y, z, rms;
    if (!estimate.backbone.empty()) {
      const Eigen::Vector3d& tip = estimate.backbone.back().p_base;
      x = tip.x();
      y = tip.y();
      z = tip.z();
    }
    if (!estimate.residuals.empty()) rms = estimate.rms_residual_m;
    append(rows, x);
    append(rows, y);
    append(rows, z);
    append(rows, rms);
    rows += '\n';
  }
  out << rows;
}

}  // namespace softarm::estimate
