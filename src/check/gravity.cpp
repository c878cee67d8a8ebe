// Gravity along the wrong axis, or the wrong way: the arm's sag shows it, and its payload.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "clock_problem.h"
#include "context.h"
#include "math/linear_algebra.h"
#include "math/statistics.h"
#include "policy.h"
#include "residuals.h"

namespace softarm::check {
namespace {

/// How far the outermost body falls under the payloads that are told, from the least to the most.
struct Fall {
  double fall_m = 0.0, sd_m = 0.0;
};

/// Times of the samples that no hand disturbs, as rows of a matrix.
std::vector<Eigen::Index> undisturbed(const Context& context, const std::vector<double>& t_s) {
  std::vector<Eigen::Index> rows;
  for (std::size_t k = 0; k < t_s.size(); ++k) {
    bool disturbed = false;
    for (std::size_t i = 1; i < context.payload.size(); ++i) {
      const double since_s = t_s[k] - context.payload[i].t_s;
      disturbed = disturbed || (context.payload[i].value != context.payload[i - 1].value &&
                                since_s > -kPolicy.dead.hung_on_s && since_s < kPolicy.dead.swings_s);
    }
    if (!disturbed) rows.push_back(static_cast<Eigen::Index>(k));
  }
  return rows;
}

double payload_at(const Context& context, double t_s) {
  double kg = context.payload.front().value;
  for (const ValuePoint& point : context.payload)
    if (point.t_s <= t_s) kg = point.value;
  return kg;
}

/// Place along gravity as an answer to inputs and payload; residuals are one within a block of the problem's.
std::optional<Fall> fall_of(const Context& context) {
  const Track* tip = outermost(context);
  const double step_s = std::max(kPolicy.clocks.sample_s, context.duration_s / kPolicy.clocks.most_samples);
  auto problem = clock_problem(context, 0.0, step_s, false);
  if (!tip || !problem || context.payload.empty()) return std::nullopt;
  problem->with_plays = false;
  problem->hats.setZero();
  const std::vector<Eigen::Index> rows = undisturbed(context, problem->t_s);
  const Eigen::MatrixXd inputs = regressors(*problem, 0.0);
  const auto n = static_cast<Eigen::Index>(rows.size()), columns = inputs.cols() + 2;
  if (n < kPolicy.clocks.least_samples) return std::nullopt;
  Eigen::MatrixXd a(n, columns);
  Eigen::VectorXd along(n);
  double least_kg = std::numeric_limits<double>::infinity(), most_kg = -least_kg;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index row = rows[static_cast<std::size_t>(i)];
    const double t_s = problem->t_s[static_cast<std::size_t>(row)], kg = payload_at(context, t_s);
    const auto place = tip->mean_position(t_s - step_s, t_s + step_s);
    if (!place) return std::nullopt;
    along[i] = place->dot(context.arm.gravity_m_s2.normalized());
    a.row(i) << inputs.row(row), 1.0, kg;
    least_kg = std::min(least_kg, kg);
    most_kg = std::max(most_kg, kg);
  }
  if (!(most_kg > least_kg)) return std::nullopt;
  Eigen::MatrixXd normal = a.transpose() * a;
  normal.diagonal().array() += 1e-10 * normal.diagonal().maxCoeff();
  const Eigen::MatrixXd inverse = math::inverse_of_symmetric(normal);
  const Eigen::VectorXd x = inverse * (a.transpose() * along), left = along - a * x;
  double variance = 0.0, moved = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto block = [&](Eigen::Index k) {
      return problem->block[static_cast<std::size_t>(rows[static_cast<std::size_t>(k)])];
    };
    moved += inverse.row(columns - 1).dot(a.row(i)) * left[i];
    if (i + 1 < n && block(i + 1) == block(i)) continue;
    variance += moved * moved;
    moved = 0.0;
  }
  return Fall{x[columns - 1] * (most_kg - least_kg), std::sqrt(variance) * (most_kg - least_kg)};
}

/// Whatever an arm is like, what is hung on it does work: it falls.
/// @return whether it is said
bool say_payload_rises(Context& context) {
  const std::optional<Fall> fall = fall_of(context);
  if (!fall || fall->fall_m > -(context.of_length(kPolicy.gravity.rises) + kPolicy.gravity.sds * fall->sd_m))
    return false;
  const Eigen::Vector3d other = Eigen::Vector3d::Zero() - context.arm.gravity_m_s2;  // no "-0.000"
  CheckFinding& finding = context.add(
      "gravity", "",
      fmt::format(
          "under its payload the outermost body rises by {:.2g} mm (sd {:.1g}), against gravity as the "
          "arm file has it",
          -1e3 * fall->fall_m, 1e3 * fall->sd_m));
  finding.figure = -fall->fall_m;
  finding.unit = "m";
  finding.remedy =
      "gravity points the other way, or payloads are told where none hang: set gravity in the arm file, or "
      "up "
      "in the mocap software or the import layout (mocap.up)";
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
