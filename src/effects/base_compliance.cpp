// The clamp turns by a compliance times the bending moment that it bears; the measured base does not.
#include "effects.h"
#include "math/so3.h"

namespace softarm::effects {
namespace {

class BaseCompliance : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool needs_strains() const override { return false; }
  bool needs_shape() const override { return true; }
  bool answers_evenly() const override { return true; }
  std::optional<std::pair<double, double>> place(const arm::Arm&, const Values&) const override {
    return std::make_pair(0.0, 0.0);
  }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    // What the rod exerts on the clamp, about the axes across it. Actuation is inside the arm and does not
    // reach the clamp: m is that of the whole section.
    Eigen::Vector3d moment = shape->base_moment_nm;
    moment.z() = 0.0;
    rod.q_base = math::exp_so3(values[0] * moment) * rod.q_base;
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
