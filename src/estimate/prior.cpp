#include "prior.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "arm/constant_spec.h"
#include "math/linear_algebra.h"
#include "problem.h"
#include "softarm/arm/constants.h"

namespace softarm::estimate {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Share of the largest (scaled) information below which a direction is free.
constexpr double kFree = 1e-13;
constexpr double kLeastGain = 1e-4;  // error that a gain has at least: none would not be a number

// Of the variance of a gain, what all gains of a segment share. With each one's own whole variance beside it,
// intervals are right where all err alike, where each errs by itself, and between a fifth and a quarter too
// wide where one actuator works alone.
constexpr double kSharedByGains = 0.5;

/// The constants that say what moment or curvature an actuator makes of its input.
std::vector<arm::ConstantRef> gains_of(const arm::Arm& arm) {
  std::vector<arm::ConstantRef> list;
  for (const arm::ConstantRef& ref : arm::constants_of(arm)) {
    if (arm::spec_of(ref.kind).role == arm::ConstantRole::kMoment) list.push_back(ref);
  }
  return list;
}

/// The actuation of one actuator alone, N m: by its gain, times that.
Eigen::Vector2d actuation_by(const arm::Arm& arm, const arm::ConstantRef& gain,
                             const arm::InputValues& values) {
  const arm::InputReader inputs(arm, values);
  const arm::Segment& segment = arm.segments[static_cast<std::size_t>(gain.segment)];
  const auto response = arm::respond(segment, inputs);
  arm::Change change;
  if (!response || !arm::spec_of(gain.kind).change(segment, gain.index, inputs, change))
    return Eigen::Vector2d::Zero();
  const arm::SegmentDerivative by = arm::differentiate(segment, *response, change);
  return arm::value_of(arm, gain) * by.actuation_nm(response->prediction);
}

}  // namespace

MatrixXd Belief::rows() const {
  const auto n = information.rows();
  VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i)
    scale[i] = information(i, i) > 0.0 ? std::sqrt(information(i, i)) : 1.0;
  const VectorXd inverse = scale.cwiseInverse();
  const math::Eigensystem eigen =
      math::eigensystem_of(inverse.asDiagonal() * information * inverse.asDiagonal());
  const VectorXd root =
      eigen.values.unaryExpr([](double value) { return value > kFree ? std::sqrt(value) : 0.0; });
  return root.asDiagonal() * eigen.vectors.transpose() * scale.asDiagonal();
}

