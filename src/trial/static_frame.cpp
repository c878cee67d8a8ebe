// Frames in the rod's base frame, with everything known that a prediction needs.
#include "static_frame.h"

#include <algorithm>
#include <cmath>

#include "arm/wall_memory.h"
#include "math/statistics.h"
#include "softarm/arm/laws.h"

namespace softarm::trial {
namespace {

using Eigen::Vector3d;

// Frames so far apart have others missing in between: seconds, and usual steps.
constexpr double kFarApart_s = 0.1, kFarApartSteps = 4.0;
// Between them the arm is followed no longer than this: what an arm remembers for minutes it remembers alike.
constexpr double kLongestBlind_s = 60.0;
constexpr double kFarFromArm = 5.0;  // in lengths of the arm: units, or another object

/// Frames of one trial in the rod's base frame.
class Preparer {
 public:
  Preparer(const arm::Arm& arm, const std::vector<InputSeries>& inputs, Blind blind,
           std::map<std::string, std::uint64_t>& left_out)
      : arm_(arm), inputs_(inputs), blind_(blind), left_out_(left_out) {
    if (arm::has_wall(arm)) drive_ = std::make_shared<DriveRecord>();
  }

  std::optional<StaticFrame> prepare(const Frame& frame) {
    StaticFrame out;
    out.stamp_s = frame.stamp_s();
    out.inputs = inputs_of(frame);
    const bool predicted = predict(arm_, out.inputs).has_value();
    if (predicted) record(out);
    out.drive = drive_;
    const std::optional<double> payload = frame.payload_kg ? frame.payload_kg : arm_.payload.default_kg;
    if (!payload || !std::isfinite(*payload)) return leave_out("payload not known");
    out.payload_kg = *payload;
    if (arm_.base.body) {
      const bool now = frame.base_body && frame.base_body->matrix().allFinite();
      if (now) base_ = *frame.base_body * arm_.base.rod_in_body;
      base_seen_ = base_seen_ || now;
      if (!now && !(arm_.base.hold_last && base_seen_)) return leave_out("base not seen");
    }
    const Eigen::Isometry3d& base = stand_on_base(out);
    if (!predicted) return leave_out("inputs missing or beyond the laws");
    const Eigen::Isometry3d to_base = base.inverse();
    for (const BodyObservation& seen : frame.bodies) add_body(seen, to_base, out);
    if (out.bodies.empty()) {
      ++left_out_["no body seen"];
      if (blind_ == Blind::kLeaveOut) return std::nullopt;
    }
    return out;
  }

  /// What drove the arm between two frames that are far apart, under the first one's payload and base.
  void add_between(const StaticFrame& before, double until_s, std::vector<StaticFrame>& out) {
    if (blind_ == Blind::kLeaveOut || inputs_.size() != before.inputs.size() || inputs_.empty() ||
        until_s - before.stamp_s > kLongestBlind_s)
      return;
    for (int i = 1; before.stamp_s + (i + 0.5) * kBlindStep_s < until_s; ++i) {
      StaticFrame made = before;
      made.bodies.clear();
      made.stamp_s = before.stamp_s + i * kBlindStep_s;
      for (std::size_t k = 0; k < inputs_.size(); ++k)
        made.inputs[k] = inputs_[k].fresh_at_ns(to_nanoseconds(made.stamp_s), arm_.inputs.input_max_age_s);
      if (!predict(arm_, made.inputs)) continue;
      record(made);
      out.push_back(std::move(made));
    }
  }

 private:
  const Eigen::Isometry3d& stand_on_base(StaticFrame& out) const {
    const Eigen::Isometry3d& base = arm_.base.body ? base_ : arm_.base.fixed_pose;
    out.gravity_base = base.linear().transpose() * arm_.gravity_m_s2;
    out.q_base_mocap = Eigen::Quaterniond(base.linear()).conjugate();
    out.base_in_mocap_m = base.translation();
    return base;
  }

