// A small scenario for the tests of the virtual rig.
#pragma once

namespace softarm::rig {

inline constexpr char kScenarioText[] = R"(format: 1
name: case
seed: 18446744073709551615
duration_s: 10
arm:
  length_m: 0.2
  mass_kg: 0.2
  bending_stiffness:
    base_nm2: 0.027
    per_min_pressure_nm2_per_pa: 3.0e-7
  chambers:
    - {bending_direction_deg: 0, moment_gain_nm_per_pa: 6.1e-6, near_elongation_m_per_pa: 3.0e-8}
    - {bending_direction_deg: 120, moment_gain_nm_per_pa: 7.8e-6, far_elongation_m_per_pa: 2.0e-8}
    - {bending_direction_deg: -120, moment_gain_nm_per_pa: 6.5e-6}
mount:
  position_m: [0.1, -0.2, 1]
  attitude: hanging
pressures:
  rate_hz: 50
  settle_s: 0.5
  ramp_s: 2
  random: {min_pa: 0, max_pa: 40000}
payload:
  schedule:
    - {t_s: 0, kg: 0.1}
    - {t_s: 5, kg: 0.2}
mocap:
  rate_hz: 120
  ring_fractions: [0.5, 1.0]
  dropout_probability: 0.1
)";

}  // namespace softarm::rig
