// All trials under one set of constants and effects: residuals, derivatives, the fit.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delay.h"
#include "model/extended_model.h"
#include "softarm/identify/identify.h"

namespace softarm::diagnose {

/// What is fitted: the arm's constants, its viscoelastic lag, and the effects in the model.
struct JointParameters {
  Eigen::VectorXd constants;  ///< of JointModel::constants
  double viscoelastic_lag_s = 0.0;
  /// By which each body's marker cluster is mounted askew, rad: rotation about x and y of its section, one
  /// column per body.
  Eigen::Matrix2Xd mounts;
  std::vector<model::Present> effects;
};

/// One column of the fit.
struct JointUnknown {
  enum class Kind { kConstant, kViscoelasticLag, kMount, kEffect } kind = Kind::kConstant;
  int index = 0;       ///< of the constant, the body, or the effect
  int parameter = 0;   ///< of the effect; the axis of a mount
  double scale = 1.0;  ///< the unknowns are values over scales
  double low = 0.0, high = 0.0;
  double start = 0.0, prior_sd = 0.0;  ///< in scales, about start
};

/// Sums over a short stretch of one trial, of whitened residuals r and derivatives J. Stretches are taken for
/// independent of each other.
struct TimeStretch {
  std::size_t trial = 0;
  Eigen::MatrixXd information;    ///< J^T J
  Eigen::VectorXd gradient;       ///< J^T r
  double square = 0.0;            ///< r^T r
  int rows = 0;                   ///< that count
  Eigen::Index all_rows = 0;      ///< of the trial's vectors that belong to it: of bodies
  Eigen::Index tangent_rows = 0;  ///< and of tangents
};

/// The model at one set of parameters, with derivatives.
struct Linearised {
  JointParameters at;
  std::vector<JointUnknown> columns;
  std::vector<std::vector<model::Predicted>> predicted;    ///< by trial
  std::vector<model::ExtendedModel::Varied> reference;     ///< by trial
  std::vector<std::optional<model::SwingOfChange>> swing;  ///< by trial; nothing: it follows its equilibria
  /// Whitened, used bodies of all blocks one after the other, then the tangents of all blocks; per trial. 0
  /// where not used.
  std::vector<Eigen::VectorXd> residual;
  std::vector<Eigen::MatrixXd> derivative;
  std::vector<Eigen::VectorXd> root_weight;  ///< Huber's, by row; both of the above are times it
  std::vector<TimeStretch> stretches;
  Eigen::MatrixXd information;  ///< sum of the stretches, with the prior
  Eigen::VectorXd gradient;     ///< the same
  double square = 0.0;
  int rows = 0;
  /// Predicted::by_rod was made here by all of the rod's parameters; else by those of the columns, or nearby.
  bool complete = false;
  /// Of a fit: that no step of a size that matters is left.
  bool converged = false;
  bool given_up = false;  ///< of a fit that did not converge: it came nowhere near another (most_square)
  /// Of a fit: that steps of Gauss and Newton overshot, and it ended with damped ones.
  bool damped = false;
  /// Of a fit: its derivatives are the arm's own there, whole ones where those are needed.
  bool own_derivatives = false;

  Eigen::VectorXd unknowns() const;  ///< values over scales
};

/// Where the first order expects the end of a fit.
double expected_square(const Linearised& at);

/// What of an arm's motion is not known, as shares: of what inertia, lag and swings do, and of its stiffness.
struct UnknownShares {
  double inertia, stiffness;
};

class JointModel {
 public:
  /// @param trials kept by reference
  /// @param jobs threads, 0: one per core
  /// @param held, tied patterns, see Options
  /// @param known effects that are in every prediction, at their values
  /// @throws std::invalid_argument for patterns that match nothing
  JointModel(const arm::Arm& arm, const std::vector<model::TrialData>& trials, unsigned jobs,
             const std::vector<std::string>& held = {}, const std::vector<std::string>& tied = {},
             const std::vector<model::Present>& known = {});

  const arm::Arm& arm() const { return arm_; }
  const std::vector<model::Present>& known() const { return known_; }
  /// The known effects, and these.
  std::vector<model::Present> all(const std::vector<model::Present>& fitted) const;
  const std::vector<identify::ConstantRef>& constants() const { return constants_; }
  const std::vector<model::TrialData>& trials() const { return trials_; }
  const model::FineRod& rod() const { return models_.front().rod(); }
  arm::Arm arm_with(const Eigen::VectorXd& constants) const;

