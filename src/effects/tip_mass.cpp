// A fitting at the tip that nobody weighed.
#include "effects.h"

namespace softarm::effects {
namespace {

class TipMass : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape*, const Memory&,
           rod::Rod& rod) const override {
    rod.loads[rod::kTipMassLoad].mass_kg += values[0];
  }
};

}  // namespace

std::unique_ptr<Effect> make_tip_mass() {
  return std::make_unique<TipMass>(Info{"tip_mass",
                                        "a mass hangs at the tip that is not in the arm file",
                                        "force m g at x(L)",
                                        "loads on a rod: D. C. Rucker, R. J. Webster, IEEE Trans. Robotics "
                                        "27, 2011, doi:10.1109/TRO.2011.2160469",
                                        Family::kLoad,
                                        {{"mass_kg", "kg", "mass of what hangs there", 0.0, 2.0, 0.015}},
                                        1,
                                        {"mass_distribution", "tether", "payload_scale"},
                                        {"bending_stiffness"}});
}

}  // namespace softarm::effects
