#include "effects.h"

namespace softarm::effects {

const std::vector<std::unique_ptr<Effect>>& catalogue() {
  static const std::vector<std::unique_ptr<Effect>> all = [] {
    std::vector<std::unique_ptr<Effect>> list;
    for (const auto make :
         {// Body, boundary, load, and where bodies are seen.
          make_stiffness_taper, make_soft_spot, make_rigid_ends, make_actuation_taper, make_base_compliance,
          make_base_tilt, make_gravity_direction, make_axial_compliance, make_shear, make_strain_stiffening,
          make_contact, make_tether, make_payload_offset, make_tip_mass, make_mass_distribution,
          make_payload_scale, make_marker_slip, make_bending_plane_offset, make_torsion, make_rest_curvature,
          make_inertia, make_published_load_law,
          // Sensors of the inputs, actuation, memory: in the order in which they act on the inputs.
          make_clock_offset, make_pressure_offset, make_pressure_lag, make_pressure_leak, make_hysteresis,
          make_pressure_dead_zone, make_gain_nonlinearity, make_chamber_mismatch, make_pressure_stiffening,
          make_radial_expansion, make_pressure_elongation, make_vacuum_shortening, make_vacuum_gain,
          make_tendon_friction, make_creep, make_mullins, make_jamming_memory, make_jamming_yield,
          make_drift})
      list.push_back(make());
    for (std::size_t i = 0; i < list.size(); ++i) list[i]->set_rank(static_cast<int>(i));
    return list;
  }();
  return all;
}

const Effect* find(const std::string& id) {
  for (const std::unique_ptr<Effect>& effect : catalogue()) {
    if (effect->info().id == id) return effect.get();
  }
  return nullptr;
}

}  // namespace softarm::effects
