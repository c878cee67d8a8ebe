// Moment of a chamber = gain p (1 + share |p| / 50 kPa).
#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class GainNonlinearity : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return !chamber_rows(arm).empty(); }
  bool drives() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    for (const Eigen::Index row : chamber_rows(arm)) {
      auto p = series.moment_inputs.row(row).array();
      p *= 1.0 + values[0] / kReferencePa * p.abs();
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_gain_nonlinearity() {
  return std::make_unique<GainNonlinearity>(
      Info{"gain_nonlinearity",
           "the moment of a chamber is not proportional to its pressure",
           "M = g p (1 + share |p| / 50 kPa)",
           "actuators of rubber: M. Roshanfar et al., Micromachines 14, 2023, doi:10.3390/mi14050900",
           Family::kActuation,
           {{"share", "1", "of the moment at 50 kPa, beyond the proportional one", -0.9, 5.0, 0.15}},
           1,
           {"pressure_stiffening", "pressure_dead_zone"},
           {"moment_gain", "saturation", "per_mean_pressure"}});
}

}  // namespace softarm::effects