  /// The arm file's constants, no effect.
  JointParameters start() const;
  double viscoelastic_lag_s() const;  ///< by the arm file
  std::vector<JointUnknown> columns(const JointParameters& parameters) const;

  /// Predictions of all trials.
  void predict(const JointParameters& parameters, const std::vector<std::vector<model::Predicted>>* start,
               std::vector<std::vector<model::Predicted>>& out);
  /// Of one trial; of different ones at once, from several threads.
  std::vector<model::Predicted> predict_trial(const JointParameters& parameters, std::size_t trial,
                                              const std::vector<model::Predicted>* start);
  unsigned jobs() const { return jobs_; }
  /// Calls work(trial) for each, several at once; the longest begin, so that none is left alone at the end.
  /// @param jobs threads, as of the constructor: its own, where it is not told
  void each_trial(const std::function<void(std::size_t)>& work) const { each_trial(jobs_, work); }
  void each_trial(unsigned jobs, const std::function<void(std::size_t)>& work) const;
  enum class Derivatives {
    kShapesHeld,  ///< to first order: changes of the rod while shapes are held, times derivatives by the rod
    kWhole,       ///< differences of whole predictions
  };
  /// @param start shapes to begin from
  /// @param known that `start` are the predictions at `parameters`
  /// @param near with derivatives by all of the rod that the columns change, or whole ones of the same
  /// columns: good enough here
  Linearised linearise(const JointParameters& parameters,
                       const std::vector<std::vector<model::Predicted>>* start,
                       Derivatives how = Derivatives::kShapesHeld, bool known = false,
                       const Linearised* near = nullptr);
  /// Whether an effect answers to the shape that it causes, or to those before, in a way that the first order
  /// leaves out (model::Effect::needs_whole_derivatives): it may be wrong by several times. It finds the way;
  /// intervals want the truth.
  bool needs_whole_derivatives(const JointParameters& parameters) const;
  /// Derivatives by everything that an effect may change, for signatures() of new effects.
  void complete(Linearised& at);
  /// Derivatives of whitened positions by changes of the model at `at`: one matrix per trial, the columns of
  /// which belong to `changed` (differences from `at` over `steps`).
  Eigen::MatrixXd signatures(const Linearised& at, std::size_t trial,
                             const std::vector<JointParameters>& changed, const std::vector<double>& steps);
  /// The same by whole predictions; of different trials at once, from several threads.
  Eigen::MatrixXd differences(const Linearised& at, std::size_t trial,
                              const std::vector<JointParameters>& changed, const std::vector<double>& steps);

  struct FitOptions {
    /// Where needs_whole_derivatives(): at the end, by differences of whole predictions.
    bool whole = true;
    Derivatives derivatives = Derivatives::kShapesHeld;  ///< by which the way there is found
    int iterations = 12;     ///< at most, each one prediction of all trials or few
    double tolerance = 0.1;  ///< of the step that is left, in standard deviations
    /// A linearisation nearby, the derivatives by the rod of which will do, and of a model with an effect
    /// more or less those by constants: nullptr: they are made anew. Most of the time of a fit is theirs.
    const Linearised* near = nullptr;
    bool known = false;  ///< that `start` are the predictions at `parameters`
    /// The fit at `parameters`, if its derivatives are its own: they are not made again. nullptr: another.
    const Linearised* begins = nullptr;
    /// A fit with the first of the effects, from which `parameters` were expected to first order: of the way
    /// there only so much is gone (half, a quarter, ...) that it helps. nullptr: all of it.
    const Linearised* from = nullptr;
    bool damped = false;  ///< it goes on from a fit that was
    /// After two steps, the fit is given up where even the end that the first order expects of it has a
    /// larger square.
    double most_square = std::numeric_limits<double>::infinity();
  };
  /// The constants and effects at which all trials are met best, from `parameters`: a problem of Ceres with
  /// Huber's loss on each body, the columns' priors and bounds. Effects' parameters are free unless they
  /// count or are held. Linearised::converged says whether it came to an end.
  Linearised fit(JointParameters parameters, const FitOptions& options,
                 const std::vector<std::vector<model::Predicted>>* start = nullptr);

  /// Makes a fit's derivatives the arm's own there, whole ones where those are needed.
  /// @param by_all complete ones: where signatures() are wanted of it, they cost less so than afterwards
  void take_own_derivatives(Linearised& at, bool by_all = false);

