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

void check_gravity(Context& context) {
  const arm::Arm& arm = context.arm;
  if (arm.gravity_m_s2.norm() < kPolicy.gravity.none_m_s2 ||
      context.recording.frames.size() < kPolicy.gravity.least_frames)
    return;
  if (arm.bodies.size() < kPolicy.gravity.least_bodies) return;
  double noise_m = 0.0;
  for (const Track& track : context.tracks) noise_m = std::max(noise_m, track.white_sd_m);
  const Residuals as_is = residuals_of(context, arm, kPolicy.gravity.most_frames, false);
  if (as_is.rms_m.size() < kPolicy.gravity.least_fits) return;
  const double now_m = math::median(as_is.rms_m);
  if (now_m < kPolicy.gravity.sag_noises * noise_m + context.of_length(kPolicy.gravity.sag)) return;
  double least_m = now_m;
  Eigen::Vector3d best = arm.gravity_m_s2;
  for (int k = 0; k < 6; ++k) {
    arm::Arm turned = arm;
    turned.gravity_m_s2.setZero();
    turned.gravity_m_s2[k / 2] = (k % 2 ? 1.0 : -1.0) * arm.gravity_m_s2.norm();
    if ((turned.gravity_m_s2 - arm.gravity_m_s2).norm() < kPolicy.gravity.same_m_s2) continue;
    const Residuals other = residuals_of(context, turned, kPolicy.gravity.most_frames, false);
    if (other.rms_m.size() < as_is.rms_m.size() / 2) continue;
    const double rms_m = math::median(other.rms_m);
    if (rms_m < least_m) {
      least_m = rms_m;
      best = turned.gravity_m_s2;
    }
  }
  if (least_m > kPolicy.gravity.better * now_m) return;
  CheckFinding& finding = context.add(
      "gravity", "",
      fmt::format(
          "the arm sags as if gravity were ({:.1f}, {:.1f}, {:.1f}) m/s^2: shapes then fit to {:.2g} mm "
          "instead of {:.2g} mm",
          best.x(), best.y(), best.z(), 1e3 * least_m, 1e3 * now_m));
  finding.figure = now_m;
  finding.unit = "m";
  finding.remedy =
      "the mocap frame's up axis is not what the arm file says: set it in the mocap software (z up), "
      "in the import layout (mocap.up) or in the arm file (inputs.bodies.axes, or gravity)";
  finding.setting = fmt::format("gravity_m_s2: [{:.3f}, {:.3f}, {:.3f}]", best.x(), best.y(), best.z());
}

}  // namespace

Check make_gravity() {
  return {check_gravity, {{"gravity", Severity::kSerious}}};
}

}  // namespace softarm::check
