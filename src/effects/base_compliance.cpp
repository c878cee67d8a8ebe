// The clamp turns by a compliance times the bending moment that it bears; the measured base does not.
#include "effects.h"

namespace softarm::effects {
namespace {

class BaseCompliance : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  std::optional<std::pair<double, double>> place(const arm::Arm&, const Values&) const override {
    return std::make_pair(0.0, 0.0);
  }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape*, const Memory&,
           rod::Rod& rod) const override {
    // A joint at the rod's start bears the moment of the whole section: actuation is inside the arm and does
    // not reach the clamp.
    rod.segments.front().joint_compliance += values[0];
  }
};

}  // namespace

std::unique_ptr<Effect> make_base_compliance() {
  return std::make_unique<BaseCompliance>(
      Info{"base_compliance",
           "the base turns under the load, though the body measured as the base does not",
           "turn of the base = compliance M(0), M(0) the bending moment that the clamp bears",
           "conditions at the base: D. C. Rucker, R. J. Webster, IEEE Trans. Robotics 27, 2011, "
           "doi:10.1109/TRO.2011.2160469",
           Family::kBoundary,
           {{"compliance_rad_per_nm", "rad/(N m)", "turn of the clamp per bending moment that it bears", 0.0,
             10.0, 0.2}},
           1,
           {"rigid_ends", "shear", "soft_spot"},
           {"bending_stiffness", "joint_compliance"}});
}

}  // namespace softarm::effects
