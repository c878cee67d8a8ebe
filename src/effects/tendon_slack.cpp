// A cable that a servo winds up is slack at first: an angle is lost before it pulls.
//
// Sharp, without any pull up to the angle that is lost, where both parameters are equal. The edge is a
// parameter of its own so that the size acts in proportion.
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class TendonSlack : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override {
    return std::any_of(arm.segments.begin(), arm.segments.end(),
                       [](const arm::Segment& segment) { return !segment.cables.empty(); });
  }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    return {Eigen::Vector2d(0.0, 0.04), Eigen::Vector2d(0.0, 0.12)};
  }
  bool drives() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    if (values[0] == 0.0) return;
    const double edge_rad = std::max(values[1], 1e-4);
    for (const Eigen::Index row : rows_of(arm, arm::InputKind::kAngle)) {
      for (Eigen::Index i = 0; i < series.moment_inputs.cols(); ++i) {
        double& angle = series.moment_inputs(row, i);
        const double size = std::abs(angle);
        angle = std::copysign(std::max(0.0, size - values[0] * std::min(1.0, size / edge_rad)), angle);
      }
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_tendon_slack() {
  return std::make_unique<TendonSlack>(
      Info{"tendon_slack",
           "cables are slack at first: an angle of the servo is lost before they pull",
           "bends as the angle less lost min(1, |angle| / edge)",
           "a dead zone is a form of its own; tendons of a rod: D. C. Rucker, R. J. Webster, IEEE Trans. "
           "Robotics 27, 2011, doi:10.1109/TRO.2011.2160469",
           Family::kActuation,
           {{"lost_rad", "rad", "angle that takes up the slack", 0.0, 3.0, 0.05},
            {"edge_rad", "rad", "angle from which on all of it is lost", 0.002, 3.0, 0.05}},
           1,
           {"hysteresis", "rest_curvature"},
           {"curvature_gain"}});
}

}  // namespace softarm::effects
