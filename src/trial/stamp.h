// The stamp of a sample on its way to a frame.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "softarm/trial/trial.h"

namespace softarm::trial {

/// An instant as its source stamps it: the nanoseconds go into the frame as they came, the seconds serve
/// comparisons. Of a source that counts seconds the nearest nanosecond; not finite where it is beyond all
/// dates.
struct Stamp {
  std::int64_t ns = 0;
  double s = 0.0;

  Stamp() = default;
  Stamp(double seconds) : s(seconds) {
    if (std::abs(seconds) < kLast_s)
      ns = to_nanoseconds(seconds);
    else if (std::isfinite(seconds))
      s = std::numeric_limits<double>::quiet_NaN();
  }
  static Stamp from_ns(std::int64_t ns) {
    Stamp stamp;
    stamp.ns = ns;
    stamp.s = to_seconds(ns);
    return stamp;
  }
  Stamp later(double by_s) const { return earlier(-by_s); }
  Stamp earlier(double by_s) const {
    Stamp stamp = *this;
    stamp.ns -= to_nanoseconds(by_s);
    stamp.s -= by_s;
    return stamp;
  }

 private:
  static constexpr double kLast_s = 9e9;  // of the year 2255; 64 bits end in 2262
};

}  // namespace softarm::trial
