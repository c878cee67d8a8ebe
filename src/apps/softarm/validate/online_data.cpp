#include "online_data.h"

#include <cmath>

#include "circle_fit.h"
#include "math/parallel.h"
#include "printed_fit.h"
#include "softarm/estimate/estimator.h"

namespace softarm::app::validate {
namespace {

constexpr std::uint64_t kOnlinePaper = 2;
// Three markers of 0.5 mm noise, 20 mm off the axis, define the plane of a set: 0.5 / (20 sqrt(3/2)) = 0.020
// rad.
constexpr double kPositionSd = 0.5e-3, kPlaneSd = 0.02;

/// Fifteen combinations of three pressures: a baseline in all chambers (their Figure 5 has several), and one
/// or two chambers above it. A standing arm is bent on by its load, and with more than half of a hanging
/// one's pressures it would fold over; the paper's condition is a tip angle under 180 degrees.
std::vector<double> draw_pressures(std::size_t set, bool standing, Draw& draw) {
  const double baseline = 10e3 * static_cast<double>(set % 3);
  const double above = standing ? draw.uniform(4e3, 10e3) : draw.uniform(15e3, 35e3);
  const std::size_t first = set % 3, second = (set / 3) % 2 ? (first + 1) % 3 : first;
  const double share = draw.uniform(0.3, 1.0);
  std::vector<double> p(3, baseline);
  p[first] += above;
  if (second != first) p[second] += share * above;
  return p;
}

/// Measured points in the rod's base frame; the true ones, for the same bodies, are those of the rig.
std::vector<Eigen::Vector3d> measured_points(const trial::Frame& frame,
                                             const Eigen::Isometry3d& base_in_mocap) {
  std::vector<Eigen::Vector3d> points;
  for (const trial::BodyObservation& body : frame.bodies)
    points.emplace_back(base_in_mocap.inverse() * body.p_mocap);
  return points;
}

OnlineFit judge(const std::vector<Eigen::Vector3d>& shape, const std::vector<Eigen::Vector3d>& measured,
                const rig::Truth& truth, double length_m) {
  OnlineFit fit;
  fit.ok = true;
  std::vector<Eigen::Vector3d> error, true_error;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    error.emplace_back(shape[i] - measured[i]);
    true_error.emplace_back(shape[i] - truth.rings_base[i].p);
  }
  fit.error_percent = online_error_percent(error, length_m);
  fit.truth_percent = online_error_percent(true_error, length_m);
  fit.tip_mm = 1e3 * true_error.back().norm();
  return fit;
}

/// The estimators of one experiment; one per thread.
class Methods {
 public:
  explicit Methods(const arm::Arm& arm) : arm_(arm) {
    for (std::size_t m = 0; m < kOnlineMethods.size(); ++m)
      for (std::size_t o = 0; o < kOnlineObjectives.size(); ++o)
        estimators_.push_back(make(kOnlineMethods[m], kOnlineObjectives[o], arm::Unknown::kStiffness, arm));
  }

