#include "joint_fit.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>
#include <utility>

#include "math/ceres_callback.h"

namespace softarm::identify {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kPasses = 8;
constexpr int kPassesOfInputs = 25;  // with errors of inputs, whose estimate follows that of the constants
// The prior that holds what is not determined: about the start, in scales, and wider by what was moved
// already.
constexpr double kWeakSd = 1.0;
constexpr double kWeakSdPerMove = 3.0;
constexpr double kKeptSd = 1e-6;  // of a constant that keeps its start, in scales

VectorXd scales(const std::vector<FreeConstant>& constants) {
  VectorXd scale(static_cast<int>(constants.size()));
  for (int j = 0; j < scale.size(); ++j) scale[j] = constants[static_cast<std::size_t>(j)].scale;
  return scale;
}

std::vector<ConstantRef> refs(const std::vector<FreeConstant>& constants) {
  std::vector<ConstantRef> list;
  for (const FreeConstant& constant : constants) list.push_back(constant.ref);
  return list;
}

}  // namespace

/// Solves every active frame when Ceres moves to another x; the blocks then only copy.
class JointProblem::Callback : public ceres::EvaluationCallback {
 public:
  Callback(JointProblem& problem, const VectorXd& x) : problem_(problem), x_(x) {}
  void PrepareForEvaluation(bool, bool new_point) override {
    if (!new_point) return;
    problem_.model_.set(problem_.scale_.cwiseProduct(x_));
    problem_.set_starts();
    valid_ = true;
    for (std::size_t i = 0; i < problem_.frames_.size() && valid_; ++i) {
      if (problem_.active_[i]) valid_ = problem_.evaluate_frame(i, false);
    }
  }
  bool valid() const { return valid_; }

 private:
  JointProblem& problem_;
  const VectorXd& x_;
  bool valid_ = false;
};

class JointProblem::BlockCost : public ceres::CostFunction {
 public:
  BlockCost(const JointProblem& problem, const Callback& callback, const ResidualBlock& block)
      : problem_(problem), callback_(callback), block_(block) {
    set_num_residuals(3);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.constants_.size()));
    const auto starts = static_cast<int>(problem.starts());
    has_starts_ = starts > 0;
    if (has_starts_) mutable_parameter_block_sizes()->push_back(starts);
    if (problem.has_zeros())
      mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.errors_.zero_sd.size()));
  }
  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    if (!callback_.valid()) return false;
    Eigen::Map<Vector3d>{residuals} = problem_.residual(block_);
    const auto write = [&](std::size_t which, const Eigen::MatrixXd& jacobian) {
      if (jacobians == nullptr || jacobians[which] == nullptr) return;
      Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[which], 3,
                                                                            jacobian.cols()) = jacobian;
    };
    write(0, problem_.jacobian(block_));
    if (has_starts_) write(1, problem_.jacobian_by_start(block_));
    if (problem_.has_zeros()) write(has_starts_ ? 2 : 1, problem_.jacobian_by_zero(block_));
    return true;
  }

 private:
  const JointProblem& problem_;
  const Callback& callback_;
  const ResidualBlock block_;
  bool has_starts_ = false;
};