FrameLaw frame_law(const arm::Arm& arm, const arm::LawPrior& prior,
                   const std::vector<arm::SegmentPrediction>& predictions,
                   const std::vector<double>& reference_stiffness, bool gains_apart,
                   const arm::InputValues& inputs) {
  const int count = static_cast<int>(arm.segments.size()) * kSegmentParameters + 1;
  FrameLaw law;
  law.centre = x_by_laws(arm, predictions, reference_stiffness);
  law.shared = MatrixXd::Identity(count, count);
  law.jitter_variance = VectorXd::Zero(count);
  law.information = VectorXd::Zero(count);
  law.memory_variance = VectorXd::Zero(count);
  const std::vector<arm::ConstantRef> actuators =
      gains_apart ? gains_of(arm) : std::vector<arm::ConstantRef>();
  const auto shared_gains = 2 * static_cast<Eigen::Index>(arm.segments.size());
  law.gains = MatrixXd::Zero(count, shared_gains + static_cast<Eigen::Index>(actuators.size()));
  const double gain_sd = prior.enabled ? std::max(prior.moment_sd_rel, kLeastGain) : kLeastGain;
  law.gain_variance = VectorXd::Constant(law.gains.cols(), gains_apart ? gain_sd * gain_sd : 0.0);
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    const auto index = static_cast<std::size_t>(i);
    const arm::SegmentPrediction& now = predictions[index];
    const double rest = arm.segments[index].length_m;
    const double reference = reference_stiffness[index];
    const double flexibility = reference / now.bending_stiffness_nm2;
    const double curvature_per_moment = rest * flexibility / reference;
    const int ic = Problem::column(i, 2), il = Problem::column(i, 3);
    // At another flexibility the law's moment makes another curvature; a cable's curvature stays.
    for (int k = 0; k < 2; ++k) {
      const int j = Problem::column(i, k);
      law.shared(j, j) = curvature_per_moment;
      law.shared(j, ic) = curvature_per_moment * now.moment_nm[k];
      const double jitter = curvature_per_moment * prior.moment_jitter_sd_nm;
      law.jitter_variance[j] = prior.enabled ? jitter * jitter : -1.0;
      if (prior.enabled) {
        const double share = gains_apart ? 0.0 : prior.moment_sd_rel * now.actuation_nm().norm();
        law.information[j] = 1.0 / (prior.moment_sd_nm * prior.moment_sd_nm + share * share);
        law.passing.push_back(j);
      }
    }
    const Eigen::Vector2d along = curvature_per_moment * now.actuation_nm();
    law.gains.block<2, 1>(Problem::column(i, 0), 2 * i) = std::sqrt(kSharedByGains) * along;
    law.gains.block<2, 1>(Problem::column(i, 0), 2 * i + 1) = Eigen::Vector2d(-along.y(), along.x());
    law.shared(ic, ic) = flexibility;
    law.shared(il, il) = 1.0 / rest;
    const double jitter = prior.length_jitter_sd_m / rest;
    law.jitter_variance[il] = prior.enabled ? jitter * jitter : -1.0;
    if (prior.enabled) {
      law.information[ic] = 1.0 / (prior.bending_stiffness_sd_rel * prior.bending_stiffness_sd_rel);
      law.information[il] = 1.0 / (prior.length_sd_m * prior.length_sd_m);
      law.passing.push_back(il);
    }
  }
  for (std::size_t a = 0; a < actuators.size() && !inputs.empty(); ++a) {
    const int i = actuators[a].segment;
    const auto index = static_cast<std::size_t>(i);
    law.gains.block<2, 1>(Problem::column(i, 0), shared_gains + static_cast<Eigen::Index>(a)) =
        arm.segments[index].length_m / predictions[index].bending_stiffness_nm2 *
        actuation_by(arm, actuators[a], inputs);
  }
  return law;
}

VectorXd x_by_laws(const arm::Arm& arm, const std::vector<arm::SegmentPrediction>& predictions,
                   const std::vector<double>& reference_stiffness) {
  VectorXd x = VectorXd::Zero(static_cast<Eigen::Index>(predictions.size()) * kSegmentParameters + 1);
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    const arm::SegmentPrediction& now = predictions[i];
    const double rest = arm.segments[i].length_m;
    const Eigen::Index first = Problem::column(static_cast<int>(i), 0);
    x.segment<2>(first) = rest * (now.moment_nm / now.bending_stiffness_nm2 + now.curvature_per_m);
    x[first + 2] = reference_stiffness[i] / now.bending_stiffness_nm2;
    x[first + 3] = now.length_m / rest;
  }
  return x;
}

void allow_for_effects(const MatrixXd& by_errors, FrameLaw& law) {
  const Eigen::Index before = law.gains.cols(), more = by_errors.cols();
  law.gains.conservativeResize(Eigen::NoChange, before + more);
  law.gains.rightCols(more) = by_errors;
  law.gain_variance.conservativeResize(before + more);
  law.gain_variance.tail(more).setOnes();
  law.of_effects = more;
}

void allow_for_memory(const arm::LawPrior& prior, const arm::LawMemory& memory,
                      const std::vector<Eigen::Vector2d>& effects,
                      const std::vector<arm::SegmentPrediction>& predictions, FrameLaw& law) {
  if (!prior.enabled || (memory.empty() && effects.empty())) return;
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    Eigen::Vector3d variance = memory.variance(i);
    if (!effects.empty()) variance.head<2>() += effects[i];
    const double stiffness = predictions[i].bending_stiffness_nm2;
    const auto add = [&](int k, double more) {
      const int j = Problem::column(static_cast<int>(i), k);
      law.memory_variance[j] = more;
      law.information[j] = 1.0 / (1.0 / law.information[j] + more);
    };
    for (int k = 0; k < 2; ++k) add(k, variance[k] * stiffness * stiffness);
    add(3, variance.z());
  }
}

