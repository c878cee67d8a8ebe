#include "weigh_experiments.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "math/linear_algebra.h"
#include "math/parallel.h"
#include "policy.h"
#include "ranges.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::Predicted;
using model::Present;

/// A trial that nobody has recorded, with a model of its own: the arm has what the experiment adds to it.
class Hypothetical {
 public:
  /// @param recorded the model of the trials that there are: the arm moves as in that one
  Hypothetical(const Experiment& experiment, const JointModel& recorded, const Options& options)
      : experiment_(experiment),
        recorded_(recorded),
        trials_{experiment.trial},
        model_(experiment.arm, trials_, 1, options.held, options.tied, options.known) {}

  /// @return whether the arm bears it; settles what is left out because it swings
  bool prepare(const JointParameters& parameters) {
    model_.predict(with_loads(parameters), nullptr, predicted_);
    std::size_t used = 0, solved = 0;
    for (const Predicted& block : predicted_[0]) solved += block.solved;
    model_.allow_for_motion(with_loads(parameters), predicted_, &recorded_);
    for (std::size_t k = 0; k < trials_[0].blocks.size(); ++k) used += model_.uses(0, k);
    return is_enough(solved) && used > 0;
  }
  /// Whether it is borne that in so many blocks the arm has an equilibrium.
  bool is_enough(std::size_t solved) const {
    return static_cast<double>(solved) >=
           kPolicy.experiment.least_solved * static_cast<double>(trials_[0].blocks.size());
  }
  /// Nothing was seen, so residuals mean nothing; predictions and derivatives do.
  Linearised linearise(const JointParameters& parameters, bool whole) {
    return model_.linearise(with_loads(parameters), &predicted_,
                            whole && model_.needs_whole_derivatives(parameters)
                                ? JointModel::Derivatives::kWhole
                                : JointModel::Derivatives::kShapesHeld);
  }
  JointModel& model() { return model_; }
  JointParameters with_loads(JointParameters parameters) const {
    for (const auto& load : experiment_.loads) parameters.effects.push_back({load.get(), model::Values()});
    return parameters;
  }

 private:
  const Experiment& experiment_;
  const JointModel& recorded_;
  const std::vector<model::TrialData> trials_;
  JointModel model_;
  std::vector<std::vector<Predicted>> predicted_;
};

/// The clock of the bodies ahead of the inputs' at a time of the session, s per unit of an effect's size.
double clock_ahead_s(const model::Info& info, int size, double session_s) {
  if (info.of_clock_rates)
    return effects::drifted_s(size == 0 ? 1.0 : 0.0, size == 0 ? 0.0 : 1.0, session_s, 0.0);
  return info.of_clocks ? 1.0 : 0.0;
}

/// The same as a model has it, s.
double clock_ahead_s(const JointParameters& parameters, double session_s) {
  double sum_s = 0.0;
  for (const Present& present : parameters.effects) {
    const model::Info& info = present.effect->info();
    for (int size = 0; size < info.sizes; ++size) {
      const double by_size_s = clock_ahead_s(info, size, session_s);
      if (by_size_s != 0.0) sum_s += by_size_s * present.values[size];
    }
  }
  return sum_s;
}

/// One more measurement for a fit: of the clocks, at a time of the session.
void add_clock(const Linearised& truth, const Linearised& fitted, double session_s, double sd_s,
               DifferenceSums& sums) {
  VectorXd row = VectorXd::Zero(sums.gradient.size());
  Eigen::Index at = 0;
  for (const Linearised* one : {&truth, &fitted}) {
    for (const JointUnknown& c : one->columns) {
      if (c.kind == JointUnknown::Kind::kEffect) {
        const model::Info& info = one->at.effects[static_cast<std::size_t>(c.index)].effect->info();
        if (c.parameter < info.sizes)
          row[at] =
              (one == &truth ? 1.0 : -1.0) * clock_ahead_s(info, c.parameter, session_s) * c.scale / sd_s;
      }
      ++at;
    }
  }
  const double difference = (clock_ahead_s(truth.at, session_s) - clock_ahead_s(fitted.at, session_s)) / sd_s;
  sums.information += row * row.transpose();
  sums.gradient -= difference * row;
  sums.square += difference * difference;
}

/// A usual size of an effect, and the constants, in some trials.
struct SizeSignature {
  MatrixXd own, mixed;
};

