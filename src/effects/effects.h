// The effects of the catalogue; each is made in a file of its own.
#pragma once

#include <memory>
#include <utility>

#include "catalogue.h"
#include "model/effect.h"

namespace softarm::effects {

// An effect is written with the names of the model.
using arm::Arm;
using arm::InputKind;
using model::Bodies;
using model::Effect;
using model::Family;
using model::FineRod;
using model::Info;
using model::Instant;
using model::Memory;
using model::Motion;
using model::Parameter;
using model::Piece;
using model::Present;
using model::Series;
using model::Shape;
using model::Values;

/// An effect with its description.
class Described : public Effect {
 public:
  explicit Described(Info info) : info_(std::move(info)) {}
  const Info& info() const override { return info_; }

 private:
  const Info info_;
};

// Body, boundary, load, and where bodies are seen.
std::unique_ptr<Effect> make_stiffness_taper();
std::unique_ptr<Effect> make_base_compliance();
std::unique_ptr<Effect> make_tether();
std::unique_ptr<Effect> make_marker_slip();
std::unique_ptr<Effect> make_soft_spot();
std::unique_ptr<Effect> make_rigid_ends();
std::unique_ptr<Effect> make_actuation_taper();
std::unique_ptr<Effect> make_base_tilt();
std::unique_ptr<Effect> make_gravity_direction();
std::unique_ptr<Effect> make_axial_compliance();
std::unique_ptr<Effect> make_shear();
std::unique_ptr<Effect> make_strain_stiffening();
std::unique_ptr<Effect> make_contact();
std::unique_ptr<Effect> make_payload_offset();
std::unique_ptr<Effect> make_tip_mass();
std::unique_ptr<Effect> make_mass_distribution();
std::unique_ptr<Effect> make_payload_scale();
std::unique_ptr<Effect> make_bending_plane_offset();
std::unique_ptr<Effect> make_torsion();
std::unique_ptr<Effect> make_rest_curvature();
std::unique_ptr<Effect> make_inertia();
std::unique_ptr<Effect> make_published_load_law();

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