  /// A fit without some trials, from parameters that are near; of these nothing is predicted.
  /// @param without by trial
  /// @param all the fit of all, whose derivatives by the rod will do
  Linearised fit_without(JointParameters parameters, const std::vector<bool>& without, const Linearised& all);
  /// For each trial its input sequence (sequences.h).
  const std::vector<std::size_t>& sequences() const { return sequences_; }
  /// For each trial, which ones it is predicted without where it counts as unseen (unseen.h).
  const std::vector<std::vector<bool>>& predicted_without() const { return predicted_without_; }
  /// Of bodies and, below, tangents, whitened; 0 where not used, or without an equilibrium.
  Eigen::VectorXd residual(std::size_t trial, const std::vector<model::Predicted>& predicted) const;

  /// chi^2 per degree of freedom of the model as it is: priors count as much as the residuals' own spread
  /// lets them.
  void set_misfit(double misfit) { misfit_ = misfit; }
  [[nodiscard]] double misfit() const { return misfit_; }
  double sd_m(std::size_t trial, std::size_t block, const model::Seen& seen) const;
  double sd_rad(std::size_t trial, std::size_t block, const model::SeenTangent& seen) const;
  /// What of the motion is not known, per axis, m: part of sd_m.
  double motion_sd_m(std::size_t trial, std::size_t block) const { return motion_sd_m_[trial][block]; }
  /// Whether a block is compared.
  bool uses(std::size_t trial, std::size_t block) const { return used_[trial][block]; }
  /// With clocks apart the inputs of one end of each trial were not recorded: what was seen then is not
  /// compared from here on.
  /// @return how many blocks that are
  std::size_t leave_out_ends(const Delay& delay);
  /// Fits and predictions are from here on of these trials alone; of none: of all again.
  void look_at(const std::vector<std::size_t>& trials);
  /// From here on the arm swings, in the modes that it has at these parameters; without, inertia counts to
  /// first order.
  void find_modes(const JointParameters& parameters,
                  const std::vector<std::vector<model::Predicted>>& predicted);
  /// Finds the modes, whether the arm moves in them or as the equilibria do, and how it swings after a hand
  /// let go. What of the motion is not known counts as noise; blocks in which that is too much are left out.
  /// @param predicted at the parameters; as the arm swings when this is over
  /// @param alike where nothing was seen: a model of the same arm, which moves as it does there
  /// @return how many are left out
  std::size_t allow_for_motion(const JointParameters& parameters,
                               std::vector<std::vector<model::Predicted>>& predicted,
                               const JointModel* alike = nullptr);
  const UnknownShares& unknown() const { return unknown_; }
  /// That the arm swings in its modes; else inertia counts to first order.
  bool swings() const { return !modes_.empty(); }
  /// Share of what inertia does that is not known, the same at all instants; 0 where it counts to first
  /// order.
  double unknown_inertia() const { return swings() ? unknown_.inertia : 0.0; }
  /// That the trials have no inertia, as computations of statics have none: then the model has none either.
  bool quasi_static() const { return quasi_static_; }
  /// Whitened distance beyond which a body's weight falls, see huber_weight().
  double threshold() const { return threshold_; }

