#include "context.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "math/statistics.h"
#include "policy.h"

namespace softarm::check {
namespace {

/// Median of stamp less receipt; 0 of samples without a stamp.
template <typename Sample>
double ahead_of(const std::vector<Sample>& samples) {
  std::vector<double> ahead;
  for (const Sample& s : samples) {
    if (s.stamp_s > 0.0 && std::isfinite(s.stamp_s)) ahead.push_back(s.stamp_s - s.receipt_s);
  }
  return math::median(std::move(ahead));
}

/// @param latency_s that the arm file has; it may account for another epoch
template <typename Sample>
ClockEpoch epoch_of(const std::vector<Sample>& samples, double latency_s) {
  const double middle = ahead_of(samples);
  if (!(std::abs(middle) > kPolicy.timing.other_epoch_s)) return {};
  if (std::abs(middle - latency_s) > kPolicy.timing.other_epoch_s) return {middle, 0.0};
  return {0.0, latency_s};
}

/// What each body's clock is ahead of that of most samples of bodies, of two as large groups that nearer to
/// receipt; 0 where it is the same clock.
std::vector<double> own_ahead_of(const std::vector<std::vector<trial::RecordedPose>>& bodies) {
  std::vector<double> ahead, own(bodies.size(), 0.0);
  const auto stamped = [&](std::size_t i) {
    return std::any_of(bodies[i].begin(), bodies[i].end(), [](const trial::RecordedPose& pose) {
      return pose.stamp_s > 0.0 && std::isfinite(pose.stamp_s);
    });
  };
  for (const auto& body : bodies) ahead.push_back(ahead_of(body));
  const auto alike = [&](std::size_t a, std::size_t b) {
    return stamped(a) && stamped(b) && std::abs(ahead[a] - ahead[b]) <= kPolicy.timing.other_epoch_s;
  };
  std::size_t main = 0, most = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    std::size_t samples = 0;
    for (std::size_t j = 0; j < bodies.size(); ++j)
      if (alike(i, j)) samples += bodies[j].size();
    if (samples < most || (samples == most && std::abs(ahead[i]) >= std::abs(ahead[main]))) continue;
    main = i;
    most = samples;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (stamped(i) && !alike(i, main)) own[i] = ahead[i] - ahead[main];
  return own;
}

bool usable(const trial::RecordedPose& pose) {
  return pose.stamp_s > 0.0 && std::isfinite(pose.stamp_s) && pose.p_mocap.allFinite() &&
         pose.p_mocap.squaredNorm() > 0.0;
}

std::optional<Eigen::Quaterniond> unit(const std::optional<Eigen::Quaterniond>& q) {
  if (!q || !q->coeffs().allFinite() || std::abs(q->norm() - 1.0) > kPolicy.tracking.unit_norm)
    return std::nullopt;
  return q->normalized();
}

template <typename Point>
void sort_in_time(std::vector<Point>& points) {
  std::stable_sort(points.begin(), points.end(),
                   [](const Point& a, const Point& b) { return a.t_s < b.t_s; });
  points.erase(std::unique(points.begin(), points.end(),
                           [](const Point& a, const Point& b) { return b.t_s - a.t_s < 1e-6; }),
               points.end());
}

template <typename Point>
double median_step(const std::vector<Point>& points) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < points.size(); ++i) steps.push_back(points[i].t_s - points[i - 1].t_s);
  return math::median(std::move(steps));
}

double used_value(const arm::ScalarInput& input, double value, double ambient_pa) {
  value -= input.zero_si;
  const double gauge = value - (input.reference == arm::PressureReference::kAbsolute ? ambient_pa : 0.0);
  switch (input.kind) {
    case arm::InputKind::kPressure:
      return gauge;
    case arm::InputKind::kVacuum:
      return -gauge;
    case arm::InputKind::kTension:
    case arm::InputKind::kAngle:
      break;
  }
  return value;
}

/// Noise turns round from sample to sample; a command holds or moves on.
bool turns_round(const std::vector<ValuePoint>& points) {
  int steps = 0, turns = 0;
  double last = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double step = points[i].value - points[i - 1].value;
    if (step == 0.0) continue;
    ++steps;
    if (step * last < 0.0) ++turns;
    last = step;
  }
  return steps >= kPolicy.signals.least_turns && turns > kPolicy.signals.turns_share * steps;
}

