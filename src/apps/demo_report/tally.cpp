#include "tally.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "math/statistics.h"
#include "ros/backbone_sampling.h"
#include "ros/conversions.h"

namespace softarm {
namespace {

using softarm_estimator::ArmEstimate;
using softarm_estimator::Truth;

constexpr std::size_t kWaiting = 2000;

std::string status_name(const ArmEstimate& estimate) {
  return estimate.detail.empty() ? fmt::format("status {}", estimate.status) : estimate.detail;
}

/// Reasons that differ in their numbers alone are one.
std::string without_numbers(std::string text) {
  const auto is_of_number = [](unsigned char c) { return std::isdigit(c) != 0 || c == '.'; };
  text.erase(std::remove_if(text.begin(), text.end(), is_of_number), text.end());
  return text;
}

/// By the arclength of the arm as it is: the truth's points are at equal ones, the estimate's at equal ones
/// of the arm at zero input, of which each segment has grown in its own way.
std::vector<estimate::BackbonePoint> backbone_of(const ArmEstimate& estimate) {
  std::vector<estimate::BackbonePoint> points(estimate.backbone.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& pose = estimate.backbone[i];
    points[i].p_base = {pose.position.x, pose.position.y, pose.position.z};
    points[i].q_base = {pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z};
    if (i == 0) continue;
    const double chord_m = (points[i].p_base - points[i - 1].p_base).norm();
    points[i].arclength_m = points[i - 1].arclength_m + chord_m;
  }
  return points;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (double v : values) sum += v * v;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

std::string row(const std::string& name, const std::string& value) {
  return fmt::format("  {:<23} {}\n", name, value);
}

/// Finds the partner of a stamp and takes it; forgets what waited too long.
template <class Message>
std::optional<Message> take(std::map<ros::Time, Message>& waiting, const ros::Time& stamp) {
  const auto found = waiting.find(stamp);
  if (found == waiting.end()) return {};
  Message message = std::move(found->second);
  waiting.erase(found);
  return message;
}

template <class Message>
void keep(std::map<ros::Time, Message>& waiting, const Message& message) {
  waiting[message.header.stamp] = message;
  if (waiting.size() > kWaiting) waiting.erase(waiting.begin());
}

}  // namespace

void Tally::Errors::add(double value, double sd, double true_value) {
  ++count;
  absolute.push_back(std::abs(value - true_value));
  truth.push_back(true_value);
  within_two_sd += absolute.back() <= 1.96 * sd;
}

std::string Tally::Errors::text(const char* unit, double per_unit, std::uint64_t of) const {
  if (count == 0) return fmt::format("0 of {} frames", of);
  // A value that may be zero (a payload, a moment) has no error in per cent of itself: of the median truth.
  const double typical = math::median(truth), median = math::median(absolute);
  return fmt::format(
      "{:.4g} {}, error: median {:.3g}{}, 95 % below {:.3g}; {:.0f} % within 1.96 sd; {:.0f} % of frames",
      per_unit * typical, unit, per_unit * median,
      typical > 0.0 ? fmt::format(" ({:.1f} %)", 100.0 * median / typical) : "",
      per_unit * math::quantile(absolute, 0.95),
      100.0 * static_cast<double>(within_two_sd) / static_cast<double>(count),
      100.0 * static_cast<double>(count) / static_cast<double>(of));
}

void Tally::add(const ArmEstimate& estimate, ros::Time received, ros::WallTime wall_time) {
  ++frames_;
  if (!first_) first_ = wall_time;
  last_ = wall_time;
  latency_s_.push_back(seconds_since(static_cast<std::int64_t>(estimate.header.stamp.toNSec()), received));
  newest_ = estimate;
  if (estimate.status != ArmEstimate::STATUS_OK) {
    Refused& refused = refused_[without_numbers(status_name(estimate))];
    if (++refused.count == 1) refused.example = status_name(estimate);
    refused.differ |= refused.example != status_name(estimate);
    return;
  }
  ++ok_;
  residual_m_.push_back(estimate.rms_residual);
  identifiable_stiffness_ +=
      !estimate.segments.empty() && estimate.segments[0].identifiable_bending_stiffness;
  identifiable_payload_ += estimate.identifiable_payload;
  if (const auto truth = take(unmatched_truth_, estimate.header.stamp)) {
    compare(estimate, *truth);
  } else {
    keep(unmatched_estimates_, estimate);
  }
}

void Tally::add(const Truth& truth) {
  if (const auto estimate = take(unmatched_estimates_, truth.header.stamp)) {
    compare(*estimate, truth);
  } else {
    keep(unmatched_truth_, truth);
  }
}

void Tally::compare(const ArmEstimate& estimate, const Truth& truth) {
  if (truth.payload_steadied) {
    ++steadied_;  // a hand carries part of the load: nothing to compare
    return;
  }
  const std::vector<estimate::BackbonePoint> backbone = backbone_of(estimate);
  if (backbone.empty() || truth.backbone.size() < 2) return;
  double sum = 0.0, last = 0.0;
  const double length_m = backbone.back().arclength_m;
  for (std::size_t i = 0; i < truth.backbone.size(); ++i) {
    const double s = length_m * static_cast<double>(i) / static_cast<double>(truth.backbone.size() - 1);
    const auto& p = truth.backbone[i];
    last = (backbone_at(backbone, s).p_base - Eigen::Vector3d(p.x, p.y, p.z)).norm();
    sum += last * last;
  }
  shape_error_m_.push_back(std::sqrt(sum / static_cast<double>(truth.backbone.size())));
  tip_error_m_.push_back(last);
  const std::size_t count = std::min(
      {estimate.segments.size(), truth.bending_stiffness.size(), truth.moment.size(), truth.length.size()});
  segments_.resize(std::max(segments_.size(), count));
  for (std::size_t i = 0; i < count; ++i) {
    const auto& segment = estimate.segments[i];
    SegmentErrors& errors = segments_[i];
    errors.name = segment.name;
    if (segment.identifiable_bending_stiffness && segment.determined_bending_stiffness) {
      errors.stiffness_nm2.add(segment.bending_stiffness, segment.sd_bending_stiffness,
                               truth.bending_stiffness[i]);
    }
    if (segment.has_moment && segment.determined_moment) {
      errors.moment_nm.add(segment.moment, segment.sd_moment, truth.moment[i]);
    }
    if (segment.determined_length) errors.length_m.add(segment.length, segment.sd_length, truth.length[i]);
  }
  if (estimate.has_payload && !estimate.payload_is_known && estimate.determined_payload) {
    payload_kg_.add(estimate.payload, estimate.sd_payload, truth.payload);
  }
}

void Tally::add(const diagnostic_msgs::DiagnosticStatus& status) {
  not_well_.erase(status.name);
  if (status.level != diagnostic_msgs::DiagnosticStatus::OK) not_well_[status.name] = status.message;
}

std::string Tally::trouble(bool with_truth) const {
  std::string said;
  for (const auto& [name, message] : not_well_) said += (said.empty() ? "" : "; ") + message;
  if (frames_ == 0) return "no estimate was received" + (said.empty() ? "" : ": " + said);
  if (ok_ == 0) {
    const auto most = std::max_element(refused_.begin(), refused_.end(), [](const auto& a, const auto& b) {
      return a.second.count < b.second.count;
    });
    const std::string& why = most->second.example;
    return fmt::format("not one of {} frames could be estimated: {}{}", frames_, why,
                       said.empty() || said.find(why) != std::string::npos ? "" : "; " + said);
  }
  if (!with_truth || identifiable_stiffness_ + identifiable_payload_ > 0) return "";
  const bool both = newest_->unknown == "both";
  return fmt::format(
      "neither EI nor payload is identifiable in any of {} frames: {}", ok_,
      newest_->prior ? "the loads hardly bend this arm, or its laws are trusted too little (estimator.prior)"
      : both         ? "one frame cannot separate EI and payload without the prior (prior:=true)"
             : "too few bodies for so many segments, or the loads hardly bend this arm; more bodies, or the "
               "prior (prior:=true window:=0.5), help");
}

std::string Tally::line() const {
  if (!newest_) return "waiting for estimates";
  const double seconds = (*last_ - *first_).toSec();
  std::string text = fmt::format("{:6.0f} frames  {:5.1f}/s", static_cast<double>(frames_),
                                 seconds > 0.0 ? static_cast<double>(frames_ - 1) / seconds : 0.0);
  if (newest_->status != ArmEstimate::STATUS_OK) return text + "  no estimate: " + status_name(*newest_);
  for (const auto& segment : newest_->segments) {
    text += segment.identifiable_bending_stiffness
                ? fmt::format("  EI {:.3g} ± {:.2g} mN m²", 1e3 * segment.bending_stiffness,
                              1e3 * segment.sd_bending_stiffness)
                : std::string("  EI not identifiable ");
  }
  if (newest_->payload_is_known) {
    text += fmt::format("  payload {:.1f} g", 1e3 * newest_->payload);
  } else if (newest_->identifiable_payload) {
    text += fmt::format("  payload {:.1f} ± {:.1f} g", 1e3 * newest_->payload, 1e3 * newest_->sd_payload);
  } else {
    text += "  payload not identifiable";
  }
  text += fmt::format("  residual {:.2f} mm", 1e3 * newest_->rms_residual);
  if (!shape_error_m_.empty()) text += fmt::format("  shape error {:.2f} mm", 1e3 * shape_error_m_.back());
  return text;
}

std::string Tally::table(bool with_truth) const {
  std::string text;
  text += row("frames", fmt::format("{} received, {} estimated", frames_, ok_));
  for (const auto& [reason, refused] : refused_)
    text += row("", fmt::format("{} without estimate: {}{}", refused.count, refused.example,
                                refused.differ ? " (the first of them)" : ""));
  if (frames_ == 0) return text;
  const double seconds = (*last_ - *first_).toSec();
  text += row("rate", fmt::format("{:.1f} frames/s",
                                  seconds > 0.0 ? static_cast<double>(frames_ - 1) / seconds : 0.0));
  text += row("latency", fmt::format("median {:.2f} ms, 99 % below {:.2f} ms (stamp to receipt)",
                                     1e3 * math::median(latency_s_), 1e3 * math::quantile(latency_s_, 0.99)));
  text += row("residual",
              fmt::format("median {:.2f} mm (rms of the measured bodies)", 1e3 * math::median(residual_m_)));
  if (!with_truth) {
    text += row("EI", fmt::format("identifiable in {} of {} frames", identifiable_stiffness_, ok_));
    text += row("payload", fmt::format("identifiable in {} of {} frames", identifiable_payload_, ok_));
    return text;
  }
  text +=
      row("compared", fmt::format("{} frames with the truth ({} more while the payload was changed by hand)",
                                  compared(), steadied_));
  if (compared() == 0) return text;
  text += row("shape error", fmt::format("rms {:.2f} mm along the backbone, {:.2f} mm at the tip",
                                         1e3 * rms(shape_error_m_), 1e3 * rms(tip_error_m_)));
  const std::string known = "not estimated (known)";
  const std::string unknown = newest_ ? newest_->unknown : "";
  for (const SegmentErrors& errors : segments_) {
    if (segments_.size() > 1) text += row(errors.name, "");
    text += row("EI, where identifiable",
                unknown == "payload" ? known : errors.stiffness_nm2.text("mN m²", 1e3, compared()));
    text += row("moment", errors.moment_nm.text("mN m", 1e3, compared()));
    text += row("length", errors.length_m.text("mm", 1e3, compared()));
  }
  text += row("payload", unknown == "stiffness" ? known : payload_kg_.text("g", 1e3, compared()));
  return text;
}

}  // namespace softarm
