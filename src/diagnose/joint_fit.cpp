// The fit of the joint model: bounds, steps, convergence. What it minimises is in joint_loss.cpp.
#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "joint_model.h"
#include "math/ceres_callback.h"
#include "math/linear_algebra.h"
#include "policy.h"
#include "ranges.h"

namespace softarm::diagnose {
namespace {

using Eigen::VectorXd;
using model::Predicted;
using model::Present;

// How the fit gets to its end, not where that is: no verdict goes by these.
constexpr double kSettled = 0.02;  // of the threshold
// Of Ceres's trust region, over the columns' norms (its own is 1e4): as good as none, for the steps of Gauss
// and Newton; and what damps them where they overshoot (Levenberg and Marquardt), directions that the data
// determine a hundred times worse than the unknowns one by one. It goes on from there by how steps turn out.
constexpr double kNoRadius = 1e8, kRadius = 100.0;
// Times that a step is shortened, where the whole one does not help: by derivatives of its own, and by those
// of a model nearby, which are likelier to point elsewhere. Damped steps are turned, not only shortened.
constexpr int kShorterSteps = 5, kShorterStepsNearby = 1;
constexpr int kRejectedSteps = 6;  // damped ones, in one pass: then it is at its end, or the loss has a kink
// Of a step that does not help, as it is tried next: a loss that was given up says only that it is too long.
constexpr double kMostShortening = 0.5;

}  // namespace

/// All bodies at the unknowns where Ceres is: predicted, and where it wants derivatives, linearised.
class JointModel::Evaluation : public ceres::EvaluationCallback {
 public:
  Evaluation(JointModel& model, Linearised at, Derivatives how, const Linearised* near)
      : model_(model), how_(how), near_(near), at_(std::move(at)), x_at_(at_.unknowns()), x_(x_at_) {
    x_there_.setConstant(x_.size(), std::numeric_limits<double>::quiet_NaN());
  }

  void PrepareForEvaluation(bool derivatives, bool) override {
    if (x_ != x_at_ && x_ != x_there_) {
      if (derivatives)
        model_.predict(parameters(), &at_.predicted, there_);
      else
        // Ceres takes no step that ends beyond where it is.
        model_.predict_within(parameters(), at_.predicted, model_.threshold_,
                              twice_cost(at_.predicted, x_at_), there_);
      x_there_ = x_;
    }
    if (!derivatives || x_ == x_at_) return;
    const JointParameters p = parameters();
    // Whole derivatives cost a prediction each: on a way as short as the last steps are, those of its begin.
    at_ = model_.linearise_at(p, std::move(there_), how_, how_ == Derivatives::kWhole ? &at_ : near_);
    ++moves_;
    x_at_ = x_;
    x_there_.setConstant(std::numeric_limits<double>::quiet_NaN());
  }

  /// Where derivatives were wanted last: at a step that was accepted.
  Linearised& at() { return at_; }
  const Linearised& at() const { return at_; }
  VectorXd& x() { return x_; }
  void back_to_accepted() { x_ = x_at_; }
  /// FitOptions::most_square. The first step may be one over a kink, behind which derivatives are others.
  bool is_hopeless(double most_square) const {
    return moves_ > 1 && std::isfinite(most_square) && expected_square(at_) > most_square;
  }
  bool has_own_derivatives() const { return near_ == nullptr; }
  /// In place of those of a model nearby, from here on.
  void make_own_derivatives() {
    if (has_own_derivatives()) return;
    near_ = nullptr;
    at_ = model_.linearise_at(at_.at, std::move(at_.predicted), how_, nullptr);
  }

  /// Where Ceres is.
  double twice_cost() const { return twice_cost(x_ == x_at_ ? at_.predicted : there_, x_); }