/// White noise from third differences, which a smooth course hardly has.
double white_noise(const std::vector<ValuePoint>& points) {
  std::vector<double> thirds;
  for (std::size_t i = 3; i < points.size(); ++i) {
    thirds.push_back(std::abs(points[i].value - 3.0 * points[i - 1].value + 3.0 * points[i - 2].value -
                              points[i - 3].value));
  }
  return math::kSdPerMad * math::median(std::move(thirds)) / std::sqrt(20.0);
}

/// The quantum of which all steps are multiples; 0 where there is none.
double quantum_of(const std::vector<ValuePoint>& points, double range) {
  constexpr const Policy::Signals& kSignals = kPolicy.signals;
  std::vector<double> steps;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double step = std::abs(points[i].value - points[i - 1].value);
    if (step > 1e-9 * std::max(range, 1e-12)) steps.push_back(step);
  }
  if (steps.size() < kSignals.least_steps || range <= 0.0) return 0.0;
  const double least = math::quantile(steps, kSignals.single_quantile);
  // The smallest steps agree, and the others are multiples of them: refined by the small ones among them.
  double sum = 0.0, count = 0.0;
  std::size_t multiples = 0, twice = 0;
  for (const double step : steps) {
    const double n = std::round(step / least);
    if (n > kSignals.most_quanta) continue;
    if (std::abs(step / least - n) < kSignals.off_quanta * std::max(1.0, kSignals.off_per_quantum * n)) {
      ++multiples;
      twice += n == 1.0;
      sum += step;
      count += n;
    }
  }
  const bool holds =
      multiples > kSignals.quanta_share * static_cast<double>(steps.size()) && twice > kSignals.few_single;
  return holds && least > kSignals.finest * range ? sum / count : 0.0;
}

Signal make_signal(const arm::ScalarInput& input, const std::vector<trial::RecordedValue>& values,
                   double begin_s, double epoch_s, double ambient_pa) {
  Signal signal;
  signal.input = &input;
  for (const trial::RecordedValue& v : values) {
    if (!std::isfinite(v.value) || !(v.stamp_s > 0.0)) continue;
    signal.points.push_back(
        {v.stamp_s - input.latency_s - begin_s - epoch_s, used_value(input, v.value, ambient_pa)});
  }
  sort_in_time(signal.points);
  signal.period_s = median_step(signal.points);
  if (signal.points.empty()) return signal;
  std::vector<double> all;
  for (const ValuePoint& p : signal.points) all.push_back(p.value);
  const auto [low, high] = std::minmax_element(all.begin(), all.end());
  signal.low = *low;
  signal.high = *high;
  signal.least = math::quantile(all, kPolicy.signals.few_values);
  signal.is_measured = turns_round(signal.points);
  signal.quantum = quantum_of(signal.points, signal.range());
  // A coarse sensor mostly repeats itself: then rounding is the noise.
  if (signal.is_measured)
    signal.noise_sd = std::max(white_noise(signal.points), signal.quantum / std::sqrt(12.0));
  return signal;
}

Track make_track(const std::vector<trial::RecordedPose>& poses, double own_ahead_s, const Context& context) {
  Track track;
  for (const trial::RecordedPose& pose : poses) {
    if (!usable(pose)) continue;
    track.poses.push_back({context.seconds(pose.stamp_s - own_ahead_s - context.arm.inputs.body_latency_s),
                           pose.p_mocap, unit(pose.q_mocap), true});
  }
  sort_in_time(track.poses);
  track.period_s = median_step(track.poses);
  return track;
}

template <typename Point>
auto first_from(const std::vector<Point>& points, double t_s) {
  return std::lower_bound(points.begin(), points.end(), t_s,
                          [](const Point& p, double t) { return p.t_s < t; });
}

}  // namespace

std::optional<Eigen::Vector3d> Track::mean_position(double from_s, double to_s) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (auto pose = first_from(poses, from_s); pose != poses.end() && pose->t_s <= to_s; ++pose) {
    if (!pose->good) continue;
    sum += pose->p;
    ++count;
  }
  return count >= 3 ? std::optional<Eigen::Vector3d>(sum / count) : std::nullopt;
}

