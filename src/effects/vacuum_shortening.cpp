// Length (1 - share V / 60 kPa).
#include <algorithm>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kLeastFactor = 0.1;

class VacuumShortening : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return has(arm, arm::InputKind::kVacuum); }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory&, rod::Rod& rod) const override {
    std::vector<double> factor;
    for (const arm::Segment& segment : arm.segments)
      factor.push_back(std::max(
          kLeastFactor, 1.0 - values[0] * vacuum_pa(arm, segment, instant.inputs) / kReferenceVacuumPa));
    for (std::size_t j = 0; j < fine.pieces().size(); ++j)
      rod.segments[j].length_m *= factor[static_cast<std::size_t>(fine.pieces()[j].segment)];
  }
};

}  // namespace

std::unique_ptr<Effect> make_vacuum_shortening() {
  return std::make_unique<VacuumShortening>(
      Info{"vacuum_shortening",
           "the arm grows shorter, or longer, with the vacuum",
           "L (1 - share V / 60 kPa)",
           "arm with a jammed core: P. Fairchild et al., ASME Lett. Dyn. Syst. Control 3, 2023, "
           "doi:10.1115/1.4064090",
           Family::kActuation,
           {{"share", "1", "of the length, by which it shrinks up to a vacuum of 60 kPa", -0.3, 0.7, 0.01}},
           1,
           {"axial_compliance", "pressure_elongation"},
           {"length"}});
}

}  // namespace softarm::effects
