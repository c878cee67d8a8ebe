#include "law_errors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "math/distributions.h"
#include "math/linear_algebra.h"
#include "math/statistics.h"

namespace softarm::identify {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kIterations = 40;
constexpr std::size_t kFewestForShare = 8;  // trials from which an error is split into absolute and relative
// What a law is never trusted beyond.
constexpr double kLeastMoment_rel = 0.01;  // of the typical moment
constexpr double kLeastStiffness_rel = 0.02;
constexpr double kLeastLength_rel = 0.0025;  // of the segment
constexpr double kLeastJitter = 0.1;         // of the lasting error
// Where the expectation maximisation starts, and stays where the trials say nothing.
constexpr double kStartMoment_rel = 0.1;
constexpr double kStartStiffness_rel = 0.2;
constexpr double kStartLength_rel = 0.02;
constexpr double kVisibleBend_rad = 0.1;
// Beyond this a law says nothing: what the trials do not determine at all must stay a number.
constexpr double kMostMoment_rel = 5.0, kMostMoment_nm = 100.0;  // the latter: of the arm file's keys
constexpr double kMostStiffness_rel = 1.0;
constexpr double kMostLength_rel = 0.5;

/// One frame's information about the deviations q of the laws: F = J^T W J, y = J^T W r.
struct FrameInformation {
  MatrixXd f;
  VectorXd y;
  VectorXd moment_nm;  ///< per segment
};

FrameInformation inform(const arm::Arm& arm, LawModel& model, const trial::StaticFrame& frame,
                        const Prediction& predicted, double trust) {
  FrameInformation info;
  const int laws = static_cast<int>(predicted.laws.size());
  info.f = MatrixXd::Zero(laws, laws);
  info.y = VectorXd::Zero(laws);
  MatrixXd dp, dtangent;
  model.derivative_by_laws(frame, dp, dtangent);
  const auto add = [&](const Eigen::Vector3d& measured_less_predicted, const MatrixXd& j, double sd) {
    const double distance = measured_less_predicted.norm() / sd;
    const double weight = (distance > trust ? trust / distance : 1.0) / (sd * sd);
    info.f.noalias() += weight * j.transpose() * j;
    info.y.noalias() += weight * j.transpose() * measured_less_predicted;
  };
  for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
    const trial::SeenBody& seen = frame.bodies[k];
    if (!seen.used) continue;
    const int column = static_cast<int>(k);
    const arm::MeasuredBody& body = arm.bodies[static_cast<std::size_t>(seen.body)];
    add(seen.p_base - predicted.p.col(column), dp.middleRows(3 * column, 3), body.position_sd_m);
    if (seen.tangent_base)
      add(*seen.tangent_base - predicted.tangent.col(column), dtangent.middleRows(3 * column, 3),
          body.orientation_sd_rad);
  }
  info.moment_nm.resize(laws / kLaws);
  for (int i = 0; i < laws / kLaws; ++i) info.moment_nm[i] = predicted.laws.segment<2>(kLaws * i).norm();
  return info;
}

/// Mean squares of deviations that last over a trial and of such that do not.
struct Components {
  VectorXd lasting, passing;               ///< variances
  std::vector<VectorXd> lasting_by_trial;  ///< posterior second moments
};

Components split(const std::map<std::size_t, std::vector<FrameInformation>>& trials, const VectorXd& start) {
  Components c{start, start, {}};
  const auto laws = start.size();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    VectorXd lasting = VectorXd::Zero(laws), passing = VectorXd::Zero(laws);
    double frames = 0.0;
    c.lasting_by_trial.clear();
    const MatrixXd passing_information = c.passing.cwiseInverse().asDiagonal();
    for (const auto& [trial, infos] : trials) {
      MatrixXd information = c.lasting.cwiseInverse().asDiagonal();
      VectorXd pull = VectorXd::Zero(laws);
      std::vector<MatrixXd> spread;  // posterior covariance of what passes, given what lasts
      for (const FrameInformation& info : infos) {
        spread.push_back(math::inverse_of_symmetric(info.f + passing_information));
        information += info.f - info.f * spread.back() * info.f;
        pull += info.y - info.f * spread.back() * info.y;
      }
      const MatrixXd covariance = math::inverse_of_symmetric(information);
      const VectorXd mean = covariance * pull;
      c.lasting_by_trial.emplace_back(mean.cwiseAbs2() + covariance.diagonal());
      lasting += c.lasting_by_trial.back();
      for (std::size_t i = 0; i < infos.size(); ++i) {
        const VectorXd passed = spread[i] * (infos[i].y - infos[i].f * mean);
        const MatrixXd lever = spread[i] * infos[i].f;
        passing +=
            passed.cwiseAbs2() + spread[i].diagonal() + (lever * covariance * lever.transpose()).diagonal();
        frames += 1.0;
      }
    }
    c.lasting = (lasting / static_cast<double>(trials.size())).cwiseMax(1e-6 * start);
    c.passing = (passing / frames).cwiseMax(1e-6 * start);
  }
  return c;
}