namespace {

/// x stays near its start where nothing else determines it.
class WeakPrior : public ceres::CostFunction {
 public:
  WeakPrior(VectorXd start, VectorXd sd) : start_(std::move(start)), sd_(std::move(sd)) {
    set_num_residuals(static_cast<int>(start_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(start_.size()));
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const auto n = start_.size();
    Eigen::Map<VectorXd>(residuals, n) =
        (Eigen::Map<const VectorXd>(parameters[0], n) - start_).cwiseQuotient(sd_);
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<Eigen::MatrixXd>(jacobians[0], n, n) = sd_.cwiseInverse().asDiagonal();
    return true;
  }

 private:
  const VectorXd start_, sd_;
};

class Reporter : public ceres::IterationCallback {
 public:
  explicit Reporter(std::function<void()> report) : report_(std::move(report)) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    report_();
    return ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<void()> report_;
};

}  // namespace

JointProblem::JointProblem(const arm::Arm& arm, std::vector<FreeConstant> constants,
                           std::vector<trial::StaticFrame>& frames, const Options& options)
    : arm_(arm),
      constants_(std::move(constants)),
      frames_(frames),
      options_(options),
      model_(arm, refs(constants_)),
      scale_(scales(constants_)),
      equilibria_(frames.size()),
      predictions_(frames.size()),
      solved_(frames.size(), false),
      active_(frames.size(), true) {
  const auto numbers = model_.start_sd().size();
  if (numbers == 0) return;
  for (const trial::StaticFrame& frame : frames_) starts_[frame.trial] = VectorXd::Zero(numbers);
}

void JointProblem::add(Line line) {
  line_ = std::move(line);
  const Eigen::Index walls = model_.start_sd().size();
  for (const auto& [trial, effects] : line_.starts) {
    if (effects.size() == 0) continue;
    VectorXd& start = starts_[trial];
    start.conservativeResize(walls + effects.size());
    start.tail(effects.size()) = effects;
  }
}

VectorXd JointProblem::walls_of(const VectorXd& start) const {
  return start.head(model_.start_sd().size()).cwiseProduct(model_.start_sd());
}

void JointProblem::set_starts() {
  for (const auto& [trial, start] : starts_) model_.set_start(trial, walls_of(start));
}

bool JointProblem::evaluate_frame(std::size_t i, bool cold) {
  if (cold) equilibria_[i].reset();
  Prediction& predicted = predictions_[i];
  solved_[i] = model_.predict(inputs_.empty() ? frames_[i] : inputs_[i].frame(), equilibria_[i], predicted);
  if (!solved_[i]) return false;
  if (line_.frames.empty()) {
    reduce(i);
    return true;
  }
  const Slopes& slopes = line_.frames[i];
  const VectorXd way = model_.theta() - line_.about;
  Eigen::Map<VectorXd>(predicted.p.data(), predicted.p.size()) += slopes.p * way;
  Eigen::Map<VectorXd>(predicted.tangent.data(), predicted.tangent.size()) += slopes.tangent * way;
  predicted.dp += slopes.p;
  predicted.dtangent += slopes.tangent;
  if (slopes.p_by_start.cols() > 0) {
    const std::size_t trial = frames_[i].trial;
    const VectorXd& effects = line_.starts.at(trial);
    const VectorXd start_way = starts_.at(trial).tail(effects.size()) - effects;
    Eigen::Map<VectorXd>(predicted.p.data(), predicted.p.size()) += slopes.p_by_start * start_way;
    Eigen::Map<VectorXd>(predicted.tangent.data(), predicted.tangent.size()) +=
        slopes.tangent_by_start * start_way;
  }
  return true;
}

std::size_t JointProblem::evaluate(const VectorXd& theta) {
  model_.set(theta);
  set_starts();
  std::size_t solved = 0;
  for (std::size_t i = 0; i < frames_.size(); ++i) solved += evaluate_frame(i, false) ? 1 : 0;
  return solved;
}

double JointProblem::sd(const ResidualBlock& block) const {
  const trial::SeenBody& seen = frames_[block.frame].bodies[static_cast<std::size_t>(block.body)];
  const arm::MeasuredBody& body = arm_.bodies[static_cast<std::size_t>(seen.body)];
  return block.tangent ? body.orientation_sd_rad : body.position_sd_m;
}

Vector3d JointProblem::residual(const ResidualBlock& block) const {
  if (!inputs_.empty()) return reduced_[block.frame].segment<3>(6 * block.body + (block.tangent ? 3 : 0));
  const trial::SeenBody& seen = frames_[block.frame].bodies[static_cast<std::size_t>(block.body)];
  const Prediction& predicted = predictions_[block.frame];
  if (block.tangent) return (predicted.tangent.col(block.body) - *seen.tangent_base) / sd(block);
  return (predicted.p.col(block.body) - seen.p_base) / sd(block);
}

Eigen::MatrixXd JointProblem::jacobian(const ResidualBlock& block) const {
  if (!inputs_.empty()) {
    const int row = 6 * block.body + (block.tangent ? 3 : 0);
    Eigen::MatrixXd by_x = inputs_[block.frame].whitening().middleRows(row, 3) * rows_by_x(block.frame);
    const auto zeros = zeros_by_x_.find(frames_[block.frame].trial);
    if (zeros != zeros_by_x_.end()) by_x -= jacobian_by_zero(block) * zeros->second;
    return by_x;
  }
  const Prediction& predicted = predictions_[block.frame];
  const auto& by_theta = block.tangent ? predicted.dtangent : predicted.dp;
  return by_theta.middleRows(3 * block.body, 3) * scale_.asDiagonal() / sd(block);
}

Eigen::MatrixXd JointProblem::jacobian_by_start(const ResidualBlock& block) const {
  const Prediction& predicted = predictions_[block.frame];
  const auto& by_start = block.tangent ? predicted.dtangent_by_start : predicted.dp_by_start;
  Eigen::MatrixXd all(3, starts());
  all.leftCols(by_start.cols()) = by_start.middleRows(3 * block.body, 3) * model_.start_sd().asDiagonal();
  if (all.cols() > by_start.cols()) {
    const Slopes& slopes = line_.frames[block.frame];
    const Eigen::MatrixXd& effects = block.tangent ? slopes.tangent_by_start : slopes.p_by_start;
    all.rightCols(effects.cols()) = effects.middleRows(3 * block.body, 3);
  }
  return all / sd(block);
}

std::vector<ResidualBlock> JointProblem::blocks() const {
  std::vector<ResidualBlock> list;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!active_[i] || !solved_[i]) continue;
    for (std::size_t k = 0; k < frames_[i].bodies.size(); ++k) {
      const trial::SeenBody& seen = frames_[i].bodies[k];
      if (!seen.used) continue;
      list.push_back({i, static_cast<int>(k), false});
      if (seen.tangent_base) list.push_back({i, static_cast<int>(k), true});
    }
  }
  return list;
}

