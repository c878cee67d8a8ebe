#include "labels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "conversions.h"
#include "tube.h"

namespace softarm {
namespace {

using visualization_msgs::Marker;

constexpr double kLabelLifetime_s = 0.5;
constexpr double kWaitingLifetime_s = 2.5;  // it comes once a second
constexpr std::size_t kWaitingWidth = 44;
constexpr double kTextHeight = 0.052, kLineHeight = 0.085;  // of the arm's length
constexpr const char* kUsualPrefix = "softarm";
// The key's heights above its middle and its distance from the arm, of the arm's length.
constexpr double kBarFrom = -0.12, kBarTo = 0.28, kBarRadius = 0.016, kKeyAside = 1.0;
constexpr int kBarSections = 24;

Marker label(const char* ns, const Eigen::Vector3d& at, const MessageContext& context) {
  Marker m;
  m.header.frame_id = context.frames.mocap;
  m.header.stamp = context.stamp;
  m.ns = ns;
  m.type = Marker::TEXT_VIEW_FACING;
  m.action = Marker::ADD;
  m.pose = to_pose(at, Eigen::Quaterniond::Identity());
  m.scale.x = m.scale.y = 1.0;
  m.scale.z = kTextHeight * context.arm.total_length_m();
  m.color = color(1, 1, 1, 1);
  m.lifetime = ros::Duration(kLabelLifetime_s);
  return m;
}

/// Against gravity; up in the mocap frame where there is none.
Eigen::Vector3d up_of(const arm::Arm& arm) {
  return arm.gravity_m_s2.norm() > 0.0 ? Eigen::Vector3d(-arm.gravity_m_s2.normalized())
                                       : Eigen::Vector3d::UnitZ();
}

bool is_level(const Eigen::Vector3d& along, const Eigen::Vector3d& up) {
  return std::abs(along.dot(up)) < 0.5;
}

/// Middle of the key: on the left in the views of rviz/, clear of the arm.
Eigen::Vector3d key_at(const Eigen::Isometry3d& base_in_mocap, const arm::Arm& arm) {
  const Eigen::Vector3d along = base_in_mocap.linear().col(2);
  const double unit_m = arm.total_length_m();
  if (is_level(along, up_of(arm))) return base_in_mocap.translation() - 0.35 * unit_m * along;
  const Eigen::Vector3d left(std::sin(0.9), -std::cos(0.9), 0.0);  // the views' yaw
  return base_in_mocap.translation() + unit_m * (0.5 * along + kKeyAside * left);
}

std::string stiffness_text(const estimate::SegmentEstimate& segment, bool known) {
  const auto& ei = segment.bending_stiffness_nm2;
  if (known && ei) return fmt::format("EI {:.3g} mN m² (known)", 1e3 * *ei);
  if (!segment.identifiable_stiffness || !ei || !segment.sd_bending_stiffness_nm2)
    return "EI not identifiable";
  return fmt::format("EI {} mN m²", plus_minus(1e3 * *ei, 1e3 * *segment.sd_bending_stiffness_nm2));
}

/// A value that has a standard deviation where the frame determines it.
std::string value_text(const char* name, std::optional<double> value, std::optional<double> sd, double scale,
                       const char* unit) {
  if (!value || !sd) return fmt::format("{} not determined", name);
  return fmt::format("{} {}{}", name, plus_minus(scale * *value, scale * *sd), unit);
}

std::string segment_text(const estimate::SegmentEstimate& segment, const std::string& name, bool known,
                         const char* between) {
  constexpr double kDegrees = 180.0 / M_PI;
  std::string first = name + stiffness_text(segment, known);
  if (segment.moment_nm)
    first += "   " + (segment.identifiable_moment
                          ? value_text("M0", segment.moment_nm, segment.sd_moment_nm, 1e3, " mN m")
                          : std::string("M0 not identifiable"));
  return first + between + value_text("φ", segment.direction_rad, segment.sd_direction_rad, kDegrees, "°") +
         "   " + value_text("L", segment.length_m, segment.sd_length_m, 1e3, " mm") + "\n";
}

}  // namespace

std_msgs::ColorRGBA color(double r, double g, double b, double a) {
  std_msgs::ColorRGBA c;
  c.r = static_cast<float>(r);
  c.g = static_cast<float>(g);
  c.b = static_cast<float>(b);
  c.a = static_cast<float>(a);
  return c;
}

std::string plus_minus(double value, double sd) {
  if (!(sd > 0.0) || !std::isfinite(sd)) return fmt::format("{:.3g}", value);
  double unit = std::pow(10.0, std::floor(std::log10(sd)) - 1.0);
  if (std::round(sd / unit) >= 100.0) unit *= 10.0;
  const int places = std::max(0, static_cast<int>(-std::lround(std::log10(unit))));
  const auto rounded = [&](double x) { return std::round(x / unit) * unit + 0.0; };
  return fmt::format("{:.{}f} ± {:.{}f}", rounded(value), places, rounded(sd), places);
}

std::string in_lines(const std::string& words, std::size_t width) {
  std::string text;
  std::size_t line = 0;
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t end = std::min(words.find(' ', at), words.size());
    if (line > 0 && line + end - at >= width) {
      text += '\n';
      line = 0;
    } else if (line > 0) {
      text += ' ';
      ++line;
    }
    text += words.substr(at, end - at);
    line += end - at;
    at = end + 1;
  }
  return text;
}

