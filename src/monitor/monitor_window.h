// The last quarter of a second of a stream, in bins.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "monitor_shape.h"

namespace softarm::monitor {

/// What a window says of each body: mean discrepancy, velocity and acceleration.
struct WindowMotion {
  double from_s = 0.0, to_s = 0.0;
  Displacements discrepancy, velocity, acceleration;  ///< at the middle; three rows per body
  std::vector<char> usable;                           ///< per body: seen in most of the window
  std::vector<double> samples;                        ///< per body: frames in it
};

/// Frames in, a window out at the end of every bin. Allocates nothing after its construction.
class MonitorWindow {
 public:
  explicit MonitorWindow(std::size_t bodies);

  void reset();
  /// @param seen per body
  /// @return whether a bin was completed (by the frame before this one) and the window is full
  bool add(double stamp_s, const Displacements& discrepancy, const Displacements& place,
           const std::vector<char>& seen);
  const WindowMotion& motion() const { return motion_; }

 private:
  struct Bin {
    double from_s = 0.0, to_s = 0.0;
    std::vector<double> time_s, count;  // per body; time: mean, from the bin's first frame
    Displacements discrepancy, place;   // means
  };
  void close();
  void fit();

  std::vector<Bin> bins_;  // a ring
  std::size_t next_ = 0, filled_ = 0;
  Bin open_;
  bool is_open_ = false;
  WindowMotion motion_;
};

}  // namespace softarm::monitor
