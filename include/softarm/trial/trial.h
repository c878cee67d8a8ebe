// A recording as the rooms that pool trials see it.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/laws.h"
#include "softarm/export.h"

namespace softarm::trial {

/// A stamp in seconds, for differences: of a date a double holds them to a quarter of a microsecond.
inline double to_seconds(std::int64_t stamp_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  return static_cast<double>(stamp_ns / kSecond) + 1e-9 * static_cast<double>(stamp_ns % kSecond);
}

/// The nearest stamp. @param stamp_s finite
inline std::int64_t to_nanoseconds(double stamp_s) {
  const double whole_s = std::floor(stamp_s);
  return static_cast<std::int64_t>(whole_s) * 1'000'000'000 + std::llround(1e9 * (stamp_s - whole_s));
}

/// Pose of one measured body (index into Arm::bodies), as its driver reports it.
struct BodyObservation {
  int body = 0;
  Eigen::Vector3d p_mocap = Eigen::Vector3d::Zero();  ///< m
  std::optional<Eigen::Quaterniond> q_mocap;          ///< absent: position only
};

/// One value of an input by its own stamp.
struct InputSample {
  int input = 0;              ///< index into Arm::inputs.scalars
  std::int64_t stamp_ns = 0;  ///< the instant that it means: its latency is subtracted
  double value = 0.0;         ///< as in Frame::inputs: gauge Pa, Pa below ambient, N, rad
};

/// Everything known at one stamp. Absent is absent.
struct Frame {
  std::int64_t stamp_ns = 0;  ///< as the bodies' source stamped it; its latency is subtracted
  double stamp_s() const { return to_seconds(stamp_ns); }
  std::optional<Eigen::Isometry3d> base_body;  ///< pose of Base::body in mocap; unused for a fixed base
  std::vector<BodyObservation> bodies;
  arm::InputValues inputs;           ///< empty or in the order of Arm::inputs.scalars
  std::optional<double> payload_kg;  ///< known payload; absent: PayloadMount::default_kg or unknown
  /// What came of the inputs since the frame before, up to this one's stamp; by input, then by stamp. Empty
  /// where their stamps are not known.
  std::vector<InputSample> samples;
};

/// What the steps between the stamps of one input are like.
struct StepPattern {
  double median_s = 0.0;
  bool irregular = false;  ///< all over the place: published on change, say
};

/// One input over a trial, by its own stamps.
struct SOFTARM_EXPORT InputSeries {
  std::vector<std::int64_t> stamp_ns;  ///< increasing; latency is subtracted
  std::vector<double> value;           ///< as in Frame::inputs: gauge Pa, Pa below ambient, N, rad
  arm::Between between = arm::Between::kHeld;
  /// kSampled: samples further apart do not follow one another, and the earlier one is held.
  std::int64_t longest_line_ns = 0;

  /// Adds a sample at its place in time; one of the same stamp is replaced.
  void add(std::int64_t at_ns, double sample);
  /// Decides on `between` and the longest line.
  /// @param stated by the arm file; absent: sampled if the samples come at a steady rate of 2 Hz or more
  void decide(std::optional<arm::Between> stated);
  /// @param pattern of its steps, where it is known; absent: too few
  void decide(std::optional<arm::Between> stated, const std::optional<StepPattern>& pattern);
  /// Its value at an instant; absent before the first sample.
  std::optional<double> at(double stamp_s) const { return at_ns(to_nanoseconds(stamp_s)); }
  std::optional<double> at_ns(std::int64_t t_ns) const;
  /// The same where the sample before is no older than that.
  std::optional<double> fresh_at_ns(std::int64_t t_ns, double max_age_s) const;
  /// Drops samples that no instant from then on needs, once they are more than a number.
  void forget_before(double stamp_s, std::size_t at_most);
};

/// The frames of one recording, and what drove the arm meanwhile.
struct Trial {
  std::string name;
  std::vector<trial::Frame> frames;
  /// One per Arm::inputs.scalars, or none: then what the frames hold is all that is known.
  std::vector<InputSeries> inputs = {};
};

}  // namespace softarm::trial
