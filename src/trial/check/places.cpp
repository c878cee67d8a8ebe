// The estimator's residuals, averaged: rings that sit beside their places, or that moved during the trial;
// and gravity along the wrong axis.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "context.h"
#include "numbers.h"
#include "softarm/fit/estimator.h"

namespace softarm::check {
namespace {

constexpr std::size_t kMostFrames = 300, kGravityFrames = 40;
constexpr double kOffM = 0.00035;      // of a mean residual
constexpr double kLastingM = 0.00015;  // of residuals that stay for a while
constexpr double kTiltRad = 0.02;      // of a tangent against the fitted one
constexpr double kSlipM = 0.0005;      // of its change
constexpr double kBlock = 10;          // frames: a second, which are counted as one independent value

struct Residual {
  double t_s = 0.0;
  Eigen::Vector3d r = Eigen::Vector3d::Zero();  // measured less estimated, in the section frame
};

struct Fit {
  std::vector<std::vector<Residual>> bodies;  // as Arm::bodies
  /// Measured less estimated tangent where the body's orientation is known, in the section frame, rad.
  std::vector<std::vector<Residual>> tangents;
  std::vector<double> rms_m;
};

/// Every frame by itself, stiffness or whatever the arm's method can find free: only what no shape of the arm
/// explains remains.
Fit fit(const Context& context, const Arm& arm, std::size_t most, bool with_sections) {
  Fit result;
  result.bodies.resize(arm.bodies.size());
  result.tangents.resize(arm.bodies.size());
  Arm copy = arm;
  if (!copy.payload.default_kg) copy.payload.default_kg = 0.0;
  copy.estimator.unknown = Unknown::kStiffness;
  copy.estimator.robust = false;
  copy.estimator.window_s = 0.0;
  copy.estimator.prior.enabled = false;
  copy.estimator.method = Method::kFullPoints;
  std::optional<Estimator> made;
  try {
    made.emplace(copy);
  } catch (const std::invalid_argument&) {
    return result;  // this arm cannot be fitted so: nothing to say
  }
  Estimator& estimator = *made;
  if (!with_sections) estimator.set_backbone_points(0);
  const auto& frames = context.recording.frames;
  const std::size_t step = std::max<std::size_t>(1, frames.size() / most);
  for (std::size_t i = 0; i < frames.size(); i += step) {
    const Estimate& e = estimator.estimate(frames[i]);
    if (e.status != Status::kOk && e.status != Status::kInconsistent) continue;
    if (e.residuals.size() < 3 && with_sections) continue;
    if (e.residuals.empty() || !std::isfinite(e.rms_residual_m)) continue;
    result.rms_m.push_back(e.rms_residual_m);
    for (const BodyResidual& body : e.residuals) {
      Eigen::Quaterniond section = Eigen::Quaterniond::Identity();
      double nearest = 1e9;
      for (const BackbonePoint& point : e.backbone) {
        const double away =
            std::abs(point.arclength_m - arm.bodies[static_cast<std::size_t>(body.body)].arclength_m);
        if (away < nearest) {
          nearest = away;
          section = point.q_base;
        }
      }
      const auto index = static_cast<std::size_t>(body.body);
      const double t_s = frames[i].stamp_s - context.begin_s - context.body_epoch_s;
      result.bodies[index].push_back({t_s, section.conjugate() * (body.measured_base - body.estimated_base)});
      if (e.backbone.empty()) continue;
      for (const BodyObservation& seen : frames[i].bodies) {
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

Eigen::Vector3d mean_of(const std::vector<Residual>& residuals, std::size_t from, std::size_t to) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = from; i < to; ++i) sum += residuals[i].r;
  return sum / static_cast<double>(std::max<std::size_t>(1, to - from));
}

double spread_of(const std::vector<Residual>& residuals) {
  std::vector<double> x, y, z;
  for (const Residual& r : residuals) {
    x.push_back(r.r.x());
    y.push_back(r.r.y());
    z.push_back(r.r.z());
  }
  return std::max({robust_sd(x), robust_sd(y), robust_sd(z)});
}

/// From one frame to the next, in a coordinate: what does not last.
double jitter_of(const std::vector<Residual>& residuals) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < residuals.size(); ++i) {
    for (int k = 0; k < 3; ++k) steps.push_back(residuals[i].r(k) - residuals[i - 1].r(k));
  }
  return robust_sd(steps) / std::sqrt(2.0);
}

/// What lasts beyond a tenth of a second, of all coordinates together, beside the mean: root of the
/// covariance of neighbours; 0 where it is no more than chance.
double lasting_of(const std::vector<Residual>& residuals) {
  const Eigen::Vector3d mean = mean_of(residuals, 0, residuals.size());
  double covariance = 0.0, variance = 0.0;
  int count = 0;
  for (std::size_t i = 1; i < residuals.size(); ++i) {
    if (residuals[i].t_s - residuals[i - 1].t_s > 0.5) continue;
    covariance += (residuals[i].r - mean).dot(residuals[i - 1].r - mean);
    variance += (residuals[i].r - mean).squaredNorm();
    ++count;
  }
  if (count < 40 || !(covariance > 0.25 * variance)) return 0.0;
  return std::sqrt(covariance / count);
}

struct Slip {
  double change_m = 0.0, t_s = 0.0, significance = 0.0;
};

/// The instant before and after which the means differ most.
Slip slip_of(const std::vector<Residual>& residuals) {
  Slip worst;
  const std::size_t n = residuals.size();
  const double sd = std::max(jitter_of(residuals), 1e-6);
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  const Eigen::Vector3d all = mean_of(residuals, 0, n) * static_cast<double>(n);
  for (std::size_t k = 1; k < n; ++k) {
    before += residuals[k - 1].r;
    if (k < n / 8 || k > n - n / 8) continue;
    const double a = static_cast<double>(k), b = static_cast<double>(n - k);
    const Eigen::Vector3d change = (all - before) / b - before / a;
    const double z = change.norm() / (sd * std::sqrt(kBlock * (1.0 / a + 1.0 / b)));
    if (z > worst.significance) worst = {change.norm(), residuals[k].t_s, z};
  }
  return worst;
}

}  // namespace

void check_places(Context& context) {
  const Arm& arm = context.arm;
  if (arm.bodies.size() < 3 || context.recording.frames.size() < 40) return;
  for (const CheckFinding& f : context.findings) {
    // Residuals mean nothing where the geometry is not right yet.
    if (f.severity == Severity::kSerious && (f.id == "length_unit" || f.id == "body_order" ||
                                             f.id == "base_upside_down" || f.id == "base_attitude"))
      return;
  }
  const Fit residuals = fit(context, arm, kMostFrames, true);
  std::size_t worst = 0, loosest = 0;
  double worst_m = 0.0, worst_se = 0.0, lasting_m = 0.0;
  bool slips = false;
  for (std::size_t b = 0; b < arm.bodies.size(); ++b) {
    const auto& series = residuals.bodies[b];
    if (series.size() < 40) continue;
    const double se = spread_of(series) / std::sqrt(static_cast<double>(series.size()) / kBlock);
    const Eigen::Vector3d off = mean_of(series, 0, series.size());
    if (off.norm() > worst_m) {
      worst_m = off.norm();
      worst_se = se;
      worst = b;
    }
    if (const double lasting = lasting_of(series); lasting > lasting_m) {
      lasting_m = lasting;
      loosest = b;
    }
    const Slip slip = slip_of(series);
    if (slip.change_m > kSlipM && slip.significance > 5.0) {
      slips = true;
      CheckFinding& finding = context.add(
          Severity::kWarning, "ring_slips", arm.bodies[b].name,
          fmt::format("against the other bodies it moves by {:.1f} mm during the trial, about t = {:.1f} s",
                      1e3 * slip.change_m, slip.t_s));
      finding.figure = slip.change_m;
      finding.unit = "m";
      finding.spans = {{slip.t_s, slip.t_s}};
      finding.remedy =
          "fix the ring to the skin; leave out what comes before or after, with the arclength that "
          "holds there. An arm whose bending is not the model's moves the residuals as well";
      finding.setting = "bodies[" + arm.bodies[b].name + "].arclength_m";
    }
  }
  if (!slips && lasting_m > kLastingM && lasting_m > 0.3 * context.tracks[loosest + 1].white_sd_m) {
    CheckFinding& finding = context.add(
        Severity::kWarning, "ring_wanders", arm.bodies[loosest].name,
        fmt::format(
            "against the other bodies it is off by {:.2g} mm (rms), now here, now there, for longer than a "
            "tenth of a second",
            1e3 * lasting_m));
    finding.figure = lasting_m;
    finding.unit = "m";
    finding.remedy =
        "a loose ring, noise that is correlated in time (it does not average out: state the sum), or an "
        "arm that bends otherwise than its model";
    finding.setting = fmt::format("noise.position_sd_m: {:.2g}",
                                  std::hypot(lasting_m, context.tracks[loosest + 1].white_sd_m));
  }
  for (std::size_t b = 0; b < arm.bodies.size(); ++b) {
    const auto& series = residuals.tangents[b];
    if (series.size() < 40) continue;
    const double lasting = lasting_of(series);
    const double off = std::hypot(lasting, mean_of(series, 0, series.size()).head<2>().norm());
    if (off < kTiltRad || off > 1.0) continue;  // beyond it is turned over: check_attitude
    CheckFinding& finding =
        context.add(arm.bodies[b].orientation_usable ? Severity::kWarning : Severity::kInformation,
                    "tangent_off", arm.bodies[b].name,
                    fmt::format("its z axis is {:.1f} deg off the backbone's tangent that the positions say "
                                "({:.1f} deg of it come "
                                "and go)",
                                off * 180.0 / M_PI, lasting * 180.0 / M_PI));
    finding.figure = off;
    finding.unit = "rad";
    finding.remedy =
        "a loose ring, or a frame that was not aligned with the arm: align it at rest, or do without its "
        "orientation";
    finding.setting = fmt::format("bodies[{}].orientation_usable: false", arm.bodies[b].name);
  }
  if (worst_m > kOffM + 4.0 * worst_se) {
    CheckFinding& finding = context.add(
        Severity::kWarning, "ring_beside", arm.bodies[worst].name,
        fmt::format("on average {:.1f} mm beside any shape of the arm that fits the others", 1e3 * worst_m));
    finding.figure = worst_m;
    finding.figure_sd = worst_se;
    finding.unit = "m";
    finding.remedy =
        "its centre is not on the backbone (correct it in the mocap software), it sits at another "
        "arclength, or a section of the arm is not as the file says";
    finding.setting = fmt::format("bodies[{0}].section_in_body.position_m, bodies[{0}].arclength_m",
                                  arm.bodies[worst].name);
  }
}

void check_gravity(Context& context) {
  const Arm& arm = context.arm;
  if (arm.gravity_m_s2.norm() < 1.0 || context.recording.frames.size() < 20) return;
  if (arm.bodies.size() < 3) return;  // too few to tell the shape of a sag
  double noise_m = 0.0;
  for (const Track& track : context.tracks) noise_m = std::max(noise_m, track.white_sd_m);
  const Fit as_is = fit(context, arm, kGravityFrames, false);
  if (as_is.rms_m.size() < 10) return;
  const double now_m = median(as_is.rms_m);
  if (now_m < 3.0 * noise_m + 0.0005) return;
  double least_m = now_m;
  Eigen::Vector3d best = arm.gravity_m_s2;
  for (int k = 0; k < 6; ++k) {
    Arm turned = arm;
    turned.gravity_m_s2 = (k % 2 ? 1.0 : -1.0) * arm.gravity_m_s2.norm() * Eigen::Vector3d::Unit(k / 2);
    if ((turned.gravity_m_s2 - arm.gravity_m_s2).norm() < 0.1) continue;
    const Fit other = fit(context, turned, kGravityFrames, false);
    if (other.rms_m.size() < as_is.rms_m.size() / 2) continue;
    const double rms_m = median(other.rms_m);
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
