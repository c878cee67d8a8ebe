// Gravity along the wrong axis: the arm's sag shows it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "math/statistics.h"
#include "policy.h"
#include "residuals.h"

namespace softarm::check {
namespace {

constexpr std::size_t kFrames = 40;

}  // namespace

void check_gravity(Context& context) {
  const arm::Arm& arm = context.arm;
  if (arm.gravity_m_s2.norm() < 1.0 || context.recording.frames.size() < 20) return;
  if (arm.bodies.size() < 3) return;  // too few to see the shape of a sag
  double noise_m = 0.0;
  for (const Track& track : context.tracks) noise_m = std::max(noise_m, track.white_sd_m);
  const Residuals as_is = residuals_of(context, arm, kFrames, false);
  if (as_is.rms_m.size() < 10) return;
  const double now_m = math::median(as_is.rms_m);
  if (now_m < 3.0 * noise_m + context.of_length(kPolicy.places.sag)) return;
  double least_m = now_m;
  Eigen::Vector3d best = arm.gravity_m_s2;
  for (int k = 0; k < 6; ++k) {
    arm::Arm turned = arm;
    turned.gravity_m_s2 = (k % 2 ? 1.0 : -1.0) * arm.gravity_m_s2.norm() * Eigen::Vector3d::Unit(k / 2);
    if ((turned.gravity_m_s2 - arm.gravity_m_s2).norm() < 0.1) continue;
    const Residuals other = residuals_of(context, turned, kFrames, false);
    if (other.rms_m.size() < as_is.rms_m.size() / 2) continue;
    const double rms_m = math::median(other.rms_m);
    if (rms_m < least_m) {
      least_m = rms_m;
      best = turned.gravity_m_s2;
    }
  }
  if (least_m > 0.5 * now_m) return;
  CheckFinding& finding = context.add(
      Severity::kSerious, "gravity", "",
      fmt::format(
          "the arm sags as if gravity were ({:.1f}, {:.1f}, {:.1f}) m/s^2: shapes then fit to {:.2g} mm "
          "instead of {:.2g} mm",
          best.x(), best.y(), best.z(), 1e3 * least_m, 1e3 * now_m));
  finding.figure = now_m;
  finding.unit = "m";
  finding.remedy =
      "the mocap frame's up axis is not what the arm file says: set it in the mocap software (z up), "
      "in the import layout (mocap.up) or in the arm file";
  finding.setting = fmt::format("inputs.bodies.axes, or gravity_m_s2: [{:.3f}, {:.3f}, {:.3f}]", best.x(),
                                best.y(), best.z());
}

}  // namespace softarm::check
