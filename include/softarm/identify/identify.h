// Trials to the constants of an arm's laws.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/constants.h"
#include "softarm/export.h"
#include "softarm/trial/trial.h"

namespace softarm::identify {

using arm::allowed_range;
using arm::ConstantKind;
using arm::ConstantRef;
using arm::ConstantRole;
using arm::constants_of;
using arm::default_free;
using arm::is_stated;
using arm::name_of;
using arm::role_of;
using arm::segments_of;
using arm::set_value;
using arm::strained_by_inputs;
using arm::unit_of;
using arm::value_of;

/// The constants whose name, or whose last parts, match one of the shell patterns ("*.moment_gain", "length",
/// "chamber_2.moment_gain", "segment_1.length").
/// @throws std::invalid_argument where a pattern matches none; the line lists the names
SOFTARM_EXPORT std::vector<ConstantRef> matching(const arm::Arm& arm,
                                                 const std::vector<std::string>& patterns);

/// Ties constants of several segments to one value each: of those of `list` that match a pattern, such as
/// "*.bending_stiffness.base", the ones of one kind and index become one constant.
/// @throws std::invalid_argument where a pattern matches none of the arm's, or none of the list's in two
/// segments
SOFTARM_EXPORT std::vector<ConstantRef> tie_constants(const arm::Arm& arm,
                                                      const std::vector<ConstantRef>& list,
                                                      const std::vector<std::string>& patterns);

/// Error as Table 2 of the semi-physical paper states it: per frame the distance between measured and
/// predicted bodies, averaged over the bodies; over all frames its mean, median, maximum and minimum. All 0
/// without frames.
struct ShapeError {
  std::size_t frames = 0;
  double mean_m = 0.0, median_m = 0.0, maximum_m = 0.0, minimum_m = 0.0;
  double length_m = 0.0;  ///< of the arm at zero input: what percent refers to

  double percent(double error_m) const { return length_m > 0.0 ? 100.0 * error_m / length_m : 0.0; }
};

/// One body of one frame in the rod's base frame, m.
struct BodyComparison {
  int body = 0;
  Eigen::Vector3d measured_p_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d predicted_p_base = Eigen::Vector3d::Zero();
};

/// One frame: the shape predicted from inputs and payload alone beside the measured one.
struct FrameComparison {
  std::size_t trial = 0;  ///< index into the trials
  double stamp_s = 0.0;
  double payload_kg = 0.0;
  arm::InputValues inputs;
  std::vector<BodyComparison> bodies;
  double error_m = 0.0;  ///< mean distance of the bodies
};

/// Which frames of a trial are compared or fitted.
struct FrameChoice {
  /// At most so many per trial, spread evenly over the inputs and the payload; 0: all.
  std::size_t frames_per_trial = 40;
  /// Only frames at rest (inputs, payload and bodies still for a while) in trials where those span most of
  /// the range of every input.
  bool prefer_static = true;
};

/// Predicts the chosen frames of each trial. Frames without known payload, base, inputs or bodies are left
/// out, as are those for which the arm has no equilibrium.
SOFTARM_EXPORT std::vector<FrameComparison> compare(const arm::Arm& arm,
                                                    const std::vector<trial::Trial>& trials,
                                                    const FrameChoice& choice = {});

SOFTARM_EXPORT ShapeError summarise(const std::vector<FrameComparison>& frames, double length_m);

/// summarise(compare(...)).
SOFTARM_EXPORT ShapeError shape_error(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                                      const FrameChoice& choice = {});

/// Trials that nothing can be identified from. what() is one line: what is wrong, and the remedy.
class SOFTARM_EXPORT IdentifyError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What is fitted, and to which frames.
struct Options {
  /// Patterns of the constants that are free, see matching(); empty: default_free(). What the arm does not
  /// state is freed by its name alone: by "saturation" or "*.per_mean_pressure", not by "segment_1.*".
  std::vector<std::string> free;
  std::vector<std::string> also_free;  ///< freed beside those
  std::vector<std::string>
      tied;  ///< patterns of those that have one value in all segments, see tie_constants()
  std::vector<std::string> held;  ///< held at the arm's value, whatever frees them

