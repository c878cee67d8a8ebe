// What the estimator node says of itself on /diagnostics.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <ros/master.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "arm/input_kind.h"
#include "estimator_node.h"
#include "input_topics.h"
#include "labels.h"
#include "master_watch.h"
#include "math/statistics.h"
#include "softarm/arm/arm_file.h"
#include "softarm/arm/laws.h"

namespace softarm {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;
using Counts = std::map<std::string, std::uint64_t>;

constexpr double kLostAfter_s = 0.25;
constexpr double kStillAfter_s = 2.0;
constexpr double kOtherClock_s = 5.0;

Counts since(const Counts& now, const Counts& before) {
  Counts difference;
  for (const auto& [key, count] : now) {
    const auto found = before.find(key);
    const std::uint64_t more = count - (found == before.end() ? 0 : found->second);
    if (more > 0) difference[key] = more;
  }
  return difference;
}

std::string list(const Counts& counts) {
  std::string text;
  for (const auto& [key, count] : counts)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, key);
  return text;
}

}  // namespace

void EstimatorNode::on_diagnostics_timer() {
  const ros::SteadyTime now = ros::SteadyTime::now();
  period_s_ = std::max(1e-3, (now - period_start_).toSec());
  period_start_ = now;
  silent_s_ = statistics_.period.frames > 0 ? 0.0 : silent_s_ + period_s_;
  updater_.force_update();
  ++diagnostics_count_;
  show_waiting();
  statistics_.period = {};
  rejected_before_ = assembler_.rejected();
  dropped_before_ = assembler_.dropped_frames();
  for (const auto& [reason, count] : statistics_.dropped) dropped_before_[reason] = count;
  samples_before_ = assembler_.samples();
  time_jumps_before_ = assembler_.time_jumps();
  not_finite_before_ = statistics_.not_finite_messages;
  lost_before_ = total(statistics_.lost);
  for (const auto& source : sources_) {
    source->messages_before = source->messages;
    source->publishers.end_period();
  }
}

/// "/a, /b"; where that is usual, nothing.
std::optional<std::string> EstimatorNode::Source::two_publishers() const {
  const auto two = input.many_publish ? std::nullopt : publishers.two();
  if (!two) return std::nullopt;
  return two->first + ", " + two->second;
}

