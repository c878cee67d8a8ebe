// Two-term Mooney-Rivlin rubber under uniaxial load.
#pragma once

#include <optional>

namespace softarm::arm {

/// Incompressible rubber with strain energy W = C10 (I1 - 3) + C01 (I2 - 3) (hybrid paper (13)), stretched by
/// lambda along one axis and free sideways.
struct MooneyRivlin {
  double c10_pa = 0.0;
  double c01_pa = 0.0;

  /// 6 (C10 + C01): Young's modulus of the unstretched rubber, Pa.
  double initial_modulus_pa() const { return 6.0 * (c10_pa + c01_pa); }
  /// Force per undeformed area, 2 (C10 + C01 / lambda)(lambda - lambda^-2), Pa. (The slides of the
  /// single-chamber arm call lambda times this, the true stress, nominal.)
  double nominal_stress_pa(double stretch) const;
  /// Force per deformed area, Pa.
  double cauchy_stress_pa(double stretch) const { return stretch * nominal_stress_pa(stretch); }
  /// Derivative of the nominal stress by the stretch, Pa.
  double tangent_modulus_pa(double stretch) const;
  /// Derivative of the tangent modulus by the stretch, Pa.
  double tangent_modulus_slope_pa(double stretch) const;
  /// The stretch under a nominal stress, on the branch that is stable from the unstretched state on (positive
  /// tangent modulus all the way); nothing where the material has none, or is unstable when unstretched.
  std::optional<double> stretch_at(double nominal_stress_pa) const;
};

}  // namespace softarm::arm