  OnlineFrame estimate(const trial::Frame& frame, const rig::Truth& truth, bool standing, bool printed) {
    OnlineFrame result;
    result.frame = frame;
    result.payload_kg = *frame.payload_kg;
    result.true_stiffness_nm2 = truth.segments.front().bending_stiffness_nm2;
    result.tip_angle_rad = truth.tip_angle_rad;
    const double length_m = arm_.total_length_m();
    for (std::size_t m = 0; m < kOnlineMethods.size(); ++m) {
      for (std::size_t o = 0; o < kOnlineObjectives.size(); ++o)
        result.fits[m][o] = run(estimators_[m * kOnlineObjectives.size() + o], frame, truth);
    }
    // The estimator refuses arcs that lie grossly off; the paper's baseline counts them.
    const std::vector<Eigen::Vector3d> seen =
        measured_points(frame, *frame.base_body * arm_.base.rod_in_body);
    result.fits[2][0] = judge(fit_circle(seen, length_m), seen, truth, length_m);
    if (!printed) return result;
    // The printed law, from where the exact one ended.
    estimate::Estimator& exact = estimators_[1];
    exact.reset();
    const estimate::Estimate& estimate = exact.estimate(frame);
    if (estimate.status != estimate::Status::kOk) return result;
    const estimate::SegmentEstimate& segment = estimate.segments.front();
    published::PublishedArm start;
    start.moment_nm = segment.moment_nm.value_or(0.1);
    start.direction_rad = segment.direction_rad.value_or(0.0);
    start.bending_stiffness_nm2 = segment.bending_stiffness_nm2.value_or(0.03);
    start.length_m = segment.length_m.value_or(length_m);
    start.payload_n = kGravity * *frame.payload_kg;
    start.weight_n = kGravity * arm_.segments.front().mass_per_length_kg_m * length_m;
    start.mounting = standing ? published::Mounting::kStanding : published::Mounting::kHanging;
    const std::vector<Eigen::Vector3d> points = measured_points(frame, estimate.base_in_mocap);
    if (const auto fit = fit_printed(points, start, published::LoadLaw::kPrinted)) {
      result.printed = judge(fit->p_base, points, truth, length_m);
      result.printed.bending_stiffness_nm2 = fit->bending_stiffness_nm2;
    }
    return result;
  }

  /// The payload, EI given.
  OnlineFit weigh(const trial::Frame& frame, const rig::Truth& truth, double stiffness_nm2,
                  arm::Objective objective) {
    arm::Arm arm = arm_;
    arm::StiffnessLaw& law = arm.segments.front().bending_stiffness;
    law.base_nm2 = stiffness_nm2;
    law.per_min_pressure_nm2_per_pa = 0.0;
    estimate::Estimator estimator = make(arm::Method::kFullPoints, objective, arm::Unknown::kPayload, arm);
    trial::Frame unknown = frame;
    unknown.payload_kg.reset();
    return run(estimator, unknown, truth);
  }

 private:
  static estimate::Estimator make(arm::Method method, arm::Objective objective, arm::Unknown unknown,
                                  const arm::Arm& arm) {
    arm::EstimatorOptions options = arm.estimator;
    options.method = method;
    options.objective = objective;
    options.unknown = unknown;
    options.robust = objective == arm::Objective::kLeastSquares;  // the paper sets no point aside
    estimate::Estimator estimator(arm, options);
    estimator.set_backbone_points(static_cast<int>(arm.bodies.size()) + 1);  // at i L / K
    return estimator;
  }

  OnlineFit run(estimate::Estimator& estimator, const trial::Frame& frame, const rig::Truth& truth) const {
    estimator.reset();
    const estimate::Estimate& estimate = estimator.estimate(frame);
    if (estimate.status != estimate::Status::kOk) return {};
    std::vector<Eigen::Vector3d> shape;
    for (std::size_t i = 1; i < estimate.backbone.size(); ++i) shape.push_back(estimate.backbone[i].p_base);
    OnlineFit fit =
        judge(shape, measured_points(frame, estimate.base_in_mocap), truth, arm_.total_length_m());
    fit.bending_stiffness_nm2 = estimate.segments.front().bending_stiffness_nm2;
    fit.payload_kg = estimate.payload_kg;
    fit.identifiable = estimator.options().unknown == arm::Unknown::kPayload
                           ? estimate.identifiable_payload
                           : estimate.segments.front().identifiable_stiffness;
    return fit;
  }