/// Variances for errors of a trial that is yet to come. From a few trials a variance is itself a guess: that
/// of Student's distribution counts, with a degree of freedom less than there are trials (the constants were
/// fitted to them), as far as it is less than what is thought without any trial.
VectorXd of_a_new_trial(const VectorXd& found, std::size_t trials, const VectorXd& without_trials) {
  if (trials < 2) return found.cwiseMax(without_trials);
  constexpr double kLevel = 0.975;  // where intervals of two standard deviations end
  const double wider =
      math::students_t_quantile(static_cast<double>(trials - 1), kLevel) / math::normal_quantile(kLevel);
  return (wider * wider * found).cwiseMin(found.cwiseMax(without_trials));
}

/// Squares of the moment's error as a sum of a constant and of a share of the moment squared, both >= 0.
void split_moment(const std::vector<double>& error2, const std::vector<double>& moment2, double& absolute2,
                  double& relative2) {
  const auto n = static_cast<double>(error2.size());
  double mean_e = 0.0, mean_m = 0.0, covariance = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < error2.size(); ++i) {
    mean_e += error2[i] / n;
    mean_m += moment2[i] / n;
  }
  for (std::size_t i = 0; i < error2.size(); ++i) {
    covariance += (error2[i] - mean_e) * (moment2[i] - mean_m) / n;
    variance += (moment2[i] - mean_m) * (moment2[i] - mean_m) / n;
  }
  relative2 = error2.size() >= kFewestForShare && variance > 0.0 ? std::max(0.0, covariance / variance) : 0.0;
  if (mean_m > 0.0) relative2 = std::min(relative2, mean_e / mean_m);
  absolute2 = std::max(0.0, mean_e - relative2 * mean_m);
}

/// What frames say of the laws, and what the constants' own uncertainty makes of them there.
struct Gathered {
  std::map<std::size_t, std::vector<FrameInformation>> trials;
  std::vector<double> moments, bending_nm;                          ///< the latter per radian
  std::vector<double> own_moment2, own_ln_stiffness2, own_length2;  ///< variances by the constants
};

Gathered gather(const arm::Arm& arm, LawModel& model, const std::vector<trial::StaticFrame>& frames,
                const MatrixXd& of_constants, const MatrixXd& given_moduli) {
  Gathered out;
  for (const trial::StaticFrame& frame : frames) {
    std::optional<model::Equilibrium> equilibrium;
    Prediction predicted;
    if (!model.predict(frame, equilibrium, predicted)) continue;
    // A frame's largest residuals are of the laws as a rule; what no law explains must not rule.
    std::vector<double> distances;
    for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
      const trial::SeenBody& seen = frame.bodies[k];
      const double sd = arm.bodies[static_cast<std::size_t>(seen.body)].position_sd_m;
      distances.push_back((seen.p_base - predicted.p.col(static_cast<int>(k))).norm() / sd);
    }
    out.trials[frame.trial].push_back(
        inform(arm, model, frame, predicted, kHuber * std::max(1.0, math::median(distances))));
    const auto variances = [&](const MatrixXd& covariance) -> VectorXd {
      return (predicted.dlaws * covariance * predicted.dlaws.transpose()).diagonal().cwiseMax(0.0);
    };
    const VectorXd all = variances(of_constants), given = variances(given_moduli);
    for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
      out.moments.push_back(predicted.laws.segment<2>(kLaws * i).norm());
      out.bending_nm.push_back(std::exp(predicted.laws[kLaws * i + 2]) / predicted.laws[kLaws * i + 3]);
      out.own_moment2.push_back(given.segment<2>(kLaws * i).mean());
      out.own_ln_stiffness2.push_back(all[kLaws * i + 2]);
      out.own_length2.push_back(given[kLaws * i + 3]);
    }
  }
  return out;
}

