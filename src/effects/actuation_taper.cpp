// M0(s) = M0 (1 + a (2 s / L - 1)), along each segment: ends of chambers that do less, tendons that rub.
#include <algorithm>

#include "arm/actuators/actuator.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class ActuationTaper : public Described {
 public:
  using Described::Described;
  bool applies_to(const arm::Arm& arm) const override {
    return std::any_of(arm.segments.begin(), arm.segments.end(), arm::is_bent);
  }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape*,
           const Memory&, rod::Rod& rod) const override {
    for (std::size_t j = 0; j < fine.pieces().size(); ++j)
      rod.segments[j].moment_nm *= 1.0 + values[0] * (2.0 * fine.pieces()[j].middle_fraction() - 1.0);
  }
};

}  // namespace

std::unique_ptr<Effect> make_actuation_taper() {
  return std::make_unique<ActuationTaper>(
      Info{"actuation_taper",
           "the actuation does not bend the whole arm equally: less or more towards the tip",
           "M0(s) = M0 (1 + share (2 s / L - 1))",
           "curvature along the arm: R. J. Webster, B. A. Jones, Int. J. Robotics Research 29, 2010, "
           "doi:10.1177/0278364910368147",
           Family::kActuation,
           {{"share", "1", "by which its moment is higher at the tip, and lower at the base, than its mean",
             -0.9, 0.9, 0.1}},
           1,
           {"stiffness_taper", "tendon_friction"},
           {"moment_gain", "bending_stiffness"}});
}

}  // namespace softarm::effects