 private:
  double twice_cost(const std::vector<std::vector<Predicted>>& predicted, const VectorXd& x) const {
    double sum = model_.loss(predicted, model_.threshold_);
    for (std::size_t j = 0; j < at_.columns.size(); ++j) {
      const JointUnknown& c = at_.columns[j];
      sum += model_.misfit_ * std::pow((x[static_cast<Eigen::Index>(j)] - c.start) / c.prior_sd, 2);
    }
    return sum;
  }
  JointParameters parameters() const {
    JointParameters p = at_.at;
    for (Eigen::Index j = 0; j < x_.size(); ++j)
      set_unknown(p, at_.columns[static_cast<std::size_t>(j)], x_[j]);
    return p;
  }

  JointModel& model_;
  const Derivatives how_;
  int moves_ = 0;           ///< steps that were accepted
  const Linearised* near_;  ///< whose derivatives by the rod will do; nullptr: its own
  Linearised at_;
  std::vector<std::vector<Predicted>> there_;
  VectorXd x_at_, x_there_;  ///< where linearised last, and predicted; NaN: nowhere
  VectorXd x_;               ///< where Ceres is
};

/// Huber's loss of all bodies, and the priors. Of thousands of residuals Ceres would only make the sums that
/// a linearisation has: J^T J and J^T r. As many residuals as there are unknowns have the same sums, and one
/// more, without derivatives, makes up the rest of the cost.
class JointModel::WholeCost : public ceres::CostFunction {
 public:
  explicit WholeCost(const Evaluation& evaluation) : evaluation_(evaluation) {
    const std::size_t unknowns = evaluation.at().columns.size();
    set_num_residuals(static_cast<int>(unknowns) + 1);
    mutable_parameter_block_sizes()->assign(unknowns, 1);
  }
  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    Eigen::Map<VectorXd> r(residuals, num_residuals());
    r.setZero();
    if (jacobians != nullptr) {
      // J is a root of the information. Scaled, so that what counts little is not lost beside what counts
      // much.
      const Linearised& at = evaluation_.at();
      const VectorXd scale = at.information.diagonal().cwiseSqrt();
      const VectorXd per = scale.cwiseInverse();
      const math::Eigensystem eigen =
          math::eigensystem_of(per.asDiagonal() * at.information * per.asDiagonal());
      const VectorXd root = eigen.values.cwiseMax(kRounding).cwiseSqrt();
      const Eigen::Index n = scale.size();
      r.head(n) = -(eigen.vectors.transpose() * per.cwiseProduct(at.gradient)).cwiseQuotient(root);
      for (Eigen::Index j = 0; j < n; ++j) {
        if (jacobians[j] == nullptr) continue;
        Eigen::Map<VectorXd> derivative(jacobians[j], n + 1);
        derivative.head(n) = scale[j] * root.cwiseProduct(eigen.vectors.row(j).transpose());
        derivative[n] = 0.0;
      }
    }
    // Less than nothing is rounding. What is no number stays none: Ceres takes no such step.
    const double rest = evaluation_.twice_cost() - r.squaredNorm();
    r[r.size() - 1] = rest < 0.0 ? 0.0 : std::sqrt(rest);
    return true;
  }

 private:
  static constexpr double kRounding = 1e-15;  // of information over its diagonal

  const Evaluation& evaluation_;
};

double expected_square(const Linearised& at) {
  return at.square - at.gradient.dot(math::solve_symmetric(at.information, at.gradient));
}

