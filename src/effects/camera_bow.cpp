// What lenses leave: the measured space is bowed, the more the further from the middle of the capture.
#include "capture.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class CameraBow : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool observes() const override { return true; }
  void observe(const arm::Arm& arm, const Values& values, const Instant& instant,
               Bodies& bodies) const override {
    distort(
        arm, instant,
        [&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return values[0] * x.squaredNorm() * x; }, bodies);
  }
};

}  // namespace

std::unique_ptr<Effect> make_camera_bow() {
  return std::make_unique<CameraBow>(
      Info{"camera_bow",
           "the space that motion capture measures is bowed: distances are measured longer, or shorter, the "
           "further they are from the origin of the capture",
           "x_measured = (1 + bow |x|^2) x, x from the origin of the capture",
           "radial distortion of a lens: Z. Zhang, IEEE Trans. Pattern Analysis and Machine Intelligence 22, "
           "2000, doi:10.1109/34.888718",
           Family::kSensor,
           {{"bow_per_m2", "1/m^2", "share of the distance from the origin, at 1 m of it", -1.0, 1.0, 0.005}},
           1,
           {"camera_scale", "marker_slip", "base_tilt"},
           {"length", "moment_gain"}});
}

}  // namespace softarm::effects
