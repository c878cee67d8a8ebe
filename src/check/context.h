// A recording made ready for the checks: sorted, numbers only, in one time.
#pragma once

#include <Eigen/Geometry>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "checks.h"
#include "softarm/check/check.h"
#include "strays.h"
#include "trial/csv_layout.h"

namespace softarm::check {

struct TrackPose {
  double t_s = 0.0;  ///< stamp, since the recording's first sample
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  std::optional<Eigen::Quaterniond> q;  ///< unit
  bool good = true;                     ///< false: a check found it wrong; the others leave it out
};

/// One body: its valid poses, strictly increasing in time.
struct Track {
  std::string name;
  const arm::MeasuredBody* body = nullptr;  ///< null: the base's
  double arclength_m = 0.0;
  std::vector<TrackPose> poses;
  double period_s = 0.0;      ///< median step of the stamps
  double white_sd_m = 0.0;    ///< of a coordinate, from sample to sample
  double slow_sd_m = 0.0;     ///< of a coordinate at rest, what does not average out; 0: unknown
  double white_sd_rad = 0.0;  ///< of a rotation about an axis

  bool is_base() const { return body == nullptr; }
  /// Mean position of the good poses in [from, to]; nothing below three of them.
  std::optional<Eigen::Vector3d> mean_position(double from_s, double to_s) const;
  /// Their mean orientation.
  std::optional<Eigen::Quaterniond> mean_orientation(double from_s, double to_s) const;
};

struct ValuePoint {
  double t_s = 0.0;
  double value = 0.0;
};

/// One input: pressures as gauge Pa, vacuum as Pa below ambient, tensions and angles from their zero.
struct Signal {
  const arm::ScalarInput* input = nullptr;
  std::vector<ValuePoint> points;  ///< strictly increasing in time
  double period_s = 0.0;
  double low = 0.0, high = 0.0;
  double least = 0.0;     ///< as low, but for a few values that are none
  double noise_sd = 0.0;  ///< white, from sample to sample
  double quantum = 0.0;   ///< all steps are multiples of it; 0: of none
  /// A command is exact: it repeats itself or moves smoothly. A sensor has noise or steps.
  bool is_measured = false;

  bool is_pressure() const {
    return input->kind == arm::InputKind::kPressure || input->kind == arm::InputKind::kVacuum;
  }
  double range() const { return high - low; }
  /// Whether it changes beyond its noise and its steps.
  bool is_driven() const;
  /// Linear in between, held beyond the ends. Precondition: points is not empty.
  double at(double t_s) const;
  std::optional<double> mean(double from_s, double to_s) const;
};

/// What a clock is ahead of receipt, where that is another epoch altogether (more than two seconds); else 0.
struct ClockEpoch {
  double unknown_s = 0.0;  ///< what the arm file does not know of
  double known_s = 0.0;    ///< its latency_s, where that accounts for it

  double all_s() const { return unknown_s + known_s; }
};

/// The recording and what the checks have found out so far.
struct Context {
  Context(const trial::CheckRecording& recording, const arm::Arm& arm);

  const trial::CheckRecording& recording;
  const arm::Arm& arm;
  std::map<std::string, Stray> strays;  ///< that the recording does not have any more
  double begin_s = 0.0;                 ///< receipt of the first sample
  double duration_s = 0.0;
  ClockEpoch body_epoch;
  /// [0] the base's, then as Arm::bodies: what a body's clock is ahead of that of most bodies, where it is
  /// another one altogether; else 0.
  std::vector<double> own_ahead_s;
  std::vector<ClockEpoch> input_epochs;
  std::vector<Track> tracks;  ///< [0] the base (empty poses where it is fixed or absent), then Arm::bodies
  std::vector<Signal> signals;
  std::vector<ValuePoint> payload;
  std::optional<trial::CsvLayout> layout;  ///< by which it was imported
  std::vector<CheckSpan> left_out;         ///< by the import, as told
  /// The arm and its inputs are still. Held: some input is then far above its least value.
  std::optional<CheckSpan> still_begin, still_end;
  std::string held_at_begin, held_at_end;  ///< the first input that is held; empty: undriven

  std::vector<ZeroAtRest> zeros;
  std::optional<double>
      explained;  ///< share of the motion that the inputs explain, where clocks were compared

  const Check* check = nullptr;  ///< that is looking
  std::vector<CheckFinding> findings;

  /// A share of the arm's length, m.
  double of_length(double share) const { return share * arm.total_length_m(); }
  double seconds(double stamp_s) const { return stamp_s - begin_s - body_epoch.unknown_s; }
  /// Whether all stamps are of one clock, whatever the recorder's showed.
  bool has_one_clock() const;
  /// Appends a finding of the check that is looking, and returns it for the rest to be filled in; its
  /// severity is what the check states of the id.
  /// @throws std::logic_error where the check does not state the id, or the other call is meant
  CheckFinding& add(const std::string& id, const std::string& where, const std::string& what);
  /// The same, where the severity depends on what was found.
  CheckFinding& add(Severity severity, const std::string& id, const std::string& where,
                    const std::string& what);
  /// Whether any of these was found already.
  bool found(std::initializer_list<const char*> ids) const;

  /// Pose of the rod's base in the mocap frame at rest (or the median of the recording).
  std::optional<Eigen::Isometry3d> rod_base() const;
  /// The stretch in which shapes and levels at rest are looked at: at the beginning, else at the end, unless
  /// the inputs hold the arm there.
  std::optional<CheckSpan> rest() const {
    if (still_begin && held_at_begin.empty()) return still_begin;
    return held_at_end.empty() ? still_end : std::nullopt;
  }
  /// The same, whether the inputs hold the arm or not.
  std::optional<CheckSpan> still() const {
    if (const auto undriven = rest()) return undriven;
    return still_begin ? still_begin : still_end;
  }
  /// Whether the import left out all between these times, but for a sample at either end.
  bool is_left_out(double from_s, double to_s) const;
};

/// Recomputes the noise of the tracks, which depends on which poses are good.
void update_noise(Context& context);

/// How many spans a finding lists at most: a table that is still read; it decides nothing.
constexpr std::size_t kMostSpans = 12;
/// Joins times that lie within `gap_s` to spans; no more than kMostSpans, the longest, in order.
std::vector<CheckSpan> spans_of(const std::vector<double>& times_s, double gap_s);
/// "2.1-3.4 s, 7-7.5 s and 12 more"
std::string description(const std::vector<CheckSpan>& spans);

}  // namespace softarm::check
