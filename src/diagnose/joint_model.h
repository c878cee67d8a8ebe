// All trials under one set of constants and effects: residuals, derivatives, the fit.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softarm/effects/extended_model.h"
#include "softarm/identify/constants.h"

namespace softarm::diagnose {

/// What is fitted: the arm's constants, the delay of its wall, and the effects in the model.
struct Parameters {
  Eigen::VectorXd constants;  ///< of JointModel::constants
  double retardation_s = 0.0;
  std::vector<effects::Present> effects;
};

/// One column of the fit.
struct Column {
  enum class Kind { kConstant, kRetardation, kEffect } kind = Kind::kConstant;
  int index = 0;       ///< of the constant, or the effect
  int parameter = 0;   ///< of the effect
  double scale = 1.0;  ///< the unknowns are values over scales
  double low = 0.0, high = 0.0;
  double start = 0.0, prior_sd = 0.0;  ///< in scales, about start
};

/// Sums over a short stretch of one trial, of whitened residuals r and derivatives J. Stretches are taken for
/// independent of each other.
struct Chunk {
  std::size_t trial = 0;
  Eigen::MatrixXd information;  ///< J^T J
  Eigen::VectorXd gradient;     ///< J^T r
  double square = 0.0;          ///< r^T r
  int rows = 0;                 ///< that count
  Eigen::Index all_rows = 0;    ///< of the trial's vectors that belong to it
};

/// The model at one set of parameters, with derivatives.
struct Linearised {
  Parameters at;
  std::vector<Column> columns;
  std::vector<std::vector<effects::Predicted>> predicted;  ///< by trial
  std::vector<effects::ExtendedModel::Varied> reference;   ///< by trial
  /// Whitened, used bodies of all blocks one after the other; per trial. 0 where not used.
  std::vector<Eigen::VectorXd> residual;
  std::vector<Eigen::MatrixXd> derivative;
  std::vector<Eigen::VectorXd> root_weight;  ///< Huber's, by row; both of the above are times it
  std::vector<Chunk> chunks;
  Eigen::MatrixXd information;  ///< sum of the chunks, with the prior
  Eigen::VectorXd gradient;     ///< the same
  double square = 0.0;
  int rows = 0;
  bool complete = false;  ///< Predicted::by_rod by all of the rod's parameters; else by those of the columns

  Eigen::VectorXd unknowns() const;  ///< values over scales
};

class JointModel {
 public:
  /// @param trials kept by reference
  /// @param jobs threads, 0: one per core
  /// @param held, tied patterns, see Options
  /// @param known effects that are in every prediction, at their values
  /// @throws std::invalid_argument for patterns that match nothing
  JointModel(const Arm& arm, const std::vector<effects::TrialData>& trials, unsigned jobs,
             const std::vector<std::string>& held = {}, const std::vector<std::string>& tied = {},
             const std::vector<effects::Present>& known = {});

  const Arm& arm() const { return arm_; }
  const std::vector<effects::Present>& known() const { return known_; }
  /// The known effects, and these.
  std::vector<effects::Present> all(const std::vector<effects::Present>& fitted) const;
  const std::vector<identify::ConstantRef>& constants() const { return constants_; }
  const std::vector<effects::TrialData>& trials() const { return trials_; }
  const effects::FineRod& rod() const { return models_.front().rod(); }
  Arm arm_with(const Eigen::VectorXd& constants) const;

  /// The arm file's constants, no effect.
  Parameters start() const;
  std::vector<Column> columns(const Parameters& parameters) const;

