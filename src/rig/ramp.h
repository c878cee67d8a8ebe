// A one-sided law with a smooth onset: private to the rig.
#pragma once

namespace softarm::rig {

/// 0 below 0, x - onset / 2 above the onset, and a parabola between them. With its derivative and integral.
struct Ramp {
  double value = 0.0, slope = 0.0, integral = 0.0;

  Ramp(double x, double onset) {
    if (x <= 0.0) return;
    if (x < onset) {
      value = 0.5 * x * x / onset;
      slope = x / onset;
      integral = x * x * x / (6.0 * onset);
    } else {
      value = x - 0.5 * onset;
      slope = 1.0;
      integral = 0.5 * x * (x - onset) + onset * onset / 6.0;
    }
  }
};

}  // namespace softarm::rig
