// The arm is not straight at rest; the bend is fixed in its body.
#include "effects.h"

namespace softarm::effects {
namespace {

class RestCurvature : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  std::vector<Values> grid(const arm::Arm& arm, const FineRod&) const override {
    std::vector<Values> list{Eigen::Vector3d::Zero()};
    if (arm.segments.size() > 1) {
      for (std::size_t i = 1; i <= arm.segments.size(); ++i)
        list.push_back(Eigen::Vector3d(0.0, 0.0, static_cast<double>(i)));
    }
    return list;
  }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape*,
           const Memory&, rod::Rod& rod) const override {
    const int only = static_cast<int>(values[2] + 0.5) - 1;
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      if (only >= 0 && fine.pieces()[j].segment != only) continue;
      // Bent towards x is turned about y.
      rod.segments[j].rest_curvature_per_m += Eigen::Vector3d(-values[1], values[0], 0.0);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_rest_curvature() {
  return std::make_unique<RestCurvature>(
      Info{"rest_curvature",
           "the arm is not straight when nothing drives or loads it",
           "M = EI (u - u_rest)",
           "S. S. Antman, Nonlinear Problems of Elasticity, 2005, doi:10.1007/0-387-27649-1",
           Family::kConstitutive,
           {{"towards_x_per_m", "1/m", "curvature at rest, towards the section's x", -50.0, 50.0, 0.3},
            {"towards_y_per_m", "1/m", "curvature at rest, towards the section's y", -50.0, 50.0, 0.3},
            {"segment", "1", "that is curved, from the base; 0: all", 0.0, 16.0, 0.0}},
           2,
           {"pressure_offset", "base_tilt", "jamming_memory"},
           {"moment_gain"}});
}

}  // namespace softarm::effects