/// Frames that lie far off may sit on another branch of equilibria than the arm does.
void JointProblem::retry_cold(double threshold) {
  const auto badness = [&](std::size_t i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < frames_[i].bodies.size(); ++k)
      sum += residual({i, static_cast<int>(k), false}).norm() / static_cast<double>(frames_[i].bodies.size());
    return sum;
  };
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!solved_[i]) {
      evaluate_frame(i, true);
      continue;
    }
    const double before = badness(i);
    if (before < threshold) continue;
    const auto equilibrium = equilibria_[i];
    if (!evaluate_frame(i, true) || badness(i) >= before) {
      equilibria_[i] = equilibrium;
      evaluate_frame(i, false);
    }
  }
}

bool JointProblem::minimise(VectorXd& x, const std::function<void(int)>& progress) {
  Callback callback(*this, x);
  ceres::Problem::Options problem_options;
  ceres::Solver::Options options;
  math::set_evaluation_callback(callback, problem_options, options);
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  std::map<std::pair<int, bool>, std::unique_ptr<ceres::LossFunction>> losses;
  ceres::Problem problem(problem_options);
  problem.AddParameterBlock(x.data(), static_cast<int>(x.size()));
  VectorXd start = x;
  for (int j = 0; j < x.size(); ++j) {
    const FreeConstant& constant = constants_[static_cast<std::size_t>(j)];
    const double low = constant.range.low / constant.scale, high = constant.range.high / constant.scale;
    problem.SetParameterLowerBound(x.data(), j, low);
    problem.SetParameterUpperBound(x.data(), j, high);
    x[j] = std::clamp(x[j], low, high);
    start[j] = std::clamp(constant.initial / constant.scale, low, high);
  }
  for (const ResidualBlock& block : blocks()) {
    const int body = frames_[block.frame].bodies[static_cast<std::size_t>(block.body)].body;
    std::unique_ptr<ceres::LossFunction>& loss = losses[{body, block.tangent}];
    if (options_.robust && !loss)
      loss = std::make_unique<ceres::HuberLoss>(kHuber * scale_of(body, block.tangent));
    std::vector<double*> unknowns{x.data()};
    if (!starts_.empty()) unknowns.push_back(starts_.at(frames_[block.frame].trial).data());
    if (has_zeros()) unknowns.push_back(zeros_[frames_[block.frame].trial].data());
    problem.AddResidualBlock(new BlockCost(*this, callback, block), loss.get(), unknowns);
  }
  for (auto& [trial, start_of] : starts_) {
    const auto numbers = start_of.size();
    problem.AddResidualBlock(new WeakPrior(VectorXd::Zero(numbers), VectorXd::Ones(numbers)), nullptr,
                             start_of.data());
  }
  VectorXd sd = (kWeakSdPerMove * (x - start).cwiseAbs()).cwiseMax(kWeakSd);
  for (int j = 0; j < x.size(); ++j) {
    if (!constants_[static_cast<std::size_t>(j)].kept) continue;
    x[j] = start[j];
    sd[j] = kKeptSd;
  }
  problem.AddResidualBlock(new WeakPrior(start, sd), nullptr, x.data());
  zeros_by_x_.clear();
  for (auto& [trial, zero] : zeros_) {
    const VectorXd none = VectorXd::Zero(zero.size());
    problem.AddResidualBlock(new WeakPrior(none, VectorXd::Constant(zero.size(), 1.0 / misfit())), nullptr,
                             zero.data());
  }
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = options_.max_iterations;
  options.max_num_consecutive_invalid_steps = 30;
  options.function_tolerance = 1e-9;
  options.parameter_tolerance = 1e-8;
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = true;
  Reporter reporter([&] { progress(++iterations_); });
  options.callbacks.push_back(&reporter);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.termination_type == ceres::CONVERGENCE;
}

