// Samples of all inputs, in order of arrival, to frames. The live node and the offline program share it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/fit/frame.h"

namespace softarm {

/// Groups body samples whose stamps agree within Inputs::body_sync_tolerance_s into one Frame and adds to it the inputs
/// and the payload that held at its stamp.
///
/// 1. Gate each sample: finite, not all zero, unit quaternion, not frozen, not jumping, not older than what was emitted.
/// 2. A frame closes when every expected body has arrived, or when a sample of a later frame arrives.
/// 3. Pressures and payload are held from the newest sample at or before the frame's stamp (pressures no older than
///    Inputs::pressure_max_age_s).
/// 4. A stamp that goes back by more than a second is a time jump: everything is forgotten, `time_jumps` counts it.
///
/// Time comes from stamps alone, so that a replayed bag gives the frames that the live node saw.
class FrameAssembler {
 public:
  static constexpr int kBaseBody = -1;  ///< index of Base::body; bodies of Arm::bodies have theirs

  explicit FrameAssembler(const Arm& arm);

  /// @param p_mocap m, @param q_mocap body to mocap, absent if the driver gives positions only
  void add_body(int body, double stamp_s, const Eigen::Vector3d& p_mocap,
                const std::optional<Eigen::Quaterniond>& q_mocap);
  /// @param value_pa in Pa as the source reports it (absolute or gauge as configured); converted to gauge or vacuum
  void add_input(int input, double stamp_s, double value_pa);
  /// @param kg absent: unknown from now on
  void add_payload(double stamp_s, std::optional<double> kg);

  /// Closed frames in order of their stamps; each is returned once.
  std::vector<Frame> take();
  /// Closes what is still open, at the end of a recording.
  void flush();
  void reset();

  /// True once after each time jump: the caller resets the estimator.
  bool take_time_jump();

  /// Samples rejected so far by reason ("nan", "all_zero", "zero_quaternion", "frozen", "jump", "late", "duplicate",
  /// "time_jump", "pressure_nan", ...), per body or input: "frozen ring_2".
  const std::map<std::string, std::uint64_t>& rejected() const { return rejected_; }
  std::uint64_t samples() const { return samples_; }

 private:
  std::map<std::string, std::uint64_t> rejected_;
  std::uint64_t samples_ = 0;
  // (private members are the implementer's)
};

}  // namespace softarm
