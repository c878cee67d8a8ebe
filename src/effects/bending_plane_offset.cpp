// All actuators sit turned about the arm's axis.
#include <algorithm>

#include "arm/actuators/actuator.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class BendingPlaneOffset : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override {
    return std::any_of(arm.segments.begin(), arm.segments.end(), arm::is_bent);
  }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape*, const Memory&,
           rod::Rod& rod) const override {
    const Eigen::Rotation2Dd turn(values[0]);
    for (rod::Segment& piece : rod.segments) piece.moment_nm.head<2>() = turn * piece.moment_nm.head<2>();
  }
};

}  // namespace

std::unique_ptr<Effect> make_bending_plane_offset() {
  return std::make_unique<BendingPlaneOffset>(
      Info{"bending_plane_offset",
           "the actuators bend the arm in other directions than the arm file says, turned about its axis",
           "directions of all actuators turned by the angle about the arm's axis",
           "directions of actuators: R. J. Webster, B. A. Jones, Int. J. Robotics Research 29, 2010, "
           "doi:10.1177/0278364910368147",
           Family::kActuation,
           {{"angle_rad", "rad", "by which all directions are turned", -3.2, 3.2, 0.087}},
           1,
           {"chamber_mismatch", "torsion"},
           {}});
}

}  // namespace softarm::effects
