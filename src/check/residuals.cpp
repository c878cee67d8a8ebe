#include "residuals.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "math/statistics.h"
#include "policy.h"
#include "softarm/estimate/estimator.h"

namespace softarm::check {
namespace {

/// The pose of a track at a time; null where it has none within half a period.
const TrackPose* pose_at(const Track& track, double t_s) {
  const auto& poses = track.poses;
  const auto after = std::lower_bound(poses.begin(), poses.end(), t_s,
                                      [](const TrackPose& pose, double t) { return pose.t_s < t; });
  const TrackPose* nearest = nullptr;
  if (after != poses.end()) nearest = &*after;
  if (after != poses.begin() && (nearest == nullptr || t_s - std::prev(after)->t_s < nearest->t_s - t_s)) {
    nearest = &*std::prev(after);
  }
  if (nearest == nullptr || std::abs(nearest->t_s - t_s) > 0.5 * track.period_s + 1e-6) return nullptr;
  return nearest;
}

double seconds_of(const Context& context, const trial::Frame& frame) {
  return context.seconds(frame.stamp_s() + context.arm.inputs.body_latency_s);
}

/// The frame without what the checks found wrong; false where its base is.
bool clean(const Context& context, trial::Frame* frame) {
  const double t_s = seconds_of(context, *frame);
  if (const TrackPose* base = pose_at(context.tracks[0], t_s)) {
    if (!base->good || !base->q) return false;  // else it is seen now, or held
  }
  std::vector<trial::BodyObservation> seen;
  for (trial::BodyObservation body : frame->bodies) {
    const TrackPose* pose = pose_at(context.tracks[static_cast<std::size_t>(body.body) + 1], t_s);
    if (pose == nullptr || !pose->good) continue;
    body.p_mocap = pose->p;
    body.q_mocap = pose->q;
    seen.push_back(body);
  }
  frame->bodies = std::move(seen);
  return true;
}

Eigen::Quaterniond section_at(const estimate::Estimate& estimate, double arclength_m) {
  Eigen::Quaterniond section = Eigen::Quaterniond::Identity();
  double nearest_m = 1e9;
  for (const estimate::BackbonePoint& point : estimate.backbone) {
    const double away_m = std::abs(point.arclength_m - arclength_m);
    if (away_m >= nearest_m) continue;
    nearest_m = away_m;
    section = point.q_base;
  }
  return section;
}

bool is_fitted(const estimate::Estimate& e) {
  return e.status == estimate::Status::kOk || e.status == estimate::Status::kInconsistent;
}

/// A fit goes on from the last frame's. Where a nearly straight arm came to another shape of the same ends by
/// that, it would stay there: a frame that fits far worse than usual is fitted from its own shape, too.
estimate::Estimate best_of(estimate::Estimator& estimator, const trial::Frame& frame, double usual_rms_m) {
  estimate::Estimate best = estimator.estimate(frame);
  const bool is_usual =
      is_fitted(best) && (usual_rms_m == 0.0 || best.rms_residual_m < kPolicy.places.worse_fit * usual_rms_m);
  if (is_usual) return best;
  estimator.reset();
  const estimate::Estimate& anew = estimator.estimate(frame);
  const bool is_better = is_fitted(anew) && (!is_fitted(best) || anew.rms_residual_m < best.rms_residual_m);
  if (is_better) best = anew;
  return best;
}

}  // namespace

arm::Arm repaired_arm(const Context& context) {
  arm::Arm arm = context.arm;
  const double total_m = arm.total_length_m();
  double stretch = 1.0;
  for (const CheckFinding& f : context.findings) {
    if (f.id == "stretched" && f.severity != Severity::kInformation) stretch += *f.figure;
    if (f.id != "ring_misplaced") continue;
    for (arm::MeasuredBody& body : arm.bodies) {
      if (body.name == f.where) body.arclength_m = std::clamp(body.arclength_m + *f.figure, 0.0, total_m);
    }
  }
  for (arm::Segment& segment : arm.segments) segment.length_m *= stretch;
  for (arm::MeasuredBody& body : arm.bodies) body.arclength_m *= stretch;
  return arm;
}

Residuals residuals_of(const Context& context, const arm::Arm& arm, std::size_t most, bool with_sections) {
  Residuals result;
  result.bodies.resize(arm.bodies.size());
  result.tangents.resize(arm.bodies.size());
  arm::Arm copy = arm;
  if (!copy.payload.default_kg) copy.payload.default_kg = 0.0;
  copy.estimator.unknown = arm::Unknown::kStiffness;
  copy.estimator.robust = false;
  copy.estimator.window_s = 0.0;
  copy.estimator.prior.enabled = false;
  copy.estimator.method = arm::Method::kFullPoints;
  std::optional<estimate::Estimator> made;
  try {
    made.emplace(copy);
  } catch (const std::invalid_argument&) {
    return result;  // this arm cannot be fitted so: nothing to say
  }
  estimate::Estimator& estimator = *made;
  if (!with_sections) estimator.set_backbone_points(0);
  const auto& frames = context.recording.frames;
  const std::size_t step = std::max<std::size_t>(1, frames.size() / most);
  for (std::size_t i = 0; i < frames.size(); i += step) {
    trial::Frame frame = frames[i];
    if (!clean(context, &frame)) continue;
    const estimate::Estimate e = best_of(estimator, frame, math::median(result.rms_m));
    if (!is_fitted(e)) continue;
    if (e.residuals.size() < kPolicy.places.least_bodies && with_sections) continue;
    if (e.residuals.empty() || !std::isfinite(e.rms_residual_m)) continue;
    result.rms_m.push_back(e.rms_residual_m);
    const double t_s = seconds_of(context, frame);
    for (const estimate::BodyResidual& body : e.residuals) {
      const auto index = static_cast<std::size_t>(body.body);
      const Eigen::Quaterniond section = section_at(e, arm.bodies[index].arclength_m);
      result.bodies[index].push_back({t_s, section.conjugate() * (body.measured_base - body.estimated_base)});
      if (e.backbone.empty()) continue;
      for (const trial::BodyObservation& seen : frame.bodies) {
        if (seen.body != body.body || !seen.q_mocap) continue;
        const Eigen::Vector3d tangent_mocap =
            seen.q_mocap->normalized() * arm.bodies[index].section_in_body.linear().col(2);
        const Eigen::Vector3d tangent =
            section.conjugate() * (e.base_in_mocap.linear().transpose() * tangent_mocap);
        result.tangents[index].push_back({t_s, tangent - Eigen::Vector3d::UnitZ()});
      }
    }
  }
  return result;
}

Eigen::Vector3d mean_of(const ResidualSeries& residuals, std::size_t from, std::size_t to) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = from; i < to; ++i) sum += residuals[i].r;
  return sum / static_cast<double>(std::max<std::size_t>(1, to - from));
}