  arm::Arm arm_;
  std::vector<estimate::Estimator> estimators_;
};

/// EI of the first data set: the mean of the loaded estimates of one repeat.
std::optional<double> stiffness_of_set(const OnlineSet& set, std::size_t repeat, std::size_t objective) {
  std::vector<double> values;
  for (const auto& frames : set.datasets) {
    const OnlineFrame& frame = frames[repeat];
    const OnlineFit& fit = frame.fits[0][objective];
    if (frame.payload_kg > 0.0 && fit.ok && fit.bending_stiffness_nm2)
      values.push_back(*fit.bending_stiffness_nm2);
  }
  if (values.empty()) return std::nullopt;
  return statistics(values).mean;
}

}  // namespace

const std::vector<double>& online_payloads_kg() {
  static const std::vector<double> payloads{0.0, 0.15, 0.17, 0.19, 0.21, 0.23};
  return payloads;
}

double online_error_percent(const std::vector<Eigen::Vector3d>& errors_m, double length_m) {
  double sum = 0.0;
  for (std::size_t i = 0; i < errors_m.size(); ++i)
    sum += errors_m[i].norm() / (static_cast<double>(i + 1) * length_m);
  return 100.0 * sum;
}

std::vector<OnlineSet> online_experiment(const OnlineSetting& setting, const Settings& settings, int sets,
                                         int repeats) {
  const arm::Arm arm = shipped_arm("online_200mm");
  rig::Scenario scenario = shipped_scenario("demo");
  if (setting.standing) scenario.mount.q_mocap_base = Eigen::Quaterniond::Identity();
  if (setting.quality == Quality::kRealLike) make_real_like(scenario, 0.0, 0.0);
  scenario.mocap.ring_noise = {kPositionSd, kPlaneSd};
  // The same pressures and weights on the ideal and on the real-like arm.
  Draw draw(seed_of(settings.seed, kOnlinePaper, setting.standing ? 1 : 0));
  std::vector<OnlineSet> result(static_cast<std::size_t>(sets));
  std::vector<double> unseen_kg;
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i].pressures_pa = draw_pressures(i, setting.standing, draw);
    result[i].baseline_pa = 10e3 * static_cast<double>(i % 3);
    unseen_kg.push_back(draw.uniform(0.14, 0.24));
  }

  math::in_parallel(result.size(), settings.jobs, [&](std::size_t i) {
    OnlineSet& set = result[i];
    std::vector<Hold> holds;
    for (double kg : online_payloads_kg()) holds.push_back({set.pressures_pa, {}, {}, 0.0, kg});
    holds.push_back({{0.0, 0.0, 0.0}, {}, {}, 0.0, 0.0});
    holds.push_back({set.pressures_pa, {}, {}, 0.0, unseen_kg[i]});
    HoldTiming timing;
    timing.frames = repeats;
    if (setting.standing) {
      timing.dwell_s = 6.0;  // near buckling it comes to rest slowly
    } else {
      timing.viscoelastic_lag_s = 0.15;
    }
    const std::vector<Held> held = run_holds(
        scenario, arm, holds, seed_of(settings.seed, kOnlinePaper, 100 + 10 * i + setting.standing), timing);
    Methods methods(arm);
    for (std::size_t h = 0; h < held.size(); ++h) {
      set.moving_m = std::max(set.moving_m, held[h].moving_m);
      if (h == online_payloads_kg().size()) continue;  // at rest
      std::vector<OnlineFrame> frames;
      for (const trial::Frame& frame : held[h].frames)
        frames.push_back(methods.estimate(frame, held[h].truth, setting.standing, frames.empty()));
      if (h < online_payloads_kg().size()) {
        set.datasets.push_back(std::move(frames));
        continue;
      }
      set.unseen = std::move(frames);
      for (std::size_t r = 0; r < set.unseen.size(); ++r) {
        for (std::size_t o = 0; o < kOnlineObjectives.size(); ++o) {
          if (const auto stiffness = stiffness_of_set(set, r, o))
            set.unseen[r].weighed[o] =
                methods.weigh(held[h].frames[r], held[h].truth, *stiffness, kOnlineObjectives[o]);
        }
      }
    }
  });
  return result;
}

}  // namespace softarm::app::validate