/// Of the moment: the part of the lasting error's variance that is the same everywhere, and that relative to
/// the moment.
void moment_errors(const Gathered& gathered, const Components& components, int segments, double& absolute2,
                   double& relative2) {
  std::vector<double> error2, moment2;
  std::size_t t = 0;
  for (const auto& [trial, infos] : gathered.trials) {
    for (int i = 0; i < segments; ++i) {
      double mean = 0.0;
      for (const FrameInformation& info : infos)
        mean += info.moment_nm[i] * info.moment_nm[i] / static_cast<double>(infos.size());
      error2.push_back(components.lasting_by_trial[t].segment<2>(kLaws * i).mean());
      moment2.push_back(mean);
    }
    ++t;
  }
  split_moment(error2, moment2, absolute2, relative2);
}

}  // namespace

arm::LawPrior law_errors(const arm::Arm& arm, LawModel& model, const std::vector<trial::StaticFrame>& frames,
                         const MatrixXd& of_constants, const MatrixXd& given_moduli) {
  const Gathered gathered = gather(arm, model, frames, of_constants, given_moduli);
  const int segments = static_cast<int>(arm.segments.size());
  arm::LawPrior prior;
  if (gathered.trials.empty()) return prior;
  double square = 0.0;
  for (const double m : gathered.moments) square += m * m / static_cast<double>(gathered.moments.size());
  // Of frames that are hardly driven: what would bend the arm visibly.
  const double typical_nm = std::max(kVisibleBend_rad * math::median(gathered.bending_nm), std::sqrt(square));
  const double length_m = arm.total_length_m() / segments;
  VectorXd start(kLaws * segments);
  for (int i = 0; i < segments; ++i) {
    const double moment = kStartMoment_rel * typical_nm, length = kStartLength_rel * length_m;
    start.segment<kLaws>(kLaws * i) << moment * moment, moment * moment,
        kStartStiffness_rel * kStartStiffness_rel, length * length;
  }
  Components components = split(gathered.trials, start);
  components.lasting = of_a_new_trial(components.lasting, gathered.trials.size(), start);
  for (VectorXd& of_trial : components.lasting_by_trial)
    of_trial = of_a_new_trial(of_trial, gathered.trials.size(), start);

  double stiffness2 = 0.0, length2 = 0.0, moment_jitter2 = 0.0, length_jitter2 = 0.0;
  for (int i = 0; i < segments; ++i) {  // the prior has one value for all segments: the worst
    stiffness2 = std::max(stiffness2, components.lasting[kLaws * i + 2]);
    length2 = std::max(length2, components.lasting[kLaws * i + 3]);
    moment_jitter2 = std::max(moment_jitter2, components.passing.segment<2>(kLaws * i).mean());
    length_jitter2 = std::max(length_jitter2, components.passing[kLaws * i + 3]);
  }
  double absolute2 = 0.0, relative2 = 0.0;
  moment_errors(gathered, components, segments, absolute2, relative2);
  // Constants that are not identifiable from the trials: off by all of the moment is what there is to be
  // said.
  const double own_moment2 = std::min(math::median(gathered.own_moment2), typical_nm * typical_nm);
  const double least_moment = kLeastMoment_rel * typical_nm;
  prior.enabled = true;
  prior.moment_sd_nm = std::min(kMostMoment_rel * typical_nm,
                                std::sqrt(absolute2 + own_moment2 + least_moment * least_moment));
  prior.moment_sd_rel = std::sqrt(relative2);
  prior.bending_stiffness_sd_rel =
      std::min(kMostStiffness_rel, std::sqrt(stiffness2 + math::median(gathered.own_ln_stiffness2) +
                                             kLeastStiffness_rel * kLeastStiffness_rel));
  const double least_length = kLeastLength_rel * length_m;
  prior.length_sd_m =
      std::min(kMostLength_rel * length_m,
               std::sqrt(length2 + math::median(gathered.own_length2) + least_length * least_length));
  // What is off by more than the arm does at all is off by all of it, from frame to frame as well.
  prior.moment_jitter_sd_nm =
      std::clamp(std::sqrt(moment_jitter2), kLeastJitter * prior.moment_sd_nm, kMostMoment_rel * typical_nm);
  prior.length_jitter_sd_m =
      std::clamp(std::sqrt(length_jitter2), kLeastJitter * prior.length_sd_m, kMostLength_rel * length_m);
  for (double* moment_nm : {&prior.moment_sd_nm, &prior.moment_jitter_sd_nm})
    *moment_nm = std::min(*moment_nm, kMostMoment_nm);
  return prior;
}

}  // namespace softarm::identify