std::optional<Eigen::Quaterniond> Track::mean_orientation(double from_s, double to_s) const {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  int count = 0;
  for (auto pose = first_from(poses, from_s); pose != poses.end() && pose->t_s <= to_s; ++pose) {
    if (!pose->good || !pose->q) continue;
    const Eigen::Vector4d q = pose->q->coeffs();
    sum += sum.dot(q) < 0.0 ? Eigen::Vector4d(-q) : q;
    ++count;
  }
  if (count < 3 || !(sum.norm() > 0.5 * count)) return std::nullopt;
  return Eigen::Quaterniond(Eigen::Vector4d(sum.normalized()));
}

double Signal::at(double t_s) const {
  const auto after = first_from(points, t_s);
  if (after == points.begin()) return points.front().value;
  if (after == points.end()) return points.back().value;
  const ValuePoint& a = *(after - 1);
  return a.value + (after->value - a.value) * (t_s - a.t_s) / (after->t_s - a.t_s);
}

bool Signal::is_driven() const {
  return range() > 0.0 && range() > kPolicy.signals.driven_noises * std::max(noise_sd, quantum);
}

std::optional<double> Signal::mean(double from_s, double to_s) const {
  double sum = 0.0;
  int count = 0;
  for (auto p = first_from(points, from_s); p != points.end() && p->t_s <= to_s; ++p) {
    sum += p->value;
    ++count;
  }
  return count > 0 ? std::optional<double>(sum / count) : std::nullopt;
}

Context::Context(const trial::CheckRecording& recorded, const arm::Arm& described)
    : recording(recorded), arm(described) {
  double begin = std::numeric_limits<double>::infinity(), end = -begin;
  const auto extend = [&](double receipt_s) {
    begin = std::min(begin, receipt_s);
    end = std::max(end, receipt_s);
  };
  own_ahead_s = own_ahead_of(recording.bodies);
  std::vector<trial::RecordedPose> all;
  for (std::size_t i = 0; i < recording.bodies.size(); ++i) {
    const auto& body = recording.bodies[i];
    for (const trial::RecordedPose& pose : body) extend(pose.receipt_s);
    if (own_ahead_s[i] == 0.0) all.insert(all.end(), body.begin(), body.end());
  }
  for (std::size_t i = 0; i < recording.inputs.size(); ++i) {
    for (const trial::RecordedValue& value : recording.inputs[i]) extend(value.receipt_s);
    input_epochs.push_back(epoch_of(recording.inputs[i], arm.inputs.scalars[i].latency_s));
  }
  for (const trial::RecordedValue& value : recording.payload) extend(value.receipt_s);
  if (begin <= end) {
    begin_s = begin;
    duration_s = end - begin;
  }
  body_epoch = epoch_of(all, arm.inputs.body_latency_s);
  for (std::size_t i = 0; i < recording.bodies.size(); ++i) {
    tracks.push_back(make_track(recording.bodies[i], own_ahead_s[i], *this));
    Track& track = tracks.back();
    track.name = i == 0 ? arm.base.body.value_or("") : arm.bodies[i - 1].name;
    if (i > 0) {
      track.body = &arm.bodies[i - 1];
      track.arclength_m = arm.bodies[i - 1].arclength_m;
    }
  }
  for (std::size_t i = 0; i < recording.inputs.size(); ++i) {
    signals.push_back(make_signal(arm.inputs.scalars[i], recording.inputs[i], begin_s,
                                  input_epochs[i].unknown_s, arm.inputs.ambient_pressure_pa));
  }
  for (const trial::RecordedValue& v : recording.payload) payload.push_back({v.receipt_s - begin_s, v.value});
  for (const auto& [from_s, to_s] : recording.left_out)
    left_out.push_back({from_s - begin_s, to_s - begin_s});
  if (!recording.import_layout.empty()) {
    try {
      layout = trial::parse_csv_layout(recording.import_layout, "layout");
    } catch (const trial::CsvError&) {  // of another version: the recording is looked at without
    }
  }
  update_noise(*this);
}

