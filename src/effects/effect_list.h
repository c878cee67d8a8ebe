// The catalogue: one line per effect, make_<name>() in the file of that name.
//
// First those of body, boundary and load, and of where bodies are seen; then sensors of the inputs, actuation
// and memory, in the order in which they act on the inputs.
#pragma once

// clang-format off
#define SOFTARM_EFFECTS(EFFECT) \
  EFFECT(stiffness_taper) \
  EFFECT(soft_spot) \
  EFFECT(rigid_ends) \
  EFFECT(actuation_taper) \
  EFFECT(base_compliance) \
  EFFECT(base_free_play) \
  EFFECT(base_tilt) \
  EFFECT(gravity_direction) \
  EFFECT(axial_compliance) \
  EFFECT(shear) \
  EFFECT(strain_stiffening) \
  EFFECT(curvature_softening) \
  EFFECT(plane_stiffness) \
  EFFECT(one_sided_softness) \
  EFFECT(curvature_gain) \
  EFFECT(contact) \
  EFFECT(tether) \
  EFFECT(payload_offset) \
  EFFECT(tip_mass) \
  EFFECT(mass_distribution) \
  EFFECT(payload_scale) \
  EFFECT(marker_slip) \
  EFFECT(skin_marker) \
  EFFECT(camera_scale) \
  EFFECT(camera_bow) \
  EFFECT(bending_plane_offset) \
  EFFECT(torsion) \
  EFFECT(rest_curvature) \
  EFFECT(inertia) \
  EFFECT(published_load_law) \
  EFFECT(clock_offset) \
  EFFECT(clock_drift) \
  EFFECT(pressure_offset) \
  EFFECT(supply_sag) \
  EFFECT(pressure_lag) \
  EFFECT(flow_limit) \
  EFFECT(pressure_leak) \
  EFFECT(hysteresis) \
  EFFECT(pressure_dead_zone) \
  EFFECT(gain_nonlinearity) \
  EFFECT(chamber_bulge) \
  EFFECT(chamber_mismatch) \
  EFFECT(pressure_stiffening) \
  EFFECT(radial_expansion) \
  EFFECT(pressure_elongation) \
  EFFECT(vacuum_shortening) \
  EFFECT(vacuum_gain) \
  EFFECT(tendon_friction) \
  EFFECT(tendon_slack) \
  EFFECT(tendon_length) \
  EFFECT(creep) \
  EFFECT(axial_memory) \
  EFFECT(mullins) \
  EFFECT(jamming_memory) \
  EFFECT(jamming_yield) \
  EFFECT(drift) \
  EFFECT(temperature)
// clang-format on
