#include "instant_fits.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "math/parallel.h"
#include "policy.h"
#include "softarm/arm/laws.h"
#include "softarm/estimate/estimator.h"

namespace softarm::diagnose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using model::Block;
using model::Predicted;
using model::TrialData;

constexpr int kUnknowns = 4;  // EI, M0, phi, L of a segment

arm::EstimatorOptions options_of(const arm::Arm& arm) {
  arm::EstimatorOptions options = arm.estimator;
  options.method = arm::Method::kFullPoints;
  options.unknown = arm::Unknown::kStiffness;
  options.objective = arm::Objective::kLeastSquares;
  options.weights.reset();
  options.prior.enabled = false;
  options.window_s = 0.0;
  return options;
}

trial::Frame frame_of(const arm::Arm& arm, const Block& block, const Predicted& moving,
                      const Predicted& still) {
  trial::Frame frame;
  frame.stamp_ns = trial::to_nanoseconds(moving.instant.t_s);
  frame.payload_kg = moving.instant.payload_kg;
  frame.inputs = arm::InputValues(moving.instant.inputs.data(),
                                  moving.instant.inputs.data() + moving.instant.inputs.size());
  Eigen::Isometry3d mocap_rod = arm.base.fixed_pose;
  if (arm.base.body) {
    mocap_rod = Eigen::Isometry3d(block.q_base_mocap.conjugate());
    frame.base_body = mocap_rod * arm.base.rod_in_body.inverse();
  }
  for (std::size_t i = 0; i < block.bodies.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    trial::BodyObservation body;
    body.body = block.bodies[i].body;
    body.p_mocap = mocap_rod * (block.bodies[i].p_base - (moving.p.col(column) - still.p.col(column)));
    frame.bodies.push_back(body);
  }
  return frame;
}

double turned(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * M_PI);
}

SegmentFit beside_law(const estimate::SegmentEstimate& estimate, const arm::SegmentPrediction& law) {
  SegmentFit out;
  const Vector2d moment = law.actuation_nm();
  if (estimate.bending_stiffness_nm2 && estimate.sd_bending_stiffness_nm2 &&
      *estimate.sd_bending_stiffness_nm2 < kPolicy.instants.identifiable * *estimate.bending_stiffness_nm2)
    out.stiffness_nm2 = Estimated{*estimate.bending_stiffness_nm2, law.bending_stiffness_nm2,
                                  *estimate.sd_bending_stiffness_nm2};
  if (estimate.moment_nm && estimate.sd_moment_nm &&
      *estimate.sd_moment_nm < kPolicy.instants.identifiable * *estimate.moment_nm && moment.norm() > 0.0)
    out.moment_nm = Estimated{*estimate.moment_nm, moment.norm(), *estimate.sd_moment_nm};
  if (estimate.direction_rad && estimate.sd_direction_rad &&
      *estimate.sd_direction_rad < kPolicy.instants.identifiable_rad && moment.norm() > 0.0) {
    const double commanded = std::atan2(moment.y(), moment.x());
    out.direction_rad = Estimated{commanded + turned(*estimate.direction_rad - commanded), commanded,
                                  *estimate.sd_direction_rad};
  }
  if (estimate.length_m && estimate.sd_length_m)
    out.length_m = Estimated{*estimate.length_m, law.length_m, *estimate.sd_length_m};
  return out;
}

std::vector<InstantFit> fit_trial(const JointModel& model, const Linearised& at, const arm::Arm& arm,
                                  std::size_t t) {
  const TrialData& trial = model.trials()[t];
  // The arm file's own lengths are where bodies and loads sit; those of the fit are in the laws.
  model::ExtendedModel statics(model.arm());
  std::vector<Predicted> still;
  statics.predict(arm, model.all(at.at.effects), model::Dynamics{false, 0.0}, trial, &at.predicted[t], still);
  estimate::Estimator estimator(model.arm(), options_of(model.arm()), model.known());
  estimator.set_backbone_points(0);
  std::vector<InstantFit> list;
  for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
    const Block& block = trial.blocks[k];
    const Predicted& moving = at.predicted[t][k];
    if (!model.uses(t, k) || !moving.solved || !still[k].solved) continue;
    const estimate::Estimate& estimate = estimator.estimate(frame_of(arm, block, moving, still[k]));
    if (estimate.status != estimate::Status::kOk) continue;
    const auto laws =
        predict(arm, arm::InputValues(moving.instant.inputs.data(),
                                      moving.instant.inputs.data() + moving.instant.inputs.size()));
    if (!laws) continue;
    InstantFit fit;
    fit.trial = t;
    fit.block = k;
    for (const estimate::BodyResidual& body : estimate.residuals) {
      if (!body.used) continue;
      const auto seen = std::find_if(block.bodies.begin(), block.bodies.end(),
                                     [&](const model::Seen& s) { return s.body == body.body; });
      if (seen == block.bodies.end()) continue;
      const double variance = std::pow(model.sd_m(t, k, *seen), 2);
      fit.square += (body.measured_base - body.estimated_base).squaredNorm() / variance;
      fit.weight += 1.0 / variance;
      fit.rows += 3;
    }
    if (fit.rows <= unknowns_of_instant(arm)) continue;
    for (std::size_t i = 0; i < estimate.segments.size(); ++i)
      fit.segments.push_back(beside_law(estimate.segments[i], (*laws)[i]));
    list.push_back(std::move(fit));
  }
  return list;
}

}  // namespace

int unknowns_of_instant(const arm::Arm& arm) {
  return kUnknowns * static_cast<int>(arm.segments.size());
}

std::vector<InstantFit> fit_instants(const JointModel& model, const Linearised& at, unsigned jobs) {
  const arm::Arm arm = model.arm_with(at.at.constants);
  std::vector<std::vector<InstantFit>> by_trial(model.trials().size());
  math::in_parallel(by_trial.size(), jobs,
                    [&](std::size_t t) { by_trial[t] = fit_trial(model, at, arm, t); });
  std::vector<InstantFit> all;
  for (std::vector<InstantFit>& list : by_trial)
    all.insert(all.end(), std::make_move_iterator(list.begin()), std::make_move_iterator(list.end()));
  return all;
}

}  // namespace softarm::diagnose