void allow_for_axial_stiffness(const arm::LawPrior& prior, const std::vector<double>& stretch_m,
                               FrameLaw& law) {
  if (!prior.enabled) return;
  for (std::size_t i = 0; i < stretch_m.size(); ++i) {
    const double by_stiffness = prior.axial_stiffness_sd_rel * stretch_m[i];
    const int j = Problem::column(static_cast<int>(i), 3);
    law.information[j] =
        1.0 / (prior.length_sd_m * prior.length_sd_m + by_stiffness * by_stiffness + law.memory_variance[j]);
  }
}

void integrate_out(const VectorXd& variance, Evidence& of) {
  // One parameter at a time: eliminating an error e with its own information 1/q is the rank-one update
  // h - h_e h_e^T / (h_ee + 1/q).
  MatrixXd& h = of.information;
  for (Eigen::Index e = 0; e < h.rows(); ++e) {
    if (variance[e] == 0.0 || !(h(e, e) > 0.0)) continue;
    const double pivot = h(e, e) + (variance[e] > 0.0 ? 1.0 / variance[e] : 0.0);
    const VectorXd column = h.col(e) / pivot;
    const double own = of.weighted[e];
    h.noalias() -= pivot * column * column.transpose();
    of.weighted -= column * own;
    if (variance[e] < 0.0) {  // exactly nothing is left of it
      h.col(e).setZero();
      h.row(e).setZero();
      of.weighted[e] = 0.0;
    }
  }
}

Evidence evidence_on_shared(const FrameLaw& law, const MatrixXd& h, const VectorXd& hx, double repeats) {
  Evidence x{h, hx - h * law.centre};
  integrate_out(repeats * law.jitter_variance, x);
  return {law.shared.transpose() * x.information * law.shared, law.shared.transpose() * x.weighted};
}

Belief belief_of_frame(const FrameLaw& law, const MatrixXd& z_information, const VectorXd& z_weighted) {
  // In x: y = shared^-1 (x - centre) is z without the jitter.
  const MatrixXd inverse = law.shared.inverse();
  Evidence x{inverse.transpose() * z_information * inverse, inverse.transpose() * z_weighted};
  integrate_out(law.jitter_variance, x);
  const MatrixXd by_effects = law.by_effects();
  if (by_effects.isZero(0.0)) return belief_about_centre(law, x);
  // Errors of variance 1 that add to x: Woodbury's identity.
  const MatrixXd informed = x.information * by_effects;
  MatrixXd of_errors = by_effects.transpose() * informed;
  of_errors.diagonal().array() += 1.0;
  const MatrixXd gain = math::SymmetricSolver(of_errors).solve_columns(informed.transpose()).transpose();
  x.weighted -= gain * (by_effects.transpose() * x.weighted);
  x.information -= gain * informed.transpose();
  Belief belief = belief_about_centre(law, x);
  belief.by_effects = by_effects;
  return belief;
}

Belief belief_about_centre(const FrameLaw& law, const Evidence& x) {
  Belief belief;
  belief.information = x.information;
  // The mean in the directions that are determined; the centre in the others.
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> solve;
  VectorXd scale(x.information.rows());
  for (Eigen::Index i = 0; i < scale.size(); ++i)
    scale[i] = x.information(i, i) > 0.0 ? 1.0 / std::sqrt(x.information(i, i)) : 1.0;
  solve.setThreshold(kFree);
  solve.compute(scale.asDiagonal() * x.information * scale.asDiagonal());
  belief.mean = law.centre + scale.asDiagonal() * solve.solve(scale.asDiagonal() * x.weighted);
  return belief;
}

}  // namespace softarm::estimate
