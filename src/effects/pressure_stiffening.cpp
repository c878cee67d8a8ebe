// EI (1 + share p / 50 kPa), p the mean pressure, beyond the law of the arm file.
#include <algorithm>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kLeastStiffness = 0.02;  // no law holds for what is left of EI then

class PressureStiffening : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return has(arm, arm::InputKind::kPressure); }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory&, rod::Rod& rod) const override {
    std::vector<double> factor;
    for (const arm::Segment& segment : arm.segments)
      factor.push_back(std::max(
          kLeastStiffness, 1.0 + values[0] * mean_pressure_pa(arm, segment, instant.inputs) / kReferencePa));
    for (std::size_t j = 0; j < fine.pieces().size(); ++j)
      rod.segments[j].bending_compliance /= factor[static_cast<std::size_t>(fine.pieces()[j].segment)];
  }
};

}  // namespace

std::unique_ptr<Effect> make_pressure_stiffening() {
  return std::make_unique<PressureStiffening>(Info{
      "pressure_stiffening",
      "the bending stiffness changes with the pressure, beyond what the arm file says",
      "EI (1 + share p / 50 kPa), p the mean pressure",
      "M. Roshanfar et al., Micromachines 14, 2023, doi:10.3390/mi14050900",
      Family::kConstitutive,
      {{"share", "1", "of EI, by which it grows up to a mean pressure of 50 kPa", -0.9, 5.0, 0.15}},
      1,
      {"radial_expansion", "gain_nonlinearity"},
      {"bending_stiffness", "per_min_pressure", "per_mean_pressure", "per_jamming_pressure", "saturation"}});
}

}  // namespace softarm::effects
