// All frames together: the constants at which the predicted shapes lie nearest to the measured ones.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "input_errors.h"
#include "law_model.h"
#include "motion.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {

constexpr double kHuber = 3.5;  ///< distances of bodies over noise and misfit, beyond which they are bounded
constexpr double kGross = 6.0;  ///< and at which a body is dropped

/// A free constant, scaled for the solver: theta = scale x.
struct FreeConstant {
  ConstantRef ref;
  double initial = 0.0;
  double scale = 1.0;
  arm::Range range;
  bool kept = false;  ///< stays at its start
};

/// One block of residuals: position or tangent of one body of one frame.
struct ResidualBlock {
  std::size_t frame = 0;
  int body = 0;  ///< index into StaticFrame::bodies
  bool tangent = false;
};

/// What is not in the laws, of a frame: derivatives of its bodies by the constants, 3 bodies x constants.
struct Slopes {
  Eigen::MatrixXd p, tangent;
  Eigen::MatrixXd p_by_start, tangent_by_start;  ///< 3 bodies x numbers, over their standard deviations
};
/// The same of all frames, at these constants and, by trial, at these numbers of how it found the effects.
struct Line {
  Eigen::VectorXd about;
  std::vector<Slopes> frames;
  std::map<std::size_t, Eigen::VectorXd> starts;  ///< over their standard deviations
};

struct JointFit {
  Eigen::VectorXd theta;
  std::map<std::size_t, Eigen::VectorXd> starts;         ///< of the walls, by trial, see LawModel::start_sd()
  std::map<std::size_t, Eigen::VectorXd> effect_starts;  ///< the same of effects, see Line
  bool converged = false;
  int iterations = 0;
  double position_scale = 1.0, tangent_scale = 1.0;  ///< misfit over noise, robust, at least 1
  std::vector<bool> solved;                          ///< per frame
  /// By body of the arm: observations that lie off like an outlier, but with too many others to be one.
  std::map<int, std::uint64_t> beyond_the_model;
};

/// What the noise of one input does: mean squares over the rows of positions.
struct NoiseAtBodies {
  std::vector<double> square_m2;  ///< by input
  double all_m2 = 0.0;
};

/// The zeros of one trial's sensors, over their zero_sd.
struct TrialZeros {
  Eigen::VectorXd value, sd;  ///< by input
};

class JointProblem {
 public:
  /// @param frames bodies are set aside in it as outliers
  JointProblem(const arm::Arm& arm, std::vector<FreeConstant> constants,
               std::vector<trial::StaticFrame>& frames, const Options& options);

  /// @param progress called after each iteration with their number over all passes
  JointFit solve(const std::function<void(int)>& progress);

  /// Adds what else changes in the frames where the constants leave those of the line.
  void add(Line line);

  /// Has what the motion does that statics leave out: of no meaning to the fit, but to how sure it is.
  void add(std::vector<FrameMotion> motion) { motion_ = std::move(motion); }
  /// Predicts what inertia, and the lag of the wall, do in all frames, at the fit's end.
  void predict_motion();
  /// What these two do to a block, whitened: 3 x 2; no columns where they were not predicted.
  Eigen::MatrixXd by_motion(const ResidualBlock& block) const;

  /// Takes noise and zeros of the inputs for unknowns.
  void add(SensorErrors errors);
  NoiseAtBodies noise_at_bodies() const;
  /// By trial, as of the fit's end. @param covariance of the constants, in x; @param factor of standard
  /// deviations
  std::map<std::size_t, TrialZeros> zeros(const Eigen::MatrixXd& covariance, double factor) const;
  /// Direction cosines between what the zeros, alike in all trials, and what the constants do: inputs x
  /// constants.
  Eigen::MatrixXd alike() const;
  /// What the prior of the zeros adds to the information about x.
  const Eigen::MatrixXd& information_of_zeros() const { return information_of_zeros_; }

  /// From now on the constant keeps its start, or does so no more; for another solve().
  void keep(int constant, bool kept) { constants_[static_cast<std::size_t>(constant)].kept = kept; }

