#include "estimate_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "estimates_csv.h"
#include "math/statistics.h"

namespace softarm::estimate {
namespace {

class Table {
 public:
  void line(const std::string& name, const std::string& value) {
    fmt::format_to(std::back_inserter(text_), "{:<27} {}\n", name + ":", value);
  }

  /// Median of the values with its unit, or "-".
  void median(const std::string& name, std::vector<double> values, double scale, const char* unit) {
    if (values.empty()) return line(name, "-");
    line(name, fmt::format("{:.4g} {}", math::median(std::move(values)) * scale, unit));
  }

  /// As above, of a value that was given.
  void known(const std::string& name, const std::vector<double>& values, const char* unit) {
    median(name, values, 1.0, fmt::format("{} (known)", unit).c_str());
  }

  /// As above, and the share of frames in which the value is identifiable with the median over those.
  void estimated(const std::string& name, const std::vector<double>& values,
                 const std::vector<double>& identifiable_values, std::uint64_t frames, const char* unit) {
    median(name, values, 1.0, unit);
    const double share =
        frames ? 100.0 * static_cast<double>(identifiable_values.size()) / static_cast<double>(frames) : 0;
    line("  identifiable in", fmt::format("{} frames ({:.1f} %)", identifiable_values.size(), share));
    if (!identifiable_values.empty()) median("  median where identifiable", identifiable_values, 1.0, unit);
  }

  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

/// What would tell EI, or do without it.
std::string remedy_of(arm::Unknown unknown) {
  switch (unknown) {
    case arm::Unknown::kStiffness:
      return "attach a known payload to the arm, or hold EI by the laws (--unknown payload)";
    case arm::Unknown::kPayload:
      return "weigh the payload and state it (--unknown stiffness), or hold EI by the laws (--prior off)";
    case arm::Unknown::kBoth:
      break;
  }
  return "weigh the payload and state it (--unknown stiffness), or hold EI by the laws (--unknown payload "
         "--prior off)";
}

std::string words_of(WhyNot why, const std::string& remedy) {
  switch (why) {
    case WhyNot::kByLawsAlone:
      return "it is what the laws say, the bodies say nothing about it; " + remedy;
    case WhyNot::kSettling:
      return "the payload had just changed";
    case WhyNot::kNearBuckling:
      return "near the buckling load another EI with another moment has the same shape; " + remedy;
    default:
      return "no load bends the arm enough to determine it; " + remedy;
  }
}

}  // namespace

EstimateSummary::EstimateSummary(const arm::Arm& arm)
    : set_aside_(arm.bodies.size(), 0),
      too_far_(arm.bodies.size()),
      length_m_(arm.total_length_m()),
      segments_(arm.segments.size()) {
  const arm::Method method = arm.estimator.method;
  const bool arcs = method == arm::Method::kCcPoints || method == arm::Method::kCcEndpoint;
  payload_known_ = arcs || arm.estimator.unknown == arm::Unknown::kStiffness;
  stiffness_known_ = !arcs && arm.estimator.unknown == arm::Unknown::kPayload && !arm.estimator.prior.enabled;
  remedy_ = remedy_of(arm.estimator.unknown);
  for (const arm::MeasuredBody& body : arm.bodies) body_names_.push_back(body.name);
  for (std::size_t i = 0; i < segments_.size(); ++i) segments_[i].name = arm.segments[i].name;
}

void EstimateSummary::add(const Estimate& e) {
  if (frames_ == 0) first_stamp_s_ = e.stamp_s;
  last_stamp_s_ = e.stamp_s;
  ++frames_;
  for (const BodyTooFar& far : e.too_far) {
    TooFar& body = too_far_.at(static_cast<std::size_t>(far.body));
    if (++body.frames == 1) body.first_m = far.distance_m;
  }
  if (e.status != Status::kOk) {
    Refused& refused = not_ok_[to_string(e.status)];
    if (++refused.count == 1) refused.detail = e.detail;
    return;
  }
  ++ok_;
  rms_residual_m_.push_back(e.rms_residual_m);
  // Without degrees of freedom the model fits anything: there is nothing to compare.
  if (e.degrees_of_freedom > 0) reduced_chi_square_.push_back(e.reduced_chi_square);
  for (const BodyResidual& residual : e.residuals) {
    if (!residual.used) ++set_aside_.at(static_cast<std::size_t>(residual.body));
  }
  if (const auto angle = tip_angle_rad(e)) tip_angle_rad_.push_back(*angle);
  if (e.payload_kg) {
    payload_kg_.push_back(*e.payload_kg);
    if (e.identifiable_payload) identifiable_payload_kg_.push_back(*e.payload_kg);
  }
  for (std::size_t i = 0; i < std::min(segments_.size(), e.segments.size()); ++i) {
    const SegmentEstimate& s = e.segments[i];
    if (s.moment_nm) segments_[i].moment_nm.push_back(*s.moment_nm);
    if (s.length_m) segments_[i].length_m.push_back(*s.length_m);
    if (!s.bending_stiffness_nm2) continue;
    segments_[i].bending_stiffness_nm2.push_back(*s.bending_stiffness_nm2);
    if (s.identifiable_stiffness)
      segments_[i].identifiable_bending_stiffness_nm2.push_back(*s.bending_stiffness_nm2);
    else
      ++segments_[i].why_not[s.stiffness_why_not];
  }
}

std::string EstimateSummary::why_none(const std::map<std::string, std::uint64_t>& rejected) const {
  std::string why;
  const auto most = std::max_element(not_ok_.begin(), not_ok_.end(), [](const auto& a, const auto& b) {
    return a.second.count < b.second.count;
  });
  if (most != not_ok_.end())
    why =
        most->second.detail.empty() ? most->first : fmt::format("{} ({})", most->first, most->second.detail);
  const auto samples = std::max_element(rejected.begin(), rejected.end(),
                                        [](const auto& a, const auto& b) { return a.second < b.second; });
  if (samples != rejected.end())
    why += fmt::format("{}{} samples were not used: {}", why.empty() ? "" : "; ", samples->second,
                       samples->first);
  return why.empty() ? "the reason is not known" : why;
}

std::string EstimateSummary::text(const std::map<std::string, std::uint64_t>& rejected,
                                  std::uint64_t samples) const {
  Table table;
  table.line("duration", fmt::format("{:.3f} s", duration_s()));
  table.line("frames", fmt::format("{}", frames_));
  table.line("frames ok", fmt::format("{}", ok_));
  for (const auto& [reason, refused] : not_ok_)
    table.line("  not ok, " + reason, fmt::format("{}", refused.count));
  table.line("samples", fmt::format("{}", samples));
  for (const auto& [reason, count] : rejected) table.line("  rejected, " + reason, fmt::format("{}", count));
  for (std::size_t i = 0; i < set_aside_.size(); ++i) {
    if (set_aside_[i] == 0) continue;
    const double share = static_cast<double>(set_aside_[i]) / static_cast<double>(ok_);
    table.line("set aside",
               fmt::format("{} in {} frames ({:.0f} %){}", body_names_[i], set_aside_[i], 100.0 * share,
                           share > 0.5 ? "; is its arclength_m right, has the ring slipped?" : ""));
  }
  for (std::size_t i = 0; i < too_far_.size(); ++i) {
    const TooFar& far = too_far_[i];
    if (far.frames == 0) continue;
    table.line("too far", fmt::format("{} in {} frames ({:.0f} %), at first {:.3g} m from the base of an arm "
                                      "of {:.3g} m; is it another body, are the units right?",
                                      body_names_[i], far.frames,
                                      100.0 * static_cast<double>(far.frames) / static_cast<double>(frames_),
                                      far.first_m, length_m_));
  }
  table.median("rms residual, median", rms_residual_m_, 1e3, "mm");
  table.median("reduced chi-square, median", reduced_chi_square_, 1.0,
               "(chi-square per degree of freedom; 1 is the stated noise)");
  table.median("tip angle, median", tip_angle_rad_, 1.0, "rad");
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const Segment& s = segments_[i];
    const std::string prefix = segments_.size() > 1 ? fmt::format("segment {} ", i + 1) : "";
    table.median(prefix + "M0, median", s.moment_nm, 1.0, "N m");
    table.median(prefix + "L, median", s.length_m, 1.0, "m");
    if (stiffness_known_) {
      table.known(prefix + "EI, median", s.bending_stiffness_nm2, "N m^2");
    } else {
      table.estimated(prefix + "EI, median", s.bending_stiffness_nm2, s.identifiable_bending_stiffness_nm2,
                      ok_, "N m^2");
      for (const auto& [why, frames] : s.why_not)
        table.line("  not in", fmt::format("{} frames: {}", frames, words_of(why, remedy_)));
      if (!s.why_not.empty())
        table.line("  laws of an EI that is held",
                   fmt::format("softarm identify ... --hold '{}.bending_stiffness.*'", s.name));
    }
  }
  if (payload_known_) {
    table.known("payload, median", payload_kg_, "kg");
  } else {
    table.estimated("payload, median", payload_kg_, identifiable_payload_kg_, ok_, "kg");
  }
  return table.take();
}

}  // namespace softarm::estimate