namespace {

/// The step of Gauss and Newton that is left to the unknowns that are not held: the largest in standard
/// deviations, those scaled by the misfit. Costs themselves are no measure: they change a little with the
/// shapes from which a prediction begins.
double step_left(const Linearised& at) {
  Eigen::MatrixXd information = at.information;
  VectorXd gradient = at.gradient;
  hold(held_at_ends(at), information, gradient);
  const math::SymmetricSolver solver(information);
  const VectorXd variance = solver.inverse().diagonal();
  const double misfit = std::max(1.0, at.square / std::max(1, at.rows));
  return (solver.solve(gradient).array() / variance.array().sqrt()).abs().maxCoeff() / std::sqrt(misfit);
}

/// Ends a pass after so many steps, at a point that will do, or behind which what the pass took for granted
/// does not hold any more.
class Watch : public ceres::IterationCallback {
 public:
  Watch(std::function<bool()> enough, int steps, bool damped)
      : enough_(std::move(enough)), steps_(steps), damped_(damped) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    // A step of which no part helps is not helped by half of no radius.
    bool enough = !damped_;
    if (summary.step_is_successful) {
      if (summary.iteration > 0) --steps_;  // the first is the start
      enough = enough_() || steps_ <= 0;
    }
    return enough ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<bool()> enough_;
  int steps_;
  const bool damped_;
};

/// How far steps go, and what becomes of those that do not help.
void set_steps(double radius, int iterations, bool own_derivatives, ceres::Solver::Options& options) {
  options.max_num_iterations = iterations + kRejectedSteps;
  options.initial_trust_region_radius = radius;
  options.line_search_interpolation_type = ceres::QUADRATIC;  // along a step, by predictions alone
  options.max_line_search_step_contraction = kMostShortening;
  const int shorter = own_derivatives ? kShorterSteps : kShorterStepsNearby;
  // One is the whole step alone, which Ceres predicts anyway; less than that Ceres 1.14 refuses.
  options.max_num_line_search_step_size_iterations = radius < kNoRadius ? 1 : shorter;
}

}  // namespace

/// One pass of Ceres, with one threshold of Huber's loss and one set of unknowns held at their bounds.
/// @param iterations those left, less those made afterwards
/// @param radius of the trust region, as the pass before left it: kNoRadius are steps of Gauss and Newton;
/// where these no longer help, it is less afterwards, for steps of Levenberg and Marquardt
/// @return whether any step helped
bool JointModel::minimise(Evaluation& evaluation, const FitOptions& how, double& radius, int& iterations) {
  const bool damped = radius < kNoRadius;
  const std::vector<bool> held = held_at_ends(evaluation.at());
  const auto enough = [&] {
    const double now = threshold_at(evaluation.at().predicted);
    return std::abs(now - threshold_) > kSettled * threshold_ || held_at_ends(evaluation.at()) != held ||
           step_left(evaluation.at()) < how.tolerance || evaluation.is_hopeless(how.most_square);
  };
  ceres::Problem::Options problem_options;
  ceres::Solver::Options options;
  math::set_evaluation_callback(evaluation, problem_options, options);
  ceres::Problem problem(problem_options);
  std::vector<double*> unknowns;
  for (std::size_t j = 0; j < held.size(); ++j) {
    const JointUnknown& c = evaluation.at().columns[j];
    double* x = &evaluation.x()[static_cast<Eigen::Index>(j)];
    unknowns.push_back(x);
    problem.AddParameterBlock(x, 1);
    problem.SetParameterLowerBound(x, 0, c.low / c.scale);
    problem.SetParameterUpperBound(x, 0, c.high / c.scale);
    if (held[j]) problem.SetParameterBlockConstant(x);
  }
  problem.AddResidualBlock(new WholeCost(evaluation), nullptr, unknowns);
  Watch watch(enough, iterations, damped);
  set_steps(radius, iterations, evaluation.has_own_derivatives(), options);
  options.callbacks.push_back(&watch);
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.function_tolerance = how.tolerance * how.tolerance / std::max(1, evaluation.at().rows);
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (summary.iterations.empty()) throw std::logic_error("fit: " + summary.message);
  evaluation.back_to_accepted();
  const int steps = summary.num_successful_steps - 1;
  const bool overshot = !damped && summary.num_unsuccessful_steps > 0;
  iterations -= overshot ? steps : std::max(1, steps);
  if (damped) radius = std::min(kNoRadius, summary.iterations.back().trust_region_radius);
  if (overshot) radius = kRadius;
  return steps > 0;
}

