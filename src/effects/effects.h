// The effects of the catalogue; each is made in a file of its own.
#pragma once

#include <memory>
#include <utility>

#include "softarm/effects/effect.h"

namespace softarm::effects {

/// An effect with its description.
class Described : public Effect {
 public:
  explicit Described(Info info) : info_(std::move(info)) {}
  const Info& info() const override { return info_; }

 private:
  const Info info_;
};

std::unique_ptr<Effect> make_stiffness_taper();
std::unique_ptr<Effect> make_base_compliance();
std::unique_ptr<Effect> make_tether();
std::unique_ptr<Effect> make_marker_slip();

// Sensors of the inputs, actuation, memory.
std::unique_ptr<Effect> make_clock_offset();
std::unique_ptr<Effect> make_pressure_offset();
std::unique_ptr<Effect> make_pressure_lag();
std::unique_ptr<Effect> make_pressure_leak();
std::unique_ptr<Effect> make_hysteresis();
std::unique_ptr<Effect> make_pressure_dead_zone();
std::unique_ptr<Effect> make_gain_nonlinearity();
std::unique_ptr<Effect> make_chamber_mismatch();
std::unique_ptr<Effect> make_pressure_stiffening();
std::unique_ptr<Effect> make_radial_expansion();
std::unique_ptr<Effect> make_pressure_elongation();
std::unique_ptr<Effect> make_vacuum_shortening();
std::unique_ptr<Effect> make_vacuum_gain();
std::unique_ptr<Effect> make_tendon_friction();
std::unique_ptr<Effect> make_creep();
std::unique_ptr<Effect> make_mullins();
std::unique_ptr<Effect> make_jamming_memory();
std::unique_ptr<Effect> make_jamming_yield();
std::unique_ptr<Effect> make_drift();

}  // namespace softarm::effects