Eigen::Vector3d mean_of(const ResidualSeries& residuals) {
  return mean_of(residuals, 0, residuals.size());
}

double spread_of(const ResidualSeries& residuals) {
  double spread = 0.0;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> numbers;
    for (const Residual& r : residuals) numbers.push_back(r.r(k));
    spread = std::max(spread, math::robust_sd(numbers));
  }
  return spread;
}

double jitter_of(const ResidualSeries& residuals) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < residuals.size(); ++i) {
    for (int k = 0; k < 3; ++k) steps.push_back(residuals[i].r(k) - residuals[i - 1].r(k));
  }
  return math::robust_sd(steps) / std::sqrt(2.0);
}

double lasting_of(const ResidualSeries& residuals) {
  const Eigen::Vector3d mean = mean_of(residuals);
  double covariance = 0.0, variance = 0.0;
  int count = 0;
  for (std::size_t i = 1; i < residuals.size(); ++i) {
    if (residuals[i].t_s - residuals[i - 1].t_s > kPolicy.places.neighbours_s) continue;
    covariance += (residuals[i].r - mean).dot(residuals[i - 1].r - mean);
    variance += (residuals[i].r - mean).squaredNorm();
    ++count;
  }
  if (count < static_cast<int>(kPolicy.places.least_frames) ||
      !(covariance > kPolicy.places.chance * variance))
    return 0.0;
  return std::sqrt(covariance / count);
}

Slip slip_of(const ResidualSeries& residuals) {
  Slip worst;
  const std::size_t n = residuals.size();
  const double sd = std::max(jitter_of(residuals), 1e-6);
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  const Eigen::Vector3d all = mean_of(residuals) * static_cast<double>(n);
  for (std::size_t k = 1; k < n; ++k) {
    before += residuals[k - 1].r;
    if (k < n / kPolicy.places.ends || k > n - n / kPolicy.places.ends) continue;
    const double a = static_cast<double>(k), b = static_cast<double>(n - k);
    const Eigen::Vector3d change = (all - before) / b - before / a;
    const double z = change.norm() / (sd * std::sqrt(kPolicy.places.frames_per_value * (1.0 / a + 1.0 / b)));
    if (z > worst.significance) worst = {change.norm(), residuals[k].t_s, z};
  }
  return worst;
}

}  // namespace softarm::check