  std::vector<std::string> held_out;  ///< names of unseen trials, not fitted; empty: by held_out_share
  double held_out_share = 1.0 / 3.0;  ///< of three or more trials, at least one; 0: none
  /// 0: every n-th trial is unseen; else they are drawn with this seed.
  std::uint64_t seed = 0;
  /// All trials are fitted; beside that each trial is predicted from a fit to all the others. For few trials.
  bool leave_one_out = false;

  FrameChoice frames;
  /// Bounds the influence of a body that lies off and drops gross ones.
  bool robust = true;
  /// A constant is determined at this standard deviation or better, as a share of its scale, see Constant.
  double determined_sd = 0.25;
  /// Inputs are taken as they were recorded; false: with their sensors' noise and zeros, see InputErrors.
  bool exact_inputs = false;
  int max_iterations = 60;  ///< per pass
};

/// One free constant after the fit.
struct Constant {
  ConstantRef ref;
  std::string name, unit;
  double initial = 0.0, value = 0.0;
  /// Standard deviation from the trials alone: noise, misfit of the model and what frames of a trial share.
  /// Where the trials say nothing it is very large, but finite.
  double sd = 0.0;
  /// What a useful sd is measured by: the value's size or, near zero, the size at which it would matter.
  double scale = 0.0;
  bool determined = false;
  bool at_bound = false;  ///< the fit ran into the limit of what an arm may have, ran_to
  double ran_to = 0.0;
  /// At its limit, or anywhere, and the trials hardly mind: value is what the arm file had, to which the rest
  /// was fitted.
  bool kept = false;
  /// Constants of correlation 0.9 or more with this one; for one that is not determined, those that share
  /// its undetermined combination. Correlation -1 ... 1.
  std::vector<std::pair<std::string, double>> confused_with;
  std::string advice;  ///< what the trials lack; empty if determined
};

/// A direction in which the constants can move together without the trials contradicting.
struct Combination {
  double relative_sd = 0.0;                           ///< of the scaled direction of unit norm
  std::vector<std::pair<std::string, double>> parts;  ///< shares (of each constant's scale), largest first
  std::string sentence;
};

/// How a trial found one element of a wall, see arm::Wall: what it had beyond the laws' value at the inputs
/// of the trial's first frame.
struct WallStart {
  std::string trial, segment;
  std::string element;  ///< "bending_1.x", "bending_1.y", "axial_1"
  std::string unit;     ///< "1/m" or "m"
  double value = 0.0, sd = 0.0;
};

/// How a trial found what an effect of the arm file remembers; 0 is at rest.
struct EffectStart {
  std::string trial, effect;
  std::string of;    ///< a segment and axis, an input, a tendon
  std::string unit;  ///< SI; "1": a share
  double value = 0.0, sd = 0.0;
};

/// The zero of one sensor in one trial, fitted beside the constants.
struct FittedZero {
  std::string trial;
  double value = 0.0, sd = 0.0;  ///< what the sensor shows too much, in SI as ScalarInput::zero_si
};

/// What one sensor is off by, and what that does to the bodies.
struct InputErrors {
  std::string input;
  std::string unit;          ///< SI: Pa, N, rad
  double noise_sd = 0.0;     ///< of one value; over the trials, rms
  bool stated = false;       ///< by the arm file; else measured from the recordings
  double at_bodies_m = 0.0;  ///< what the noise makes of predicted bodies, rms per coordinate
  double zero_sd = 0.0;      ///< stated; 0: the zero is taken to be right
  std::vector<FittedZero> zeros;
  /// Free constants that do what the zero does (of direction cosine 0.9 or more): it cannot be told from
  /// them.
  std::vector<std::string> confused_with;
};

struct TrialSummary {
  std::string name;
  bool held_out = false;
  std::size_t frames = 0;  ///< chosen
  ShapeError before, after;
};

struct Result {
  arm::Arm arm;  ///< the given arm with identified constants and prior; undetermined ones keep to their start
  std::vector<Constant> constants;
  Eigen::MatrixXd correlation;  ///< of the constants, in their order
  Eigen::MatrixXd covariance;   ///< in the units of the constants; see Constant::sd
  std::vector<Combination> undetermined;

