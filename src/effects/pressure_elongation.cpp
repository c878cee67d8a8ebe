// Length (1 + share p / 50 kPa), p the mean pressure, beyond the law of the arm file.
#include <algorithm>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kLeastFactor = 0.1;

class PressureElongation : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return has(arm, arm::InputKind::kPressure); }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory&, rod::Rod& rod) const override {
    std::vector<double> factor;
    for (const arm::Segment& segment : arm.segments)
      factor.push_back(std::max(
          kLeastFactor, 1.0 + values[0] * mean_pressure_pa(arm, segment, instant.inputs) / kReferencePa));
    for (std::size_t j = 0; j < fine.pieces().size(); ++j)
      rod.segments[j].length_m *= factor[static_cast<std::size_t>(fine.pieces()[j].segment)];
  }
};

}  // namespace

std::unique_ptr<Effect> make_pressure_elongation() {
  return std::make_unique<PressureElongation>(Info{
      "pressure_elongation",
      "the arm grows longer with the pressure, beyond what the arm file says",
      "L (1 + share p / 50 kPa), p the mean pressure",
      "length by pressures: P. Fairchild et al., ASME Lett. Dyn. Syst. Control 3, 2023, "
      "doi:10.1115/1.4064090",
      Family::kActuation,
      {{"share", "1", "of the length, by which it grows up to a mean pressure of 50 kPa", -0.5, 2.0, 0.025}},
      1,
      {"axial_compliance", "marker_slip"},
      {"length", "elongation"}});
}

}  // namespace softarm::effects