namespace {

CheckFinding& appended(Context& context, Severity severity, const std::string& id, const std::string& where,
                       const std::string& what) {
  CheckFinding finding;
  finding.severity = severity;
  finding.id = id;
  finding.where = where;
  finding.what = what;
  context.findings.push_back(std::move(finding));
  return context.findings.back();
}

/// What the check that is looking states of an id.
const Statement& stated(const Check* check, const std::string& id, bool with_severity) {
  const Statement* statement = check ? check->statement(id) : nullptr;
  if (!statement) throw std::logic_error("finding '" + id + "' is stated by no check that is looking");
  if (statement->severity.has_value() != with_severity) {
    throw std::logic_error("finding '" + id + "': its severity is given twice, or not at all");
  }
  return *statement;
}

}  // namespace

CheckFinding& Context::add(const std::string& id, const std::string& where, const std::string& what) {
  return appended(*this, *stated(check, id, true).severity, id, where, what);
}

CheckFinding& Context::add(Severity severity, const std::string& id, const std::string& where,
                           const std::string& what) {
  stated(check, id, false);
  return appended(*this, severity, id, where, what);
}

bool Context::has_one_clock() const {
  if (std::any_of(own_ahead_s.begin(), own_ahead_s.end(), [](double ahead) { return ahead != 0.0; }))
    return false;
  for (std::size_t i = 0; i < input_epochs.size(); ++i) {
    if (recording.inputs[i].empty()) continue;
    if (std::abs(input_epochs[i].unknown_s - body_epoch.unknown_s) > kPolicy.timing.other_epoch_s)
      return false;
  }
  return true;
}

bool Context::found(std::initializer_list<const char*> ids) const {
  return std::any_of(findings.begin(), findings.end(), [&](const CheckFinding& f) {
    return std::any_of(ids.begin(), ids.end(), [&](const char* id) { return f.id == id; });
  });
}

bool Context::is_left_out(double from_s, double to_s) const {
  return std::any_of(left_out.begin(), left_out.end(), [&](const CheckSpan& span) {
    const double grain_s = kPolicy.timing.left_out_grain * (span.to_s - span.from_s);
    return from_s > span.from_s - grain_s && to_s < span.to_s + grain_s;
  });
}

std::optional<Eigen::Isometry3d> Context::rod_base() const {
  if (!arm.base.body) return arm.base.fixed_pose;
  const CheckSpan span = rest().value_or(CheckSpan{0.0, duration_s});
  const auto p = tracks[0].mean_position(span.from_s, span.to_s);
  const auto q = tracks[0].mean_orientation(span.from_s, span.to_s);
  if (!p || !q) return std::nullopt;
  Eigen::Isometry3d body = Eigen::Isometry3d::Identity();
  body.translation() = *p;
  body.linear() = q->toRotationMatrix();
  return body * arm.base.rod_in_body;
}

std::vector<CheckSpan> spans_of(const std::vector<double>& times_s, double gap_s) {
  std::vector<CheckSpan> spans;
  for (const double t : times_s) {
    if (!spans.empty() && t - spans.back().to_s <= gap_s) {
      spans.back().to_s = std::max(spans.back().to_s, t);
    } else {
      spans.push_back({t, t});
    }
  }
  if (spans.size() <= kMostSpans) return spans;
  std::stable_sort(spans.begin(), spans.end(), [](const CheckSpan& a, const CheckSpan& b) {
    return a.to_s - a.from_s > b.to_s - b.from_s;
  });
  spans.resize(kMostSpans);
  std::sort(spans.begin(), spans.end(),
            [](const CheckSpan& a, const CheckSpan& b) { return a.from_s < b.from_s; });
  return spans;
}

std::string description(const std::vector<CheckSpan>& spans) {
  constexpr std::size_t kShown = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(spans.size(), kShown); ++i) {
    const CheckSpan& s = spans[i];
    if (i > 0) text += ", ";
    text += s.to_s - s.from_s < 0.05 ? fmt::format("{:.2f}", s.from_s)
                                     : fmt::format("{:.2f}-{:.2f}", s.from_s, s.to_s);
  }
  if (!text.empty()) text += " s";
  if (spans.size() > kShown) text += " and more";
  return text;
}

}  // namespace softarm::check