  std::optional<StaticFrame> leave_out(const char* reason) {
    ++left_out_[reason];
    return std::nullopt;
  }

  /// Of a clock that went back the wall knows nothing: those frames count as one.
  void record(const StaticFrame& frame) {
    if (!drive_ || (!drive_->stamp_s.empty() && !(frame.stamp_s > drive_->stamp_s.back()))) return;
    drive_->stamp_s.push_back(frame.stamp_s);
    drive_->inputs.push_back(frame.inputs);
  }

  arm::InputValues inputs_of(const Frame& frame) const {
    arm::InputValues values = frame.inputs;
    for (std::size_t i = 0; i < std::min(values.size(), inputs_.size()); ++i) {
      // What is too old stays missing. What came too late for its frame does not: clocks may be apart.
      const std::optional<double> value =
          values[i] ? inputs_[i].at_ns(frame.stamp_ns)
                    : inputs_[i].fresh_at_ns(frame.stamp_ns, arm_.inputs.input_max_age_s);
      if (value) values[i] = value;
    }
    return values;
  }

  void add_body(const BodyObservation& seen, const Eigen::Isometry3d& to_base, StaticFrame& out) const {
    if (seen.body < 0 || seen.body >= static_cast<int>(arm_.bodies.size()) || !seen.p_mocap.allFinite())
      return;
    const arm::MeasuredBody& body = arm_.bodies[static_cast<std::size_t>(seen.body)];
    SeenBody made;
    made.body = seen.body;
    if (seen.q_mocap && seen.q_mocap->coeffs().allFinite() && seen.q_mocap->norm() > 0.5) {
      const Eigen::Quaterniond q = seen.q_mocap->normalized();
      made.p_base = to_base * (seen.p_mocap + q * body.section_in_body.translation());
      if (body.orientation_usable && body.kind == arm::BodyKind::kRing)
        made.tangent_base = to_base.linear() * (q * (body.section_in_body.linear() * Vector3d::UnitZ()));
    } else {
      // Without an orientation an offset in the body's frame has no direction.
      if (!body.section_in_body.translation().isZero()) return;
      made.p_base = to_base * seen.p_mocap;
    }
    if (made.p_base.norm() < kFarFromArm * arm_.total_length_m()) out.bodies.push_back(made);
  }

  const arm::Arm& arm_;
  const std::vector<InputSeries>& inputs_;
  const Blind blind_;
  std::map<std::string, std::uint64_t>& left_out_;
  Eigen::Isometry3d base_ = Eigen::Isometry3d::Identity();  ///< of the rod, when last seen
  bool base_seen_ = false;
  std::shared_ptr<DriveRecord> drive_;
};

double far_apart_s(const std::vector<Frame>& frames) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < frames.size(); ++i)
    steps_s.push_back(frames[i].stamp_s() - frames[i - 1].stamp_s());
  return steps_s.empty() ? kFarApart_s
                         : std::max(kFarApart_s, kFarApartSteps * math::median(std::move(steps_s)));
}

}  // namespace

std::vector<StaticFrame> known_frames(const arm::Arm& arm, std::size_t index, const Trial& trial,
                                      std::map<std::string, std::uint64_t>& left_out, InputsOf inputs,
                                      Blind blind) {
  static const std::vector<InputSeries> kNone;
  Preparer preparer(arm, inputs == InputsOf::kSeries ? trial.inputs : kNone, blind, left_out);
  std::vector<StaticFrame> known;
  const double far_s = far_apart_s(trial.frames);
  bool follows = false;  // the last known frame: of what was left out base or payload are not known
  for (const Frame& frame : trial.frames) {
    if (follows && frame.stamp_s() > known.back().stamp_s + far_s)
      preparer.add_between(StaticFrame(known.back()), frame.stamp_s(), known);
    follows = false;
    if (std::optional<StaticFrame> made = preparer.prepare(frame)) {
      made->trial = index;
      known.push_back(std::move(*made));
      follows = true;
    }
  }
  return known;
}

}  // namespace softarm::trial
