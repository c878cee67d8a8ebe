// The arm stands tilted on the body that is measured as its base.
#include "along.h"
#include "effects.h"
#include "math/so3.h"

namespace softarm::effects {
namespace {

class BaseTilt : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape*, const Memory&,
           rod::Rod& rod) const override {
    rod.q_base = math::exp_so3(turn_towards(values[0], values[1])) * rod.q_base;
  }
};

}  // namespace

std::unique_ptr<Effect> make_base_tilt() {
  return std::make_unique<BaseTilt>(
      Info{"base_tilt",
           "the arm is not mounted on its base as the arm file says: it is tilted there",
           "q(0) = q_base q_tilt, the same at every input",
           "conditions at the base: D. C. Rucker, R. J. Webster, IEEE Trans. Robotics 27, 2011, "
           "doi:10.1109/TRO.2011.2160469",
           Family::kBoundary,
           {{"towards_x_rad", "rad", "tilt of the arm towards x of the base frame", -0.5, 0.5, 0.0175},
            {"towards_y_rad", "rad", "tilt of the arm towards y of the base frame", -0.5, 0.5, 0.0175}},
           2,
           {"rest_curvature", "gravity_direction"},
           {"bending_stiffness", "moment_gain"},
           true});
}

}  // namespace softarm::effects