SizeSignature signature_of(JointModel& model, const Linearised& at, const JointParameters& base,
                           const Present& hidden) {
  const int sizes = hidden.effect->info().sizes;
  constexpr double kShareOfUsual = 0.05;
  std::vector<JointParameters> changed;
  std::vector<double> steps;
  for (int k = 0; k < sizes; ++k) {
    Present one = hidden;
    one.values.head(sizes).setZero();
    const bool upwards = hidden.effect->info().parameters[static_cast<std::size_t>(k)].high > 0.0;
    steps.push_back(upwards ? kShareOfUsual : -kShareOfUsual);
    one.values[k] = steps.back() * hidden.values[k];
    changed.push_back(base);
    changed.back().effects.push_back(std::move(one));
  }
  const auto unknowns = static_cast<Eigen::Index>(at.columns.size());
  SizeSignature sum{MatrixXd::Zero(sizes, sizes), MatrixXd::Zero(unknowns, sizes)};
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    const MatrixXd d = at.root_weight[t].asDiagonal() * model.signatures(at, t, changed, steps);
    sum.own += d.transpose() * d;
    sum.mixed += at.derivative[t].transpose() * d;
  }
  return sum;
}

/// Standard deviations by which a usual size is seen.
double z_of(const SizeSignature& signature, const MatrixXd& information, double inflation) {
  const auto k = signature.own.rows();
  const MatrixXd left = signature.own - signature.mixed.transpose() *
                                            math::SymmetricSolver(information).solve_columns(signature.mixed);
  const VectorXd one = VectorXd::Ones(k) / std::sqrt(static_cast<double>(k));
  return std::sqrt(std::max(0.0, one.dot(left * one)) / inflation);
}

/// All pairs of models: `sums(truth, fitted)` of those that are not the same.
template <typename Pair>
MatrixXd separations(const std::vector<Explanation>& list, double inflation, const Pair& sums) {
  const auto n = static_cast<Eigen::Index>(list.size());
  MatrixXd all = MatrixXd::Zero(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index k = 0; k < n; ++k) {
      if (j == k) continue;
      const auto truth = static_cast<std::size_t>(j), fitted = static_cast<std::size_t>(k);
      all(j, k) = std::sqrt(least_square(sums(truth, fitted), list[truth].fit, list[fitted].fit) / inflation);
    }
  }
  return all;
}

}  // namespace

Separations weigh_apart(const JointModel& model, const JointParameters& baseline,
                        const std::vector<Explanation>& explanations, const std::vector<Experiment>& menu,
                        bool whole, double inflation, const Options& options) {
  const std::size_t n = explanations.size();
  std::vector<DifferenceSums> old(n * n);
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < n; ++k) {
      if (j != k) old[j * n + k] = sums_between(model, explanations[j].fit, explanations[k].fit);
    }
  }
  Separations out;
  out.today =
      separations(explanations, inflation, [&](std::size_t j, std::size_t k) { return old[j * n + k]; });
  out.with.resize(menu.size());
  math::in_parallel(menu.size(), options.jobs, [&](std::size_t i) {
    Hypothetical trial(menu[i], model, options);
    if (!trial.prepare(baseline)) return;
    std::vector<Linearised> there;
    for (const Explanation& one : explanations) {
      there.push_back(trial.linearise(one.fit.at, whole));
      if (!trial.is_enough(with_equilibrium(there.back()))) return;
    }
    out.with[i] = separations(explanations, inflation, [&](std::size_t j, std::size_t k) {
      DifferenceSums sums = sums_between(trial.model(), there[j], there[k]);
      sums += old[j * n + k];
      if (menu[i].clock_sd_s > 0.0)
        add_clock(explanations[j].fit, explanations[k].fit, menu[i].trial.series.session_s,
                  menu[i].clock_sd_s, sums);
      return sums;
    });
  });
  return out;
}

Visibility weigh_collinear(JointModel& model, Linearised& at, const std::vector<Present>& hidden,
                           const std::vector<Experiment>& menu, double inflation, const Options& options) {
  model.complete(at);
  Visibility out;
  const MatrixXd own = information_within_ranges(at);
  std::vector<SizeSignature> old;
  for (const Present& one : hidden) {
    old.push_back(signature_of(model, at, at.at, one));
    out.today.push_back(z_of(old.back(), own, inflation));
  }
  out.with.resize(menu.size());
  math::in_parallel(menu.size(), options.jobs, [&](std::size_t i) {
    Hypothetical trial(menu[i], model, options);
    if (!trial.prepare(at.at)) return;
    Linearised there = trial.linearise(at.at, true);
    if (!trial.is_enough(with_equilibrium(there))) return;
    trial.model().complete(there);
    MatrixXd information = own;
    for (const TimeStretch& stretch : there.stretches) information += stretch.information;
    out.with[i].emplace();
    for (std::size_t h = 0; h < hidden.size(); ++h) {
      SizeSignature both = signature_of(trial.model(), there, there.at, hidden[h]);
      both.own += old[h].own;
      both.mixed += old[h].mixed;
      out.with[i]->push_back(z_of(both, information, inflation));
    }
  });
  return out;
}

}  // namespace softarm::diagnose