std::string estimate_text(const estimate::Estimate& estimate, const arm::Arm& arm,
                          const arm::EstimatorOptions& options) {
  if (estimate.status != estimate::Status::kOk) {
    return in_lines(
        "no estimate: " + (estimate.detail.empty() ? to_string(estimate.status) : estimate.detail),
        kWaitingWidth);
  }
  std::string lines;
  for (std::size_t i = 0; i < estimate.segments.size(); ++i) {
    const bool several = estimate.segments.size() > 1;  // a line each, one segment has two
    lines += segment_text(estimate.segments[i], several ? arm.segments.at(i).name + ": " : "",
                          options.unknown == arm::Unknown::kPayload, several ? "   " : "\n");
  }
  if (options.unknown == arm::Unknown::kStiffness && estimate.payload_kg)
    return lines + fmt::format("payload {:.1f} g (known)", 1e3 * *estimate.payload_kg);
  if (estimate.identifiable_payload && estimate.payload_kg && estimate.sd_payload_kg)
    return lines +
           fmt::format("payload {} g", plus_minus(1e3 * *estimate.payload_kg, 1e3 * *estimate.sd_payload_kg));
  return lines + "payload not identifiable";
}

std::vector<Marker> text_lines(const std::string& words, bool trouble, const Eigen::Isometry3d& base_in_mocap,
                               const MessageContext& context) {
  const std::string& prefix = context.frames.prefix;
  std::istringstream text((prefix.empty() || prefix == kUsualPrefix ? "" : prefix + "\n") + words);
  std::vector<Marker> lines;
  for (std::string line; std::getline(text, line);) {
    lines.push_back(label("text", Eigen::Vector3d::Zero(), context));
    lines.back().id = static_cast<int>(lines.size()) - 1;
    lines.back().text = line;
    if (trouble) lines.back().color = color(1.0, 0.35, 0.3, 1.0);
  }
  // From where the arm does not reach: behind its base, above it where it is level.
  const double unit_m = context.arm.total_length_m();
  const Eigen::Vector3d along = base_in_mocap.linear().col(2), up = up_of(context.arm);
  const bool level = is_level(along, up), stands = along.dot(up) > 0.5;
  const Eigen::Vector3d nearest = base_in_mocap.translation() +
                                  unit_m * (level ? Eigen::Vector3d(0.5 * along + 0.45 * up) : -0.12 * along);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double above = stands ? -static_cast<double>(i) : static_cast<double>(lines.size() - 1 - i);
    lines[i].pose = to_pose(nearest + above * kLineHeight * unit_m * up, Eigen::Quaterniond::Identity());
  }
  return lines;
}

std::vector<Marker> key_markers(double most_per_m, const Eigen::Isometry3d& base_in_mocap,
                                const MessageContext& context) {
  const double unit_m = context.arm.total_length_m();
  const Eigen::Vector3d middle = key_at(base_in_mocap, context.arm), up = up_of(context.arm);
  Marker bar = label("scale", middle, context);
  bar.type = Marker::TRIANGLE_LIST;
  bar.scale.z = 1.0;
  const Eigen::Quaterniond upright = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), up);
  std::vector<TubeSection> sections;
  for (int i = 0; i <= kBarSections; ++i) {
    const double share = static_cast<double>(i) / kBarSections;
    sections.push_back(
        {unit_m * (kBarFrom + share * (kBarTo - kBarFrom)) * up, upright, kBarRadius * unit_m, share});
  }
  add_tube(sections, 1.0f, &bar);
  std::vector<Marker> markers{bar};
  const auto add = [&](const char* ns, double height, const std::string& words,
                       const std_msgs::ColorRGBA& c) {
    markers.push_back(label(ns, middle + height * unit_m * up, context));
    markers.back().text = words;
    markers.back().color = c;
    markers.back().id = static_cast<int>(markers.size());
  };
  add("scale", kBarTo + 0.15, "curvature", color(1, 1, 1, 1));
  add("scale", kBarTo + 0.06, fmt::format("{:.3g} 1/m", most_per_m), color(1, 1, 1, 1));
  add("scale", kBarFrom - 0.06, "0", color(1, 1, 1, 1));
  add("legend", kBarFrom - 0.2, "measured", kMeasuredColor);
  add("legend", kBarFrom - 0.29, "estimated", kEstimatedColor);
  add("legend", kBarFrom - 0.38, "payload", kPayloadColor);
  return markers;
}

visualization_msgs::MarkerArray waiting_markers(const std::string& words,
                                                const Eigen::Isometry3d& base_in_mocap,
                                                const MessageContext& context) {
  visualization_msgs::MarkerArray array;
  array.markers = text_lines(in_lines(words, kWaitingWidth), true, base_in_mocap, context);
  for (Marker& m : array.markers) m.lifetime = ros::Duration(kWaitingLifetime_s);
  return array;
}

}  // namespace softarm
