// What actuators do depends on how far the arm is bent: chambers that bulge or fold, tendons whose lever
// changes.
#include <algorithm>

#include "arm/actuators/actuator.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kReference_per_m = 5.0;  // curvature at which the gain is higher by the share

class CurvatureGain : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  bool answers_evenly() const override { return true; }
  bool applies_to(const arm::Arm& arm) const override {
    return std::any_of(arm.segments.begin(), arm.segments.end(), arm::is_bent);
  }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double bent = shape->middles[j].u.head<2>().norm() / kReference_per_m;
      rod.segments[j].moment_nm *= std::max(0.0, 1.0 + values[0] * bent);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_curvature_gain() {
  return std::make_unique<CurvatureGain>(Info{
      "curvature_gain",
      "the moments of the actuators depend on how far the arm is bent",
      "M0 (1 + share |u| / (5 / m))",
      "chambers of a soft arm: A. D. Marchese, R. K. Katzschmann, D. Rus, Soft Robotics 2, 2015, "
      "doi:10.1089/soro.2014.0022",
      Family::kActuation,
      {{"share", "1", "of the moments, by which they are higher at a curvature of 5 / m", -0.9, 3.0, 0.1}},
      1,
      {"strain_stiffening", "gain_nonlinearity"},
      {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