std::string EstimatorNode::waiting_for() const {
  constexpr std::size_t kNamed = 3;
  if (ros::Time::isSimTime() && ros::Time::now().isZero()) return "/clock (use_sim_time is set)";
  std::vector<std::string> silent;
  for (const auto& source : sources_) {
    if (source->messages == source->messages_before) silent.push_back(nh_.resolveName(source->input.topic));
  }
  if (silent.empty()) return "frames: messages arrive, but no frame can be made of them (see /diagnostics)";
  const std::size_t more = silent.size() - std::min(silent.size(), kNamed);
  if (more > 0) silent.resize(kNamed);
  return fmt::format("{}{}", fmt::join(silent, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

void EstimatorNode::show_waiting() {
  const ros::Time before = std::exchange(clock_, ros::Time::now());
  if (statistics_.period.frames > 0 || params_.marker_rate_hz <= 0.0 ||
      markers_publisher_.getNumSubscribers() == 0)
    return;
  const bool seen = assembler_.frames_seen() > 0;
  if (seen && ros::Time::isSimTime() && clock_ == before) return;  // a recording is over: the picture stays
  const std::string since = seen ? fmt::format("no frames for {:.0f} s, ", silent_s_) : "";
  const MessageContext context{params_.arm, estimator_.options(), params_.frames, clock_};
  publish_finite(markers_publisher_,
                 waiting_markers(since + "waiting for " + waiting_for(), base_in_mocap_, context));
}

void EstimatorNode::diagnose_frames(DiagnosticStatusWrapper& status) {
  const NodeStatistics::Period& period = statistics_.period;
  Counts dropped = assembler_.dropped_frames();
  for (const auto& [reason, count] : statistics_.dropped) dropped[reason] = count;
  const Counts dropped_now = since(dropped, dropped_before_);
  const std::uint64_t lost = total(statistics_.lost);
  const double latency_ms = 1e3 * math::median(period.latency_s);

  status.summary(DiagnosticStatus::OK,
                 fmt::format("{:.1f} frames/s, latency {:.1f} ms",
                             static_cast<double>(period.frames) / period_s_, latency_ms));
  if (period.frames == 0) {
    if (assembler_.frames_seen() == 0) {
      status.summary(DiagnosticStatus::WARN, "no frames yet");
    } else {
      status.summary(DiagnosticStatus::ERROR, fmt::format("no frames for {:.0f} s", silent_s_));
    }
  }
  if (period.frames > 0 && std::abs(latency_ms) > 1e3 * kOtherClock_s) {
    status.mergeSummary(DiagnosticStatus::WARN,
                        "stamps are of another clock (use_sim_time? driver's epoch?)");
  }
  if (!dropped_now.empty()) status.mergeSummary(DiagnosticStatus::WARN, "dropped: " + list(dropped_now));
  if (lost > lost_before_) {
    status.mergeSummary(DiagnosticStatus::WARN,
                        fmt::format("{} messages lost on their way", lost - lost_before_));
  }
  if (assembler_.time_jumps() > time_jumps_before_) {
    status.mergeSummary(DiagnosticStatus::WARN, "time went back: started afresh");
  }
  status.add("rate (Hz)", fmt::format("{:.1f}", static_cast<double>(period.frames) / period_s_));
  status.add("latency median (ms)", fmt::format("{:.2f}", latency_ms));
  status.add("latency 99 % (ms)", fmt::format("{:.2f}", 1e3 * math::quantile(period.latency_s, 0.99)));
  status.add("frames received", assembler_.frames_seen());
  status.add("frames waiting for bodies", assembler_.frames_open());
  status.add("frames that waited for an input", assembler_.frames_that_waited());
  for (const auto& [input, count] : assembler_.waited_in_vain())
    status.add("waited in vain: " + input, count);
  status.add("frames estimated", statistics_.estimated);
  status.add("frames refused", total(statistics_.refused));
  for (const auto& [reason, count] : statistics_.refused) status.add("frames refused: " + reason, count);
  status.add("frames dropped", total(dropped));
  for (const auto& [reason, count] : dropped) status.add("frames dropped: " + reason, count);
  status.add("messages lost on their way", lost);
  for (const auto& [topic, count] : statistics_.lost) status.add("messages lost: " + topic, count);
  status.add("messages held back (not finite)", statistics_.not_finite_messages);
  status.add("time jumps", assembler_.time_jumps());
}

void EstimatorNode::diagnose_inputs(DiagnosticStatusWrapper& status) {
  status.summary(DiagnosticStatus::OK, "all bodies seen");
  diagnose_bodies(status);
  diagnose_values(status);
  diagnose_rejections(status);
  diagnose_publishers(status);
  diagnose_silent_topics(status);
}

void EstimatorNode::diagnose_bodies(DiagnosticStatusWrapper& status) {
  const std::optional<double> newest = assembler_.newest_s();
  const std::map<std::string, double>& too_far_m = statistics_.period.too_far_m;
  std::string lost;
  std::size_t seen = 0;
  const auto indices = body_indices(params_.arm);
  for (const auto& [name, body] : indices) {
    const std::optional<double> accepted = assembler_.body_accepted_s(body);
    std::string state = "never seen";
    if (accepted) {
      const double age_s = *newest - *accepted;
      state = age_s > kLostAfter_s ? fmt::format("lost for {:.1f} s", age_s) : "seen";
      seen += age_s <= kLostAfter_s;
    }
    const auto far = too_far_m.find(name);
    if (state == "seen" && far != too_far_m.end())
      state = fmt::format("{:.3g} m from the base, too far for an arm of {:.3g} m", far->second,
                          params_.arm.total_length_m());
    status.add("body " + name, state);
    if (state != "seen") lost += fmt::format("{}{} {}", lost.empty() ? "" : ", ", name, state);
  }
  if (seen == 0 || silent_s_ > 0.0) {
    status.summary(newest ? DiagnosticStatus::ERROR : DiagnosticStatus::WARN, "no body is seen");
  } else if (!lost.empty()) {
    status.summary(DiagnosticStatus::WARN, lost);
  }
  const std::optional<double> changed = assembler_.changed_s();
  if (newest && changed && *newest - *changed > kStillAfter_s) {
    status.mergeSummary(DiagnosticStatus::WARN,
                        fmt::format("no pose has changed for {:.1f} s: is the driver repeating old data?",
                                    *newest - *changed));
  }
}

bool EstimatorNode::is_needed(int input) const {
  const arm::EstimatorOptions& options = estimator_.options();
  if (options.method == arm::Method::kCcPoints || options.method == arm::Method::kCcEndpoint) return false;
  for (const arm::Segment& segment : params_.arm.segments) {
    if (!options.prior.enabled &&
        !(options.unknown == arm::Unknown::kPayload && arm::stiffness_depends_on_inputs(segment))) {
      continue;
    }
    const std::vector<int> needed = arm::inputs_of(params_.arm, segment);
    if (std::find(needed.begin(), needed.end(), input) != needed.end()) return true;
  }
  return false;
}

void EstimatorNode::diagnose_values(DiagnosticStatusWrapper& status) {
  const std::optional<double> newest = assembler_.newest_s();
  std::string missing, unneeded;
  for (std::size_t i = 0; i < params_.arm.inputs.scalars.size(); ++i) {
    const arm::ScalarInput& input = params_.arm.inputs.scalars[i];
    const std::optional<double> accepted = assembler_.input_accepted_s(static_cast<int>(i));
    std::string state = "absent";
    bool here = accepted.has_value();
    if (accepted && newest) {
      const double age_s = std::max(0.0, *newest - *accepted);
      here = age_s <= params_.arm.inputs.input_max_age_s;
      state = fmt::format(here ? "seen {:.2f} s ago" : "missing for {:.1f} s", age_s);
    } else if (accepted) {
      state = "seen";
    }
    if (!here) {
      std::string& names = is_needed(static_cast<int>(i)) ? missing : unneeded;
      names += (names.empty() ? "" : ", ") + input.name;
    }
    status.add(to_string(input.kind) + " " + input.name, state);
  }
  if (!missing.empty()) status.mergeSummary(DiagnosticStatus::WARN, "inputs missing: " + missing);
  if (!unneeded.empty()) {
    status.mergeSummary(DiagnosticStatus::OK, "inputs missing: " + unneeded + " (not needed)");
  }
  status.add("payload (kg)", payload_kg_ ? fmt::format("{:.4f}", *payload_kg_)
                             : params_.arm.payload.default_kg
                                 ? fmt::format("{:.4f} (default of the arm)", *params_.arm.payload.default_kg)
                                 : std::string("unknown"));
}

void EstimatorNode::diagnose_rejections(DiagnosticStatusWrapper& status) {
  const Counts now = since(assembler_.rejected(), rejected_before_);
  if (!now.empty()) status.mergeSummary(DiagnosticStatus::WARN, "rejected: " + list(now));
  status.add("samples received", assembler_.samples());
  status.add("samples rejected", total(assembler_.rejected()));
  for (const auto& [reason, count] : assembler_.rejected()) status.add("rejected: " + reason, count);
}

void EstimatorNode::diagnose_publishers(DiagnosticStatusWrapper& status) {
  for (const auto& source : sources_) {
    const std::optional<std::string> two = source->two_publishers();
    if (!two) continue;
    const std::string topic = nh_.resolveName(source->input.topic);
    status.mergeSummary(DiagnosticStatus::WARN, fmt::format("two publishers on {}: {}", topic, *two));
    status.add("publishers of " + topic, *two);
  }
}

void EstimatorNode::diagnose_silent_topics(DiagnosticStatusWrapper& status) {
  // Asks the master, so not every second: what is published under the name of a topic that never delivered?
  std::vector<const Source*> silent;
  for (const auto& source : sources_) {
    if (source->messages == 0) silent.push_back(source.get());
  }
  const bool ask = !silent.empty() && diagnostics_count_ % 5 == 1;
  const ros::master::V_TopicInfo published = ask ? published_topics() : ros::master::V_TopicInfo();
  for (const Source* source : silent) {
    std::string state = "no message yet";
    const std::string topic = nh_.resolveName(source->input.topic);
    for (const ros::master::TopicInfo& info : published) {
      if (info.name == topic && !source->input.has_type(info.datatype)) {
        state = fmt::format("published as {}, but the arm says {}", info.datatype, source->input.type);
        status.mergeSummary(DiagnosticStatus::WARN, topic + " is " + state);
      }
    }
    status.add("topic " + topic, state);
  }
}

void EstimatorNode::diagnose_fit(DiagnosticStatusWrapper& status) {
  const NodeStatistics::Period& period = statistics_.period;
  const double reduced_chi_square = math::median(period.reduced_chi_square);
  const auto per_ok = [&](std::uint64_t count) {
    return period.ok > 0 ? static_cast<double>(count) / static_cast<double>(period.ok) : 0.0;
  };
  const std::string note = estimate::advice(estimator_.options());
  if (period.frames == 0) {
    status.summary(DiagnosticStatus::OK, "nothing to estimate");
  } else if (period.ok == 0) {
    status.summary(DiagnosticStatus::ERROR,
                   "no estimate: " + list(period.refused) + " (" + period.refused_detail + ")");
  } else {
    status.summary(DiagnosticStatus::OK, fmt::format("residual {:.2f} mm, solved in {:.0f} us",
                                                     1e3 * math::median(period.rms_residual_m),
                                                     1e6 * math::median(period.solve_time_s)));
    if (!period.refused.empty()) {
      status.mergeSummary(DiagnosticStatus::WARN,
                          "refused: " + list(period.refused) + " (" + period.refused_detail + ")");
    }
    for (const std::string& name : period.mostly_set_aside()) {
      status.mergeSummary(DiagnosticStatus::WARN,
                          fmt::format("{} set aside in {} of {} frames: is its arclength_m in the arm file "
                                      "right, has the ring slipped?",
                                      name, period.set_aside.at(name), period.ok));
    }
    if (reduced_chi_square > params_.reduced_chi_square_warning) {
      status.mergeSummary(DiagnosticStatus::WARN,
                          fmt::format("reduced chi-square {:.1f} (1 is ideal), most at {}",
                                      reduced_chi_square, period.worst_body));
    }
  }
  if (!note.empty()) status.mergeSummary(DiagnosticStatus::WARN, note);
  status.add("method", to_string(estimator_.options().method));
  status.add("unknown", to_string(estimator_.options().unknown));
  status.add("objective", to_string(estimator_.options().objective));
  status.add("prior", estimator_.options().prior.enabled ? "on" : "off");
  status.add("window (s)", fmt::format("{:g}", estimator_.options().window_s));
  status.add("solve time median (us)", fmt::format("{:.0f}", 1e6 * math::median(period.solve_time_s)));
  status.add("solve time 99 % (us)", fmt::format("{:.0f}", 1e6 * math::quantile(period.solve_time_s, 0.99)));
  status.add("iterations per frame", fmt::format("{:.1f}", per_ok(period.iterations)));
  status.add("warm starts (%)", fmt::format("{:.0f}", 100.0 * per_ok(period.warm_starts)));
  status.add("final cost", fmt::format("{:.4g}", period.final_cost));
  status.add("rms residual median (mm)", fmt::format("{:.3f}", 1e3 * math::median(period.rms_residual_m)));
  status.add("reduced chi-square median", fmt::format("{:.2f}", reduced_chi_square));
  status.add("bodies set aside", period.outliers);
  for (const auto& [name, count] : period.set_aside) status.add("frames that set aside " + name, count);
  status.add("worst body", period.worst_body.empty() ? std::string("none")
                                                     : fmt::format("{} ({:.2f} mm)", period.worst_body,
                                                                   1e3 * period.worst_residual_m));
  status.add("frames with identifiable EI (%)",
             fmt::format("{:.0f}", 100.0 * per_ok(period.identifiable_stiffness)));
  status.add("frames with identifiable payload (%)",
             fmt::format("{:.0f}", 100.0 * per_ok(period.identifiable_payload)));
}

}  // namespace softarm