Linearised JointModel::fit(JointParameters parameters, const FitOptions& options,
                           const std::vector<std::vector<Predicted>>* start) {
  std::vector<std::vector<Predicted>> predicted;
  const Linearised* near = options.near;
  double radius = options.damped ? kRadius : kNoRadius;
  if (options.from != nullptr) {
    // Where the first order is that wrong derivatives nearby are, too.
    if (go_as_far_as_it_helps(*options.from, parameters, predicted)) {
      near = nullptr;
      radius = kRadius;
    }
  } else if (options.known) {
    predicted = *start;
  } else {
    predict(parameters, start, predicted);
  }
  threshold_ = threshold_at(predicted);
  const Derivatives how =
      needs_whole_derivatives(parameters) ? options.derivatives : Derivatives::kShapesHeld;
  const bool begun = options.begins != nullptr && options.begins->own_derivatives;
  Linearised begin = begun ? *options.begins : linearise_at(parameters, std::move(predicted), how, near);
  if (begun) weigh(begin);
  Evaluation evaluation(*this, std::move(begin), how, near);
  bool given_up = false;
  for (int left = options.iterations; left > 0;) {
    const bool was_damped = radius < kNoRadius;
    const bool moved = minimise(evaluation, options, radius, left);
    const double before = threshold_;
    threshold_ = threshold_at(evaluation.at().predicted);
    weigh(evaluation.at());
    if (step_left(evaluation.at()) < options.tolerance) break;
    given_up = evaluation.is_hopeless(options.most_square);
    if (given_up) break;
    if (radius < kNoRadius && !was_damped) {
      // First for what may be wrong about derivatives nearby.
      if (!evaluation.has_own_derivatives()) radius = kNoRadius;
      evaluation.make_own_derivatives();
    } else if (!moved && std::abs(threshold_ - before) <= kSettled * before) {
      break;
    }
  }
  const bool converged = step_left(evaluation.at()) < kPolicy.fit.converged_sd;
  const bool own = evaluation.has_own_derivatives();
  Linearised at = std::move(evaluation.at());
  const bool whole = needs_whole_derivatives(at.at);
  at.own_derivatives = own && (!whole || how == Derivatives::kWhole);
  at.converged = converged;
  at.given_up = given_up && !converged;
  at.damped = radius < kNoRadius;
  if (whole && options.whole && how != Derivatives::kWhole) take_own_derivatives(at);
  return at;
}

void JointModel::take_own_derivatives(Linearised& at, bool by_all) {
  threshold_ = threshold_at(at.predicted);
  const Derivatives how = needs_whole_derivatives(at.at) ? Derivatives::kWhole : Derivatives::kShapesHeld;
  Linearised own = linearise_at(at.at, std::move(at.predicted), how, nullptr, by_all);
  own.own_derivatives = true;
  own.converged = at.converged;
  own.given_up = at.given_up;
  own.damped = at.damped;
  at = std::move(own);
}

Linearised JointModel::fit_without(JointParameters parameters, const std::vector<bool>& without,
                                   const Linearised& all) {
  constexpr int kIterations = 3;      // from where a linear model expects the end
  constexpr double kTolerance = 0.2;  // of a step against the standard deviations
  std::vector<std::size_t> others;
  for (std::size_t t = 0; t < without.size(); ++t)
    if (!without[t]) others.push_back(t);
  const double threshold = threshold_;
  look_at(others);
  FitOptions how;
  how.whole = false;
  how.iterations = kIterations;
  how.tolerance = kTolerance;
  how.near = &all;
  how.from = &all;
  Linearised at = fit(std::move(parameters), how, &all.predicted);
  look_at({});
  threshold_ = threshold;
  return at;
}

bool JointModel::needs_whole_derivatives(const JointParameters& parameters) const {
  const std::vector<Present> present = all(parameters.effects);
  return std::any_of(present.begin(), present.end(),
                     [](const Present& one) { return one.effect->needs_whole_derivatives(one.values); });
}

}  // namespace softarm::diagnose
