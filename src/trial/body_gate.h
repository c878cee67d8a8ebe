// Whether the samples of one tracked body can be trusted.
#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace softarm::trial {

/// Limits of BodyGate. The defaults suit motion capture of a soft arm at 30 ... 1000 Hz.
struct GateLimits {
  double max_speed_m_s = 5.0;      ///< faster is a jump; soft arms move at well under 2 m/s
  double max_rate_rad_s = 60.0;    ///< same for the orientation
  double jump_allowance_m = 0.01;  ///< never called a jump, whatever the rate
  double jump_allowance_rad = 0.35;
  double noise_multiple = 10.0;    ///< ... nor is anything within this many standard deviations
  int followed_after_samples = 5;  ///< a jump that stays where it went for so many samples ...
  double followed_after_s = 0.05;  ///< ... and so long is followed: the body was really moved or remounted
  double frozen_after_s = 0.25;    ///< a bit-identical pose for so long ...
  int frozen_after_samples = 10;   ///< ... and so many samples is frozen, if other bodies changed meanwhile
  double absurd_position_m = 1e4;  ///< beyond it no coordinate is a measurement
};

/// Gates the samples of one body in their order.
///
/// Measured poses always carry noise, so one that repeats to the last bit while others change is a tracker
/// that keeps sending its last value. A pose far from the last good one is an exchange of labels or a ghost,
/// unless it stays there. Comparisons are written so that NaN fails them (REP 117).
class BodyGate {
 public:
  enum class Verdict { kAccept, kNan, kAbsurd, kAllZero, kZeroQuaternion, kBadQuaternion, kFrozen, kJump };
  static const char* name(Verdict verdict);

  /// What the arm asks of the body.
  struct Body {
    bool needs_orientation = false;  ///< a sample without a valid quaternion is useless
    bool may_rest = false;           ///< a mount: a pose that never changes is no fault
    double position_sd_m = 0.0;
    double orientation_sd_rad = 0.0;
  };

  explicit BodyGate(const Body& body, const GateLimits& limits = {}) : body_(body), limits_(limits) {}

  /// @param q orientation as reported; normalised on acceptance, removed where it is unusable and not needed
  /// @param others_changed_s newest stamp at which another body's pose is known to have changed
  Verdict check(double stamp_s, const Eigen::Vector3d& p, std::optional<Eigen::Quaterniond>& q,
                std::optional<double> others_changed_s);

  /// Stamp at which the reported pose last changed.
  std::optional<double> changed_s() const { return changed_s_; }
  /// Of the last two such stamps the earlier: one of them may be damaged. Absent before the second; a first
  /// pose is no change.
  std::optional<double> surely_changed_s() const;
  /// Stamp of the last sample that was accepted.
  std::optional<double> accepted_s() const { return good_ ? std::optional(good_->stamp_s) : std::nullopt; }
  /// True if the sample has exactly the pose that was reported last.
  bool repeats(const Eigen::Vector3d& p, const std::optional<Eigen::Quaterniond>& q) const;
  void reset() { *this = BodyGate(body_, limits_); }

 private:
  struct Pose {
    double stamp_s = 0.0;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    std::optional<Eigen::Quaterniond> q;
  };

  Verdict check_numbers(const Eigen::Vector3d& p, std::optional<Eigen::Quaterniond>& q) const;
  bool is_frozen(double stamp_s, const Eigen::Vector3d& p, const std::optional<Eigen::Quaterniond>& q,
                 std::optional<double> others_changed_s);
  bool reachable(const Pose& from, const Pose& to) const;
  bool is_jump(const Pose& now);

  Body body_;
  GateLimits limits_;
  std::optional<Pose> reported_;  // last pose with valid numbers, whatever became of it
  std::optional<double> changed_s_, changed_before_s_;
  int identical_ = 0;
  int changes_ = 0;
  std::optional<Pose> good_;
  std::optional<Pose> elsewhere_;  // last sample of a jump that may turn out to be a move
  double elsewhere_since_s_ = 0.0;
  int elsewhere_count_ = 0;
};

}  // namespace softarm::trial
