// The payload's centre is not where the arm file has it.
#include "effects.h"

namespace softarm::effects {
namespace {

class PayloadOffset : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape*, const Memory&,
           rod::Rod& rod) const override {
    rod.loads[rod::kPayloadLoad].offset_m += values.head<3>();
  }
};

}  // namespace

std::unique_ptr<Effect> make_payload_offset() {
  return std::make_unique<PayloadOffset>(
      Info{"payload_offset",
           "the payload's centre is not where the arm file says",
           "force m g at x(L) + R(L) (offset of the arm file + (x, y, z))",
           "loads on a rod: D. C. Rucker, R. J. Webster, IEEE Trans. Robotics 27, 2011, "
           "doi:10.1109/TRO.2011.2160469",
           Family::kLoad,
           {{"x_m", "m", "offset across the arm, along x of its section", -0.2, 0.2, 0.01},
            {"y_m", "m", "offset across the arm, along y of its section", -0.2, 0.2, 0.01},
            {"z_m", "m", "offset along the arm, away from the base", -0.2, 0.2, 0.02}},
           3,
           {"mass_distribution", "payload_scale"},
           {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
