// Moments of all actuators times (1 - share V / 60 kPa).
#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class VacuumGain : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return has(arm, arm::InputKind::kVacuum); }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory&, rod::Rod& rod) const override {
    std::vector<double> factor;
    for (const arm::Segment& segment : arm.segments)
      factor.push_back(1.0 - values[0] * vacuum_pa(arm, segment, instant.inputs) / kReferenceVacuumPa);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j)
      rod.segments[j].moment_nm *= factor[static_cast<std::size_t>(fine.pieces()[j].segment)];
  }
};

}  // namespace

std::unique_ptr<Effect> make_vacuum_gain() {
  return std::make_unique<VacuumGain>(
      Info{"vacuum_gain",
           "the actuators bend the arm less, or more, under vacuum",
           "M0 (1 - share V / 60 kPa)",
           "arm with a jammed core: P. Fairchild et al., ASME Lett. Dyn. Syst. Control 3, 2023, "
           "doi:10.1115/1.4064090",
           Family::kActuation,
           {{"share", "1", "of the moments, that is lost at a vacuum of 60 kPa", -1.0, 1.0, 0.1}},
           1,
           {"jamming_yield", "jamming_memory"},
           {"per_jamming_pressure", "bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
