// Gravity is not where the arm file says: the capture volume's floor is not level.
#include <cmath>

#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector3d;

class GravityDirection : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  void act(const arm::Arm& arm, const FineRod&, const Values& values, const Instant& instant, const Shape*,
           const Memory&, rod::Rod& rod) const override {
    const double size = arm.gravity_m_s2.norm(), off = values.head<2>().norm();
    if (size == 0.0 || off == 0.0) return;
    const Vector3d down = arm.gravity_m_s2 / size;
    // The shortest turn that brings -z to gravity brings x and y across it.
    const Eigen::Quaterniond level = Eigen::Quaterniond::FromTwoVectors(-Vector3d::UnitZ(), down);
    const Vector3d across = level * Vector3d(values[0], values[1], 0.0);
    const Vector3d change = size * (std::sin(off) / off * across + (std::cos(off) - 1.0) * down);
    rod.gravity_m_s2 += instant.q_base_mocap * change;
  }
};

}  // namespace

std::unique_ptr<Effect> make_gravity_direction() {
  return std::make_unique<GravityDirection>(
      Info{"gravity_direction",
           "gravity does not point in the direction that the arm file says",
           "g turned by two small angles in the mocap frame",
           "weight of a rod: D. C. Rucker, R. J. Webster, IEEE Trans. Robotics 27, 2011, "
           "doi:10.1109/TRO.2011.2160469",
           Family::kLoad,
           {{"towards_x_rad", "rad", "turn of gravity towards x of the mocap frame", -0.15, 0.15, 0.0175},
            {"towards_y_rad", "rad", "turn of gravity towards y of the mocap frame", -0.15, 0.15, 0.0175}},
           2,
           {"pressure_offset", "base_tilt"},
           {"bending_stiffness"},
           true});
}

}  // namespace softarm::effects