  LawModel& model() { return model_; }
  const LawModel& model() const { return model_; }
  /// Residual of a block at the last evaluation, whitened.
  Eigen::Vector3d residual(const ResidualBlock& block) const;
  /// Predicted less measured, m; of blocks that are positions.
  Eigen::Vector3d position_error_m(const ResidualBlock& block) const;
  /// Its derivative by x, with the zeros following where there are such.
  Eigen::MatrixXd jacobian(const ResidualBlock& block) const;
  /// Its derivative by how its trial found the walls, and then the effects, in standard deviations; no
  /// columns where neither remembers anything.
  Eigen::MatrixXd jacobian_by_start(const ResidualBlock& block) const;
  /// Huber's weight of a squared whitened distance: 1 inside the threshold.
  double weight(const ResidualBlock& block, double squared_distance) const;
  /// Blocks of used bodies of frames that have a shape.
  std::vector<ResidualBlock> blocks() const;

  /// Predicts all frames at theta. @return how many have a shape
  std::size_t evaluate(const Eigen::VectorXd& theta);

 private:
  class Callback;
  class BlockCost;

  double sd(const ResidualBlock& block) const;
  /// Misfit over noise, of all bodies and, where that of one is larger, of each.
  void measure_scales();
  double scale_of(int body, bool tangent) const;
  bool set_outliers_aside();
  std::map<int, std::uint64_t> beyond_the_model() const;
  void retry_cold(double threshold);
  void set_starts();
  Eigen::VectorXd walls_of(const Eigen::VectorXd& start) const;
  Eigen::Index starts() const { return starts_.empty() ? 0 : starts_.begin()->second.size(); }
  bool minimise(Eigen::VectorXd& x, const std::function<void(int)>& progress);
  bool evaluate_frame(std::size_t i, bool cold);
  // joint_fit_inputs.cpp
  Eigen::VectorXd rows(
      std::size_t frame) const;  ///< predicted less measured over sd, as FrameInputs has them
  Eigen::MatrixXd rows_by_x(std::size_t frame) const;
  void reduce(std::size_t frame);
  bool update_inputs();
  double misfit() const;
  bool has_zeros() const { return errors_.any() && errors_.zero_sd.any(); }
  Eigen::MatrixXd jacobian_by_zero(const ResidualBlock& block) const;
  void eliminate_zeros();

  const arm::Arm& arm_;
  std::vector<FreeConstant> constants_;
  std::vector<trial::StaticFrame>& frames_;
  const Options& options_;
  LawModel model_;
  Eigen::VectorXd scale_;
  std::vector<std::optional<model::Equilibrium>> equilibria_;
  std::vector<Prediction> predictions_;
  /// Of the walls, then the effects, when a trial begins, in standard deviations, by trial; empty where
  /// neither remembers anything.
  std::map<std::size_t, Eigen::VectorXd> starts_;
  Line line_;                               ///< empty: nothing does
  std::vector<FrameMotion> motion_;         ///< per frame; empty: nobody knows of any
  std::vector<Eigen::MatrixXd> by_motion_;  ///< per frame: 6 bodies x 2, over sd, as rows()
  std::vector<bool> solved_;                ///< at the last evaluation
  std::vector<bool> active_;                ///< part of the present pass
  double position_scale_ = 1.0, tangent_scale_ = 1.0;
  std::map<int, double> body_scale_[2];  ///< of positions, of tangents
  int iterations_ = 0;
  SensorErrors errors_;                           ///< of no size: inputs are exact
  std::vector<FrameInputs> inputs_;               ///< per frame; empty: the same
  std::vector<Eigen::VectorXd> reduced_;          ///< per frame: whitened, as FrameInputs has its rows
  std::map<std::size_t, Eigen::VectorXd> zeros_;  ///< by trial, over zero_sd
  std::map<std::size_t, Eigen::MatrixXd> zeros_by_x_, zeros_information_;  ///< by trial
  Eigen::MatrixXd information_of_zeros_;
};

}  // namespace softarm::identify
