#include "estimates_csv.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace softarm::estimate {
namespace {

void append(std::string& cell, const std::optional<double>& value) {
  // NaN never leaves the program: an empty cell is how this file says that there is no value.
  if (value && std::isfinite(*value)) fmt::format_to(std::back_inserter(cell), "{:.9g}", *value);
}

void append_flag(std::string& cell, bool flag) {
  cell += flag ? '1' : '0';
}

void append_tip(std::string& cell, const EstimateRow& row, int axis) {
  if (!row.frame.backbone.empty()) append(cell, row.frame.backbone.back().p_base(axis));
}

}  // namespace

const std::vector<EstimateColumn>& estimate_columns() {
  using Row = EstimateRow;
  using Cell = std::string;
  static const std::vector<EstimateColumn> columns{
      {"stamp", "s", "stamp of the frame, to 1e-7 s: the precision of a double for a date",
       [](Cell& c, const Row& r) { fmt::format_to(std::back_inserter(c), "{:.7f}", r.frame.stamp_s); }},
      {"segment", "", "number of the segment, from 1 at the base",
       [](Cell& c, const Row& r) { c += std::to_string(r.number); }},
      {"status", "", "`ok`, or why the frame has no estimate",
       [](Cell& c, const Row& r) { c += to_string(r.frame.status); }},
      {"M0", "N m", "actuation moment of the segment",
       [](Cell& c, const Row& r) { append(c, r.segment.moment_nm); }},
      {"phi", "rad", "direction in which the segment bends, about the z axis of its base",
       [](Cell& c, const Row& r) { append(c, r.segment.direction_rad); }},
      {"EI", "N m²", "bending stiffness of the segment, estimated or known",
       [](Cell& c, const Row& r) { append(c, r.segment.bending_stiffness_nm2); }},
      {"L", "m", "length of the segment's backbone",
       [](Cell& c, const Row& r) { append(c, r.segment.length_m); }},
      {"payload", "kg", "payload of the arm, estimated or known",
       [](Cell& c, const Row& r) { append(c, r.frame.payload_kg); }},
      {"sd_M0", "N m", "standard deviation of M0; like every sd, empty where the value is not determined",
       [](Cell& c, const Row& r) { append(c, r.segment.sd_moment_nm); }},
      {"sd_phi", "rad", "standard deviation of phi",
       [](Cell& c, const Row& r) { append(c, r.segment.sd_direction_rad); }},
      {"sd_EI", "N m²", "standard deviation of EI; empty where it is known",
       [](Cell& c, const Row& r) { append(c, r.segment.sd_bending_stiffness_nm2); }},
      {"sd_L", "m", "standard deviation of L",
       [](Cell& c, const Row& r) { append(c, r.segment.sd_length_m); }},
      {"sd_payload", "kg", "standard deviation of the payload; empty where it is known",
       [](Cell& c, const Row& r) { append(c, r.frame.sd_payload_kg); }},
      {"identifiable_EI", "", "1: the frame determines EI well enough to use it; 0: it does not",
       [](Cell& c, const Row& r) { append_flag(c, r.segment.identifiable_stiffness); }},
      {"identifiable_payload", "", "the same for the payload",
       [](Cell& c, const Row& r) { append_flag(c, r.frame.identifiable_payload); }},
      {"theta_tip", "rad", "angle between the tangents at the arm's base and tip",
       [](Cell& c, const Row& r) { append(c, tip_angle_rad(r.frame)); }},
      {"tip_x", "m", "x of the tip in the rod's base frame",
       [](Cell& c, const Row& r) { append_tip(c, r, 0); }},
      {"tip_y", "m", "y of the tip", [](Cell& c, const Row& r) { append_tip(c, r, 1); }},
      {"tip_z", "m", "z of the tip", [](Cell& c, const Row& r) { append_tip(c, r, 2); }},
      {"rms_residual", "m", "root mean square distance between measured and estimated bodies, of those used",
       [](Cell& c, const Row& r) {
         if (!r.frame.residuals.empty()) append(c, r.frame.rms_residual_m);
       }},
      {"settling", "", "1: the payload changes or has just changed, and nothing is identifiable; 0: neither",
       [](Cell& c, const Row& r) { append_flag(c, r.frame.settling); }},
  };
  return columns;
}

std::string estimates_csv_header() {
  std::string header;
  for (const EstimateColumn& column : estimate_columns()) {
    if (!header.empty()) header += ',';
    header += column.name;
  }
  return header;
}

std::optional<double> tip_angle_rad(const Estimate& estimate) {
  if (estimate.backbone.empty()) return std::nullopt;
  const Eigen::Vector3d base = estimate.backbone.front().q_base * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d tip = estimate.backbone.back().q_base * Eigen::Vector3d::UnitZ();
  return std::atan2(base.cross(tip).norm(), base.dot(tip));
}

void write_estimate_rows(std::ostream& out, const Estimate& estimate, std::size_t segments) {
  static const SegmentEstimate kNone;
  const std::vector<EstimateColumn>& columns = estimate_columns();
  std::string rows;
  rows.reserve(segments * 16 * columns.size());
  for (std::size_t i = 0; i < segments; ++i) {
    const EstimateRow row{estimate, i < estimate.segments.size() ? estimate.segments[i] : kNone, i + 1};
    for (const EstimateColumn& column : columns) {
      column.append(rows, row);
      rows += ',';
    }
    rows.back() = '\n';
  }
  out << rows;
}

}  // namespace softarm::estimate
