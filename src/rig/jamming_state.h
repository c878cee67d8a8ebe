// The memory of granules: private to the rig.
#pragma once

#include <cmath>

#include "input_path_spec.h"
#include "play.h"

namespace softarm::rig {

/// See JammingSettling.
class JammingState {
 public:
  JammingState(const JammingSettling& spec, double start_pa)
      : spec_(spec), loop_(spec.loop_pa, start_pa), vacuum_pa_(start_pa), short_pa_(0.0) {}

  /// Takes the vacuum straight to a value and gives the one that the stiffness goes by.
  double to(double vacuum_pa, double dt_s) {
    const double now = loop_.to(vacuum_pa);
    if (dt_s <= 0.0) return now - short_pa_;
    const double rate = (now - vacuum_pa_) / dt_s;
    // Short of the vacuum by d: d' = rate - rate / (1 + rate / r0) - d / compaction in a rise.
    double behind_pa = 0.0;
    if (rate > 0.0)
      behind_pa = rate * spec_.compaction_s * (1.0 - 1.0 / (1.0 + rate / spec_.rate_pa_per_s));
    else if (vacuum_pa_ > 0.0)
      short_pa_ *= now / vacuum_pa_;
    short_pa_ = behind_pa + (short_pa_ - behind_pa) * std::exp(-dt_s / spec_.compaction_s);
    vacuum_pa_ = now;
    return now - short_pa_;
  }

 private:
  JammingSettling spec_;
  PlayHysteresis loop_;
  double vacuum_pa_, short_pa_;
};

}  // namespace softarm::rig