  /// Predictions of all trials.
  void predict(const Parameters& parameters, const std::vector<std::vector<effects::Predicted>>* start,
               std::vector<std::vector<effects::Predicted>>& out);
  enum class Derivatives {
    kShapesHeld,  ///< to first order with shapes held in what depends on them
    kWhole,       ///< differences of whole predictions
  };
  /// @param start shapes to begin from
  /// @param known that `start` are the predictions at `parameters`
  Linearised linearise(const Parameters& parameters,
                       const std::vector<std::vector<effects::Predicted>>* start,
                       Derivatives how = Derivatives::kShapesHeld, bool known = false);
  /// What depends on the shape that it causes, a spring or a wall, answers to every change: there the first
  /// order with shapes held is wrong by up to several times. It finds the way; intervals want the truth.
  bool answers_itself(const Parameters& parameters) const;
  /// Derivatives by everything that an effect may change, for signatures() of new effects.
  void complete(Linearised& at);
  /// Derivatives of whitened positions by changes of the model at `at`: one matrix per trial, the columns of
  /// which belong to `changed` (differences from `at` over `steps`).
  Eigen::MatrixXd signatures(const Linearised& at, std::size_t trial, const std::vector<Parameters>& changed,
                             const std::vector<double>& steps);

  struct FitOptions {
    /// Of what answers itself: at the end, by differences of whole predictions.
    bool whole = true;
    int iterations = 6;
    double tolerance = 0.02;  ///< of a step against the standard deviations
  };
  /// Gauss and Newton with bounds, from `parameters`; halved steps where they do not help. Effects'
  /// parameters are free unless they count.
  Linearised fit(Parameters parameters, const FitOptions& options,
                 const std::vector<std::vector<effects::Predicted>>* start = nullptr);

  /// Standard deviation that is not white, per body, m: added in squares to that of each mean.
  void set_slow_sd_m(const Eigen::VectorXd& sd) { slow_sd_m_ = sd; }
  const Eigen::VectorXd& slow_sd_m() const { return slow_sd_m_; }
  /// chi^2 per degree of freedom of the model as it is: priors count as much as the residuals' own spread
  /// lets them.
  void set_misfit(double misfit) { misfit_ = misfit; }
  double sd_m(std::size_t trial, std::size_t block, const effects::Seen& seen) const;
  /// What of the motion is not known, per axis, m: part of sd_m.
  double motion_sd_m(std::size_t trial, std::size_t block) const { return motion_sd_m_[trial][block]; }
  /// Whether a block is compared.
  bool uses(std::size_t trial, std::size_t block) const { return used_[trial][block]; }
  /// Counts a share of what inertia and delay do to the arm, and of what is left of that a while later, as
  /// noise: they are known to first order only. Blocks in which the arm swings are left out.
  /// @return how many are left out
  std::size_t allow_for_motion(const std::vector<std::vector<effects::Predicted>>& predicted);
  /// Whitened distance beyond which a body's weight falls, see huber_weight().
  double threshold() const { return threshold_; }

 private:
  effects::ExtendedModel::Varied vary(std::size_t trial, const Parameters& parameters,
                                      const std::vector<effects::Predicted>& predicted);
  void differentiate(const Parameters& at, std::size_t trial, const std::vector<bool>& wanted,
                     std::vector<effects::Predicted>& predicted);
  Eigen::MatrixXd differences(const Linearised& at, std::size_t trial, const std::vector<Parameters>& changed,
                              const std::vector<double>& steps);
  Eigen::VectorXd signature(const Linearised& at, std::size_t trial,
                            const effects::ExtendedModel::Varied& varied, double step) const;
  double cost(const Parameters& parameters, const std::vector<std::vector<effects::Predicted>>& predicted,
              const std::vector<Column>& columns) const;
  Eigen::VectorXd residual(std::size_t trial, const std::vector<effects::Predicted>& predicted) const;
  void set_threshold(const std::vector<std::vector<effects::Predicted>>& predicted);

  const Arm arm_;
  const std::vector<effects::Present> known_;
  const std::vector<effects::TrialData>& trials_;
  const unsigned jobs_;
  std::vector<identify::ConstantRef> constants_;
  std::vector<effects::ExtendedModel> models_;  ///< per trial
  Eigen::VectorXd slow_sd_m_;
  std::vector<std::vector<bool>> used_;
  std::vector<std::vector<double>> motion_sd_m_;
  double misfit_ = 1.0;
  double threshold_ = 1e9;  ///< whitened distance beyond which a body's weight falls
};

/// Sets an unknown to x scales, kept within its range.
void set_unknown(Parameters& parameters, const Column& column, double x);

/// What Huber's loss leaves of a body's whitened residual.
double huber_weight(double distance, double threshold);

}  // namespace softarm::diagnose
