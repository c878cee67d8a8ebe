// What a listener makes of estimates, beside the truth where there is one.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/time.h>
#include <softarm_estimator/ArmEstimate.h>
#include <softarm_estimator/Truth.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace softarm {

/// Collects estimates and truth, matched by their stamps.
class Tally {
 public:
  /// @param received when the message arrived, in the time of its stamp (simulated time may run in circles)
  /// @param wall_time the same on the wall: rates are real ones
  void add(const softarm_estimator::ArmEstimate& estimate, ros::Time received, ros::WallTime wall_time);
  void add(const softarm_estimator::Truth& truth);

  std::uint64_t frames() const { return frames_; }
  std::uint64_t ok() const { return ok_; }
  std::uint64_t compared() const { return shape_error_m_.size(); }

  /// What the estimator says of itself that is not well; the last word of each of its diagnostics counts.
  void add(const diagnostic_msgs::DiagnosticStatus& status);

  /// Why there is nothing to be seen, the likeliest reason in one line; empty where there are estimates.
  /// @param with_truth whether it is the virtual rig: what it shows must be identifiable now and then
  std::string trouble(bool with_truth) const;

  /// One line on the newest estimate.
  std::string line() const;
  /// The closing table. @param with_truth whether truth was to be expected
  std::string table(bool with_truth) const;

 private:
  /// Of one estimated quantity, over the frames that determine it.
  struct Errors {
    std::uint64_t count = 0, within_two_sd = 0;
    std::vector<double> absolute, truth;
    void add(double value, double sd, double true_value);
    std::string text(const char* unit, double per_unit, std::uint64_t of) const;
  };
  struct SegmentErrors {
    std::string name;
    Errors stiffness_nm2, moment_nm, length_m;
  };

  void compare(const softarm_estimator::ArmEstimate& estimate, const softarm_estimator::Truth& truth);

  std::uint64_t frames_ = 0, ok_ = 0, steadied_ = 0;
  struct Refused {
    std::uint64_t count = 0;
    std::string example;
    bool differ = false;
  };
  std::map<std::string, Refused> refused_;       // by the reason without its numbers
  std::map<std::string, std::string> not_well_;  // by the diagnostic's name
  std::optional<ros::WallTime> first_, last_;
  std::vector<double> latency_s_, shape_error_m_, tip_error_m_, residual_m_;
  std::uint64_t identifiable_stiffness_ = 0, identifiable_payload_ = 0;
  std::vector<SegmentErrors> segments_;  // from base to tip
  Errors payload_kg_;
  std::map<ros::Time, softarm_estimator::ArmEstimate> unmatched_estimates_;
  std::map<ros::Time, softarm_estimator::Truth> unmatched_truth_;
  std::optional<softarm_estimator::ArmEstimate> newest_;
};

}  // namespace softarm
