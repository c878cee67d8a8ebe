// What a node leaves out that cannot keep up.
#pragma once

#include <cstddef>
#include <optional>

namespace softarm {

/// Says how many of the frames at hand are answered. As long as the node keeps up, and after a hiccup, all
/// are. Where the frames at hand take longer than half of the latency to answer, round after round, only as
/// many as fit are, evenly spread, the newest always: what comes meanwhile waits no longer than the other
/// half.
class Overload {
 public:
  /// @param latency_s how much later than it could be a frame may be answered, s; 0: frames are never left
  /// out
  explicit Overload(double latency_s) : latency_s_(latency_s) {}

  /// @param frames at hand
  /// @param now_s of a clock that never goes back, s
  /// @return every how-manieth is to be answered, counted from the newest: 1 is all
  std::size_t stride(std::size_t frames, double now_s);
  /// A frame was answered in so many seconds.
  void took(double seconds);
  /// Whether frames are left out at present.
  bool lasts() const { return lasts_; }

 private:
  double latency_s_;
  double frame_s_ = 0.0;                  // what a frame takes, smoothed
  std::optional<double> behind_since_s_;  // rounds have been too long since
  double last_behind_s_ = 0.0;
  bool lasts_ = false;
};

}  // namespace softarm
