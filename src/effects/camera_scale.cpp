// Motion capture was calibrated with a wand of another length: all distances are off by one factor. Or with
// one that was moved along the floor: heights are off by another than the rest. Cameras that were cold then
// are off the more the warmer they get: by half of it after a time.
#include "capture.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kMinute_s = 60.0;

class CameraScale : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    return {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(0.0, 0.0, 15.0)};
  }
  std::string live_obstacle(const Values& values) const override {
    if (!(values[2] > 0.0)) return "";
    return "it says how warm the cameras were during the trials diagnosed, not how warm they are now";
  }
  bool observes() const override { return true; }
  void observe(const arm::Arm& arm, const Values& values, const Instant& instant,
               Bodies& bodies) const override {
    const double size = arm.gravity_m_s2.norm();
    const Eigen::Vector3d up =
        size > 0.0 ? Eigen::Vector3d(-arm.gravity_m_s2 / size) : Eigen::Vector3d::UnitZ();
    const double session_min = instant.session_s / kMinute_s;
    const double warm = values[2] > 0.0 ? session_min / (session_min + values[2]) : 1.0;
    distort(
        arm, instant,
        [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
          return warm * (values[0] * x + values[1] * up.dot(x) * up);
        },
        bodies);
  }
};

}  // namespace

std::unique_ptr<Effect> make_camera_scale() {
  return std::make_unique<CameraScale>(Info{
      "camera_scale",
      "motion capture measures all distances too long, or too short, by one factor, heights by another",
      "x_measured = (1 + share) x, heights by height_share more, x from the origin of the capture; both "
      "times "
      "t / (t + warms), t the session's time, where cameras warm up",
      "errors of the calibration: L. Chiari et al., Gait & Posture 21, 2005, "
      "doi:10.1016/j.gaitpost.2004.04.004",
      Family::kSensor,
      {{"share", "1", "by which distances are measured too long", -0.2, 0.2, 0.005},
       {"height_share", "1", "by which heights are measured longer than that", -0.2, 0.2, 0.005},
       {"warms_min", "min", "after which cameras that warm up are off by half of it; 0: from the beginning",
        0.0, 120.0, 0.0}},
      2,
      {"pressure_elongation", "marker_slip", "camera_bow", "temperature"},
      {"length", "moment_gain", "bending_stiffness"}});
}

}  // namespace softarm::effects
