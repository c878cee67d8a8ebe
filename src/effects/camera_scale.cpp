// Motion capture was calibrated with a wand of another length: all distances are off by one factor.
#include "capture.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class CameraScale : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  void observe(const arm::Arm& arm, const Values& values, const Instant& instant,
               Bodies& bodies) const override {
    distort(
        arm, instant, [&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return values[0] * x; }, bodies);
  }
};

}  // namespace

std::unique_ptr<Effect> make_camera_scale() {
  return std::make_unique<CameraScale>(
      Info{"camera_scale",
           "motion capture measures all distances too long, or too short, by one share",
           "x_measured = (1 + share) x, x from the origin of the capture",
           "errors of the calibration: L. Chiari et al., Gait & Posture 21, 2005, "
           "doi:10.1016/j.gaitpost.2004.04.004",
           Family::kSensor,
           {{"share", "1", "by which distances are measured too long", -0.2, 0.2, 0.005}},
           1,
           {"pressure_elongation", "marker_slip", "camera_bow"},
           {"length", "moment_gain", "bending_stiffness"}});
}

}  // namespace softarm::effects
