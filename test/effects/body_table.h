// The effects of body, boundary and load, with sizes as a laboratory may meet them.
#pragma once

#include <ostream>

#include "body_fixture.h"

namespace softarm::effects::body_testing {

struct Case {
  friend std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.id; }
  const char* id;
  std::vector<double> small;  ///< values at which it still acts in proportion
  std::vector<double> large;  ///< several times what is usual
};

/// Of the 200 mm arm.
inline const std::vector<Case>& body_cases() {
  static const std::vector<Case> cases{
      {"stiffness_taper", {0.01}, {0.8}},
      {"soft_spot", {0.01, 0.087, 0.03}, {0.9, 0.087, 0.03}},
      {"rigid_ends", {0.0003, 0.001}, {0.05, 0.04}},
      {"actuation_taper", {0.01}, {-0.8}},
      {"base_compliance", {0.002}, {2.0}},
      {"base_free_play", {1e-4, 0.02}, {0.1, 0.01}},
      {"base_tilt", {0.001, -0.002}, {0.3, -0.3}},
      {"gravity_direction", {0.001, -0.002}, {0.3, 0.3}},
      {"axial_compliance", {1e-4}, {0.05}},
      {"shear", {3e-4}, {0.1}},
      {"strain_stiffening", {2e-5}, {0.02}},
      {"curvature_softening", {0.002, 3.0}, {1.0, 2.0}},
      {"plane_stiffness", {0.003, -0.004}, {0.5, 0.4}},
      {"one_sided_softness", {0.005, 0.9}, {0.5, 0.9}},
      {"curvature_gain", {0.005}, {0.6}},
      {"contact", {0.02, 0.14, 0.3, 0.01, 0.3, 0.0, 0.05}, {1000.0, 0.14, 0.3, 0.01, 0.5, 40.0, 0.0}},
      {"tether", {0.01, 1e-4, 0.05, -0.05, 0.02}, {300.0, 0.05, 0.05, -0.05, 0.02}},
      {"payload_offset", {3e-4, -3e-4, 3e-4}, {0.05, -0.05, 0.1}},
      {"tip_mass", {2e-4}, {0.15}},
      {"mass_distribution", {0.01}, {0.8}},
      {"payload_scale", {0.002}, {0.5}},
      {"marker_slip", {1e-3, -1e-3, 2e-3, 3.0}, {0.02, -0.02, 0.02, 3.0}},
      {"skin_marker", {1e-5, -1e-5, 2e-5, 0.0}, {0.002, -0.002, 0.002, 3.0}},
      {"camera_scale", {1e-3, -2e-3, 0.0}, {0.1, 0.1, 10.0}},
      {"camera_bow", {1e-3}, {0.1}},
      {"bending_plane_offset", {0.003}, {1.0}},
      {"torsion", {0.3, 0.002}, {300.0, 0.5}},
      {"rest_curvature", {0.01, -0.02, 0.0}, {5.0, -5.0, 0.0}},
      {"inertia", {0.02, 0.001}, {1.0, 0.1}},
      {"published_load_law", {0.01}, {1.0}},
  };
  return cases;
}

inline model::Values values_of(const std::vector<double>& list) {
  return Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
}

/// Bent about several ways, with and without payload, in three mountings.
inline std::vector<Condition> various(const arm::Arm& arm) {
  std::vector<Condition> list;
  const std::vector<Eigen::Quaterniond> mountings{hanging(), horizontal(), standing()};
  for (std::size_t m = 0; m < mountings.size(); ++m) {
    const double most_kg = m == 0 ? 0.15 : m == 1 ? 0.05 : 0.02;
    list.push_back({inputs_of(arm, 0.0), 0.0, mountings[m]});
    for (std::size_t first = 0; first < 3; ++first)
      list.push_back(
          {inputs_of(arm, first == 1 ? 0.5 : 0.9, first), first == 2 ? 0.0 : most_kg, mountings[m]});
  }
  return list;
}

/// A second of smooth motion at about 1 Hz.
inline std::vector<Condition> swinging(const arm::Arm& arm) {
  std::vector<Condition> list;
  for (int i = 0; i < 20; ++i)
    list.push_back({inputs_of(arm, 0.5 + 0.2 * std::sin(0.1 * i * 2.0 * M_PI), static_cast<std::size_t>(0)),
                    0.1, hanging()});
  return list;
}

}  // namespace softarm::effects::body_testing