 private:
  /// What askew mounts make of predicted tangents.
  void mount(const JointParameters& parameters, std::size_t trial,
             std::vector<model::Predicted>& predicted) const;
  Eigen::Vector3d by_mount(const JointParameters& parameters, const Eigen::Quaterniond& q_section,
                           int body) const;
  double chi2(const std::vector<std::vector<model::Predicted>>& predicted, double& rows) const;
  bool is_quasi_static(const JointParameters& parameters,
                       const std::vector<std::vector<model::Predicted>>& swinging);
  std::vector<double> inertial_m(std::size_t trial, const std::vector<model::Predicted>& predicted) const;
  double unlikeliness(const std::vector<std::vector<model::Predicted>>& predicted) const;
  void choose_motion(const JointParameters& parameters,
                     std::vector<std::vector<model::Predicted>>& predicted);
  void move_alike(const JointModel& other, const JointParameters& parameters,
                  std::vector<std::vector<model::Predicted>>& predicted);
  bool looks_at(std::size_t trial) const { return looked_at_.empty() || looked_at_[trial]; }
  const model::Modes* modes_at(std::size_t trial, std::size_t block) const;
  void find_swings(std::size_t trial, const std::vector<model::Predicted>& predicted, bool seen);
  void add_swings(std::size_t trial, std::vector<model::Predicted>& predicted) const;
  model::Dynamics dynamics(const JointParameters& parameters, std::size_t trial) const;
  /// Whether the same drives the arm.
  bool driven_alike(const JointParameters& a, const JointParameters& b) const;
  /// @param at of which the predictions are
  model::ExtendedModel::Varied vary(std::size_t trial, const JointParameters& parameters,
                                    const JointParameters& at,
                                    const std::vector<model::Predicted>& predicted);
  /// At these parameters, of which the predictions are given.
  /// @param by_all to be complete; without any nearby
  Linearised linearise_at(const JointParameters& parameters,
                          std::vector<std::vector<model::Predicted>> predicted, Derivatives how,
                          const Linearised* near, bool by_all = false);
  /// Where the arm swings in its modes.
  model::SwingOfChange swing_of_change(std::size_t trial,
                                       const std::vector<model::Predicted>& predicted) const;
  void differentiate(const JointParameters& at, std::size_t trial, const std::vector<bool>& wanted,
                     std::vector<model::Predicted>& predicted);
  /// Takes the derivatives by the rod of a linearisation nearby.
  /// @return whether it has them all
  bool share_derivatives(const Linearised& near, std::size_t trial,
                         std::vector<model::Predicted>& predicted) const;
  std::vector<Eigen::MatrixXd> moved(const Linearised& at, std::size_t trial,
                                     const std::vector<model::ExtendedModel::Varied>& varied) const;
  Eigen::VectorXd signature(const Linearised& at, std::size_t trial, const JointParameters& changed,
                            const model::ExtendedModel::Varied& varied, const Eigen::MatrixXd& moves,
                            double step) const;
  void add_to(TimeStretch& stretch, const Linearised& at, Eigen::Index first, Eigen::Index rows,
              int degrees_of_freedom) const;
  class Evaluation;  ///< of the problem of fit()
  class WholeCost;
  bool minimise(Evaluation& evaluation, const FitOptions& how, double& radius, int& iterations);
  /// Huber's weights by the present threshold, and all sums.
  void weigh(Linearised& at) const;
  std::vector<TimeStretch> stretches_of(const Linearised& at, std::size_t trial) const;
  double threshold_at(const std::vector<std::vector<model::Predicted>>& predicted) const;
  /// Of a body without an equilibrium, in thresholds of Huber's loss: a cost of ten of their squares.
  static constexpr double kUnsolved = 5.5;
  double loss(std::size_t trial, const std::vector<model::Predicted>& predicted, double threshold) const;
  double loss(const std::vector<std::vector<model::Predicted>>& predicted, double threshold) const;
  bool predict_within(const JointParameters& parameters,
                      const std::vector<std::vector<model::Predicted>>& start, double threshold, double most,
                      std::vector<std::vector<model::Predicted>>& out);
  bool go_as_far_as_it_helps(const Linearised& from, JointParameters& parameters,
                             std::vector<std::vector<model::Predicted>>& predicted);

  const arm::Arm arm_;
  const std::vector<model::Present> known_;
  const std::vector<model::TrialData>& trials_;
  const unsigned jobs_;
  const std::vector<std::size_t> sequences_;
  const std::vector<std::vector<bool>> predicted_without_;
  std::vector<identify::ConstantRef> constants_;
  std::vector<model::ExtendedModel> models_;  ///< per trial
  std::vector<model::TrialModes> modes_;      ///< per trial; empty: not known yet
  /// By trial and block: of bodies and, below, of tangents, what a hand left; empty: nothing.
  std::vector<std::vector<Eigen::VectorXd>> swings_;
  std::vector<bool> turned_;  ///< bodies whose tangents are seen
  std::vector<std::vector<bool>> used_;
  std::vector<bool> looked_at_;              ///< empty: all trials
  std::vector<std::vector<bool>> all_used_;  ///< while some trials are not looked at
  std::vector<std::vector<double>> motion_sd_m_;
  bool quasi_static_ = false;
  UnknownShares unknown_;  ///< at first those of an arm with modes
  double misfit_ = 1.0;
  double threshold_ = 1e9;  ///< whitened distance beyond which a body's weight falls
};

double value_of(const JointParameters& parameters, const JointUnknown& column);
/// Sets an unknown to x scales, kept within its range.
void set_unknown(JointParameters& parameters, const JointUnknown& column, double x);

/// What Huber's loss leaves of a body's whitened residual.
double huber_weight(double distance, double threshold);

/// From which on it leaves less: over the typical one of these distances, which noise alone has at least.
double huber_threshold(std::vector<double> distances);

}  // namespace softarm::diagnose