JointFit JointProblem::solve(const std::function<void(int)>& progress) {
  VectorXd theta(scale_.size());
  for (int j = 0; j < theta.size(); ++j) theta[j] = constants_[static_cast<std::size_t>(j)].initial;
  JointFit fit;
  evaluate(theta);
  active_ = solved_;
  if (std::find(active_.begin(), active_.end(), true) == active_.end())
    throw IdentifyError(
        "the arm as described has no equilibrium under the load of any frame; check its "
        "stiffness, mass and attitude, and the payload");
  measure_scales();
  update_inputs();
  for (int pass = 0; pass < (inputs_.empty() ? kPasses : kPassesOfInputs); ++pass) {
    VectorXd x = theta.cwiseQuotient(scale_);
    fit.converged = minimise(x, progress);
    theta = x.cwiseProduct(scale_);
    evaluate(theta);
    const std::vector<bool> before = active_;
    const double old_scales[2] = {position_scale_, tangent_scale_};
    const std::map<int, double> old_body_scales[2] = {body_scale_[0], body_scale_[1]};
    retry_cold(kGross * position_scale_);
    active_ = solved_;
    measure_scales();
    bool changed = update_inputs();
    changed = (options_.robust && set_outliers_aside()) || changed;
    changed = changed || active_ != before;
    // The scales decide what Huber's loss bounds: they have settled when they change no more.
    const auto moved = [](double now, double then) { return std::abs(now - then) > 0.02 * then; };
    changed = changed || (options_.robust &&
                          (moved(position_scale_, old_scales[0]) || moved(tangent_scale_, old_scales[1])));
    for (const int kind : {0, 1}) {
      const double all = kind == 1 ? tangent_scale_ : position_scale_;
      for (const auto& [body, then] : old_body_scales[kind])
        changed = changed || (options_.robust && moved(scale_of(body, kind == 1), std::max(then, all)));
    }
    if (!changed && pass > 0) break;
  }
  if (has_zeros()) eliminate_zeros();
  fit.theta = theta;
  for (const auto& [trial, start] : starts_) {
    fit.starts[trial] = walls_of(start);
    fit.effect_starts[trial] = start.tail(start.size() - fit.starts[trial].size());
  }
  fit.iterations = iterations_;
  fit.position_scale = position_scale_;
  fit.tangent_scale = tangent_scale_;
  fit.solved = solved_;
  if (options_.robust) fit.beyond_the_model = beyond_the_model();
  return fit;
}

}  // namespace softarm::identify
