// Gravity along the wrong axis, or the wrong way: the arm's sag shows it, and its payload.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "block_fit.h"
#include "clock_problem.h"
#include "context.h"
#include "math/statistics.h"
#include "policy.h"
#include "residuals.h"

namespace softarm::check {
namespace {

/// How far the outermost body falls under the payloads that are told, from the least to the most.
struct Fall {
  double fall_m = 0.0, sd_m = 0.0;
};

/// Whether a hand may be on the arm, or it swings from that.
bool disturbed(const Context& context, double t_s) {
  for (std::size_t i = 1; i < context.payload.size(); ++i) {
    const double since_s = t_s - context.payload[i].t_s;
    if (context.payload[i].value != context.payload[i - 1].value && since_s > -kPolicy.dead.hung_on_s &&
        since_s < kPolicy.dead.swings_s)
      return true;
  }
  return false;
}

double payload_at(const Context& context, double t_s) {
  double kg = context.payload.front().value;
  for (const ValuePoint& point : context.payload)
    if (point.t_s <= t_s) kg = point.value;
  return kg;
}

/// Place along gravity as an answer to inputs and payload.
std::optional<Fall> fall_of(const Context& context) {
  const Track* tip = outermost(context);
  const double step_s = std::max(kPolicy.clocks.sample_s, context.duration_s / kPolicy.clocks.most_samples);
  auto problem = clock_problem(context, 0.0, step_s, false);
  if (!tip || !problem || context.payload.empty()) return std::nullopt;
  problem->with_plays = false;
  problem->hats.setZero();
  const Eigen::MatrixXd inputs = regressors(*problem, 0.0);
  Eigen::MatrixXd a(inputs.rows(), inputs.cols() + 2), along(inputs.rows(), 1);
  std::vector<int> block;
  Eigen::Index n = 0;
  double least_kg = std::numeric_limits<double>::infinity(), most_kg = -least_kg;
  for (Eigen::Index row = 0; row < inputs.rows(); ++row) {
    const auto sample = static_cast<std::size_t>(row);
    const double t_s = problem->t_s[sample];
    if (disturbed(context, t_s)) continue;
    const auto place = tip->mean_position(t_s - step_s, t_s + step_s);
    if (!place) continue;  // hardly seen there
    const double kg = payload_at(context, t_s);
    along(n, 0) = place->dot(context.arm.gravity_m_s2.normalized());
    a.row(n) << inputs.row(row), 1.0, kg;
    block.push_back(problem->block[sample]);
    ++n;
    least_kg = std::min(least_kg, kg);
    most_kg = std::max(most_kg, kg);
  }
  if (n < kPolicy.clocks.least_samples || !(most_kg > least_kg)) return std::nullopt;
  auto payload = a.col(a.cols() - 1).head(n).array();
  payload = (payload - least_kg) / (most_kg - least_kg);  // of order 1, as the inputs
  const BlockFit fit = fit_in_blocks(a.topRows(n), along.topRows(n), block);
  return Fall{fit.x(fit.x.rows() - 1, 0), std::sqrt(fit.covariance.back()(0, 0))};
}

/// Whatever an arm is like, what is hung on it does work: it falls.
/// @return whether it is said
bool say_payload_rises(Context& context) {
  const std::optional<Fall> fall = fall_of(context);
  if (!fall || fall->fall_m > -(context.of_length(kPolicy.gravity.rises) + kPolicy.gravity.sds * fall->sd_m))
    return false;
  const Eigen::Vector3d other = Eigen::Vector3d::Zero() - context.arm.gravity_m_s2;  // no "-0.000"
  CheckFinding& finding = context.add("gravity", "",
                                      fmt::format("under its payload the outermost body rises by {:.2g} mm "
                                                  "(sd {:.1g}), against gravity as the arm file states it",
                                                  -1e3 * fall->fall_m, 1e3 * fall->sd_m));
  finding.figure = -fall->fall_m;
  finding.unit = "m";
  finding.remedy =
      "gravity points the other way, or payloads are stated where none is attached: set gravity in the arm "
      "file, or up in the mocap software or the import layout (mocap.up)";
  finding.setting = fmt::format("gravity_m_s2: [{:.3f}, {:.3f}, {:.3f}]", other.x(), other.y(), other.z());
  return true;
}

void check_gravity(Context& context) {
  const arm::Arm& arm = context.arm;
  if (arm.gravity_m_s2.norm() < kPolicy.gravity.none_m_s2 ||
      context.recording.frames.size() < kPolicy.gravity.least_frames)
    return;
  if (say_payload_rises(context) || arm.bodies.size() < kPolicy.gravity.least_bodies) return;
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
