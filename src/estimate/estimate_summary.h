// What came out of a recording, in a few lines.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/estimate/estimator.h"

namespace softarm::estimate {

/// Collects the estimates of one recording and prints their summary table.
class EstimateSummary {
 public:
  /// @param arm as it was estimated: its estimator's options say what was known
  explicit EstimateSummary(const arm::Arm& arm);

  void add(const Estimate& estimate);

  std::uint64_t frames() const { return frames_; }
  std::uint64_t ok() const { return ok_; }
  /// Stamps of the last less the first frame, s.
  double duration_s() const { return frames_ > 1 ? last_stamp_s_ - first_stamp_s_ : 0.0; }

  /// The table, one "name: value" a line, SI units with their symbols; the same input gives the same text.
  /// @param rejected samples that no frame used, by reason (FrameAssembler::rejected())
  /// @param samples all samples that were offered
  std::string text(const std::map<std::string, std::uint64_t>& rejected, std::uint64_t samples) const;

  /// Why frames have no estimate, of those that are most: what the estimator said first, and which samples
  /// were not used.
  std::string why_none(const std::map<std::string, std::uint64_t>& rejected) const;

 private:
  struct Refused {
    std::uint64_t count = 0;
    std::string detail = {};  // of the first
  };
  struct TooFar {
    std::uint64_t frames = 0;
    double first_m = 0.0;  // from the base, in the first of them
  };
  struct Segment {
    std::string name = {};
    std::vector<double> bending_stiffness_nm2, identifiable_bending_stiffness_nm2, moment_nm, length_m;
    std::map<WhyNot, std::uint64_t> why_not;  // frames in which EI is not identifiable
  };

  bool payload_known_, stiffness_known_;
  std::string remedy_;  // where EI is not identifiable: by the options in force
  std::vector<std::string> body_names_;
  std::vector<std::uint64_t> set_aside_;  // frames ok without the body, an outlier
  std::vector<TooFar> too_far_;           // of each body
  double length_m_;                       // of the arm
  std::vector<Segment> segments_;
  std::vector<double> payload_kg_, identifiable_payload_kg_, rms_residual_m_, tip_angle_rad_,
      reduced_chi_square_;
  std::map<std::string, Refused> not_ok_;  // by status
  std::uint64_t frames_ = 0, ok_ = 0;
  double first_stamp_s_ = 0.0, last_stamp_s_ = 0.0;
};

}  // namespace softarm::estimate