  ShapeError fitted_before, fitted;      ///< on the trials that were fitted
  ShapeError held_out_before, held_out;  ///< on unseen ones; no frames where there are none
  std::vector<TrialSummary> trials;
  std::vector<WallStart> starts;  ///< of the trials that were fitted; empty where no segment has a Wall
  std::vector<EffectStart> effect_starts;  ///< of the same, where the arm file's effects have a memory
  /// With Options::leave_one_out each trial by the fit to the others, and all of them together.
  std::vector<TrialSummary> left_out_one;
  ShapeError left_out_one_before, left_out_one_after;

  arm::LawPrior prior;
  double misfit = 0.0;                    ///< sqrt(chi^2 / dof): rms residual over the stated noise
  double position_rms_m = 0.0;            ///< per coordinate, of the fitted bodies
  double autocorrelation = 1.0;           ///< number of consecutive fitted frames that are worth one
  std::vector<InputErrors> input_errors;  ///< of inputs that move a body and are off by something
  /// Inputs whose noise is neither stated nor measurable, as their values mostly repeat or are too few: taken
  /// as exact.
  std::vector<std::string> unmeasured_inputs;
  double noise_share = 0.0;  ///< of the mean square of position_rms_m: what noise of the inputs explains
  double uncertainty_factor = 1.0;                        ///< typical sd over that of noise alone
  std::size_t frames = 0, bodies = 0;                     ///< fitted
  std::map<std::string, std::uint64_t> left_out;          ///< frames not used, by reason
  std::map<std::string, std::uint64_t> bodies_set_aside;  ///< observations dropped as outliers, by body
  /// Observations as far off as an outlier, but so many of the body's (more than a tenth) that the model is
  /// wrong there, not the frames: they are kept. By body.
  std::map<std::string, std::uint64_t> beyond_the_model;
  /// Before all else: recordings and arm file do not belong together, and how they might; empty: they do.
  std::string apart;
  /// Before the constants, a line each: another reading is better; the fit is no better than the arm file,
  /// whose constants `arm` then has.
  std::vector<std::string> warnings;
  std::vector<std::string> prior_notes;  ///< what of the prior is not from the trials, and why; one line each
  int iterations = 0;
  bool converged = false;
};

/// Called with the share of the work that is done, 0 ... 1.
using ProgressCallback = std::function<void(double)>;

/// Fits the free constants to the trials that do not stay unseen.
///
/// 1. Choose frames: payload, inputs, base and bodies known; at rest where there are such; spread over inputs
///    and payload. The shape of each follows from the laws and the rod's statics, nothing else.
/// 2. Levenberg-Marquardt (Ceres) on all frames together, scaled, within allowed_range(); residuals by the
///    stated noise; derivatives of the rod and of the laws analytic.
/// 3. Huber's loss by body at 3.5 times the misfit; bodies beyond 6 times it are dropped, and the fit
///    repeated. The misfit is that of all bodies, of 85 % of the body's own and of its trial, whichever is
///    largest: what is off in many frames is the model. A stiffness that runs into its limit, or that the
///    trials do not tell, is put back to its start, unless that makes the fit clearly worse, and the rest
///    fitted again.
/// 4. Covariance (J^T W J)^-1 without the weak prior that holds what the trials do not determine, widened by
/// the
///    misfit, by the autocorrelation of residuals, and by the spread of the trials' own gradients (clustered
///    sandwich, shrunk towards the former): never narrower than noise alone.
/// 5. Small eigenvalues of the scaled information name the combinations that are not determined.
/// 6. Errors on unseen trials before and after; the laws' remaining errors, lasting and passing, as prior.
/// @throws IdentifyError without usable frames; the message counts why they were left out
/// @throws std::invalid_argument for patterns or trial names that match nothing
SOFTARM_EXPORT Result identify(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                               const Options& options = {}, const ProgressCallback& progress = {});

/// Whether the new constants are better on unseen trials, or as good there as noise lets them be; absent
/// where there are none.
SOFTARM_EXPORT std::optional<bool> generalises(const Result& result);
/// That in one line, with the mean errors before and after.
SOFTARM_EXPORT std::string verdict(const Result& result);
/// Tables for people: constants, correlations, errors, what was left out.
SOFTARM_EXPORT std::string describe(const Result& result);
/// The same for programs, JSON.
SOFTARM_EXPORT std::string to_json(const Result& result);

}  // namespace softarm::identify
