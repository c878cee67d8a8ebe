// Trials and an arm's description to what the description leaves out.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/arm_file.h"
#include "softarm/export.h"
#include "softarm/identify/identify.h"
#include "softarm/model/present.h"

namespace softarm::diagnose {

enum class Verdict {
  kConsistent,       ///< nothing beyond the noise, or too small to matter
  kExplained,        ///< named effects explain at least 0.9 of what could be explained, and the rest is noise
  kPartlyExplained,  ///< named effects explain half of it or more
  kUnknown,          ///< something is there that no effect of the catalogue explains
  kCannotTell,  ///< these trials cannot tell: what is there is collinear with the arm's own constants, or
                ///< is explained by what is probably not there
};

/// "consistent", "explained", "partly_explained", "unknown", "cannot_tell".
SOFTARM_EXPORT std::string to_string(Verdict verdict);

/// A number of a named effect with its 90 % interval.
struct EffectValue {
  std::string symbol, unit, description;
  double value = 0.0, low = 0.0, high = 0.0;
  bool fitted = true;  ///< else it was held in the fit, and has no interval
};

/// Where something is; what is not known is absent or empty.
struct Where {
  std::optional<double> s_from_m, s_to_m;  ///< arclength from the base, at zero input
  std::string axis;                        ///< "in_plane", "out_of_plane", "axial", "twist"
  std::string when;                        ///< "always", "from 12.3 s on in trial_3", "during holds", ...
  std::string input;  ///< what it goes with: "chamber_2", "payload", "vacuum", "speed of the pressures", ...
};

/// An effect that the verdict stands on.
struct NamedEffect {
  std::string id;           ///< of the catalogue
  std::string description;  ///< what it is, for a user
  std::string law, source;  ///< as an equation, and where that is from; may be empty
  double probability = 0.0;
  std::vector<EffectValue> parameters;
  Where where;
  double held_out_gain_m = 0.0;  ///< by which it lowers the rms error on unseen trials
  double share = 0.0;            ///< of the squares of those errors that all effects together explain
  std::vector<std::string> confusable_with;
  std::string sentence;  ///< where, what, how large, how sure
};

/// What became of an effect of the catalogue.
enum class Finding {
  kPresent,
  kAbsent,      ///< it would have been seen at a size that matters
  kTrivial,     ///< it may be there, too small to matter
  kCannotTell,  ///< collinear with the constants, or not excited by these trials
  kRival,       ///< would explain the same as an effect that ranks before it
  kNotOfThisArm,
};
SOFTARM_EXPORT std::string to_string(Finding finding);

/// One candidate of the catalogue, after the screen and, for the best, the refit.
struct Candidate {
  std::string id, description;
  Finding finding = Finding::kAbsent;
  double probability = 0.0;
  double collinearity = 0.0;         ///< share of its signature that the arm's own constants absorb, 0 ... 1
  bool detectable = true;            ///< a usual size would be seen in these trials
  bool possible = true;              ///< the size that fits best is one that an arm can have
  double z = 0.0;                    ///< of the score test, in standard deviations
  double size_m = 0.0;               ///< rms change of the bodies' positions that the screen ascribes to it
  double smallest_detectable = 0.0;  ///< in `symbol`'s unit
  std::string symbol, unit;          ///< of the parameter that says how large it is
  double estimate = 0.0;             ///< of that parameter, by the screen or the refit
  std::optional<double> log_score;   ///< gain per frame on unseen trials; absent where it was not refitted
};

/// How well a model fits.
struct Fit {
  double rms_m = 0.0;           ///< per body, of the trials that were fitted, weighted by precision
  double held_out_rms_m = 0.0;  ///< of each trial by a fit to the others, weighted by precision
  /// The same trials' plain errors, every body's distance counted alike.
  double held_out_mean_m = 0.0, held_out_max_m = 0.0;
  double held_out_log_score = 0.0;
  double plain_rms_m = 0.0, held_out_plain_rms_m = 0.0;
};

/// A constant of the arm (or what the estimator would say) with the baseline and with the effects in the
/// model.
struct Shift {
  std::string name, unit;
  double before = 0.0, sd_before = 0.0;
  double after = 0.0, sd_after = 0.0;
};

/// What arm_extended.yaml holds.
struct ExtendedArm {
  arm::Arm arm;  ///< with the constants fitted together with the effects
  std::vector<arm::EffectEntry> effects;
};

/// What is left of the residuals.
struct Structure {
  double whiteness_p = 1.0;                  ///< of residuals in time
  double along_s_p = 1.0;                    ///< of their runs along the arm
  double chi2_per_dof = 1.0;                 ///< against the noise
  std::map<std::string, double> by_input_p;  ///< dependence on each input, on speed, payload, time, attitude
  Where where;
  /// Rms error that neighbouring bodies share while the arm is calm, m, and its mean over its standard error:
  /// noise of single bodies makes none.
  double shared_m = 0.0, shared_z = 0.0;
};

/// An experiment of the menu, weighed against the others.
struct WeighedExperiment {
  std::string action;
  double separation = 0.0;           ///< as NextExperiment::expected_separation, were this one done
  std::vector<std::string> hardest;  ///< the two that it would separate worst
  std::vector<std::string> shows;    ///< effects that it would bring to light where there are no rivals
};

/// What to record next: of a menu what separates rivals best, or brings most collinear effects to light.
struct NextExperiment {
  std::string action;  ///< in a sentence
  std::vector<std::string> separates;
  /// In standard deviations: of the two that it separates worst once all constants are fitted anew to old
  /// and new trials; or of the least of the effects that it brings to light.
  double expected_separation = 0.0;
  double today = 0.0;                        ///< the same of the trials that there are
  std::string sentence = {};                 ///< what it would do, after the action
  std::vector<WeighedExperiment> menu = {};  ///< best first
};

/// A term of a law that was learnt: a moment of the section, in proportion to what it goes with.
struct LawTerm {
  std::string goes_with;        ///< "chamber_2 less what follows it in 1 s", "the payload"
  std::string law;              ///< as an equation: "M = (-2.43, 6.18) mN m u^2 / (1499 kPa^2)"
  std::string symbols;          ///< what its letters are: "u: chamber_2"
  std::string source;           ///< where equations of that form are from
  std::string unit;             ///< SI, of that
  double from = 0.0, to = 0.0;  ///< of that, where it was learnt; beyond, the moment fades
  /// At the end of that range that is farther from 0: towards x and y, or along and across what has a
  /// direction.
  EffectValue x_nm, y_nm;
  bool has_direction = false;  ///< what it goes with
  bool rises = false;          ///< from minus that at the base to that at the tip; else the same all along
  double stability = 0.0;      ///< share of the resamples of the trials that chose it, or what stands for it
  std::string sentence;
};

/// A law of what no effect of the catalogue explains: no name, and no part of the verdict.
struct DiscoveredLaw {
  std::vector<LawTerm> terms;
  /// Plain errors of trials that true refits without and with a law have not seen, no trial with its input
  /// sequence, all bodies' distances counted alike; terms chosen anew from each refit's own trials.
  double held_out_mean_before_m = 0.0, held_out_mean_after_m = 0.0;
  double held_out_max_before_m = 0.0, held_out_max_after_m = 0.0;
  double share = 0.0;  ///< of the squared error of those beyond the noise, that is gone
  /// That over what a flexible model learns of it; absent where it learns nothing.
  std::optional<double> share_of_flexible;
  std::size_t sequences = 0;  ///< of inputs
  std::string resembles;      ///< id of the effect whose signature is most like it; empty: none is
  double cosine = 0.0;        ///< with that
  std::string sentence;       ///< all of it
  std::string source;         ///< where the way to find it is from
};

// --- For the pictures ------------------------------------------------------------------------------------

/// One instant as a picture: base frame, m.
struct Snapshot {
  std::string trial, description;  ///< "largest error before", "typical"; of a film: empty
  double t_s = 0.0;
  std::vector<Eigen::Vector3d> measured, backbone_before, backbone_after;
  std::vector<Eigen::Vector3d> bodies_before, bodies_after;  ///< where the model has those that were seen
};

/// Residuals of one trial, thinned. Vectors of one length: instants.
struct TrialCurves {
  std::string name;
  std::size_t frames = 0;                        ///< of the recording that were used
  double rms_before_m = 0.0, rms_after_m = 0.0;  ///< predicted from the other trials, by precision
  /// The same predictions' plain errors, every body's distance counted alike.
  double mean_before_m = 0.0, mean_after_m = 0.0, max_before_m = 0.0, max_after_m = 0.0;
  std::vector<double> t_s;
  std::map<std::string, std::vector<double>> inputs;  ///< Pa, N, rad, kg by name
  /// Distance, measured to modelled, by body, m; NaN-free: absent where the body was not seen.
  std::map<std::string, std::vector<std::optional<double>>> before_m, after_m;
  /// The body that is farthest along the arm, base frame, m: as it was seen, and predicted from the other
  /// trials.
  std::vector<std::optional<Eigen::Vector3d>> tip_measured_m, tip_before_m, tip_after_m;
  std::vector<Snapshot> film;  ///< of the whole trial, fewer instants
};

/// Mean residual by body over all trials, in the section frame of the arm: across the arm in the plane of its
/// bending, across that plane, along the arm. m.
struct AlongArm {
  std::vector<std::string> bodies;
  std::vector<double> s_m;
  std::vector<Eigen::Vector3d> before_m, after_m;  ///< root mean squares
  std::vector<Eigen::Vector3d> mean_before_m, mean_after_m;
};

/// One rung of the pooling ladder: the same trials under models with fewer and fewer free numbers.
struct Rung {
  std::string id, description;
  int unknowns = 0;
  double rms_m = 0.0;  ///< per body, as if no unknown had been fitted: the noise floor where chance is all
  double chi2_per_dof = 1.0;  ///< against the noise and what is not known of the motion: 1 where that is all
};

/// A parameter of the per-frame fits (EI, M0, phi, L) against something it ought not to depend on, or depends
/// on more than the arm's laws say.
struct ParameterVariation {
  std::string parameter, unit, against, against_unit;
  std::vector<double> x, value, law;  ///< law: what the arm's laws say there
  double p = 1.0;                     ///< of no dependence beyond the laws
  std::string sentence = {};          ///< by how much, from where to where; empty where none is seen
};

/// Rings that have one another's names in the recordings.
struct ExchangedNames {
  std::vector<std::string> said, seen;      ///< from base to tip: by the arm file, and in the recordings
  std::vector<std::string> trials;          ///< in which they are
  double as_said_m = 0.0, as_seen_m = 0.0;  ///< by which distances of neighbours are off in either order
};

/// A trial in which something else hung than was told, in all of it or a part; the interval holds it with
/// 90 %. Of payloads that were exchanged it is what the other was told, just that.
struct ToldPayload {
  std::string trial;
  std::optional<double> from_s, to_s;  ///< since the trial's first frame; absent: its ends
  double told_kg = 0.0, found_kg = 0.0, low_kg = 0.0, high_kg = 0.0;
};

/// Payloads that the recordings contradict. Everything else is said under those that were found.
struct ToldPayloads {
  std::vector<ToldPayload> trials;
  double as_told_mean_m = 0.0, mean_m = 0.0;  ///< plain error on unseen trials, with what else was found
  double probability = 1.0;  ///< that others hung there, and do not stand in for something else that is left
};

struct Diagnosis {
  std::string arm, version;
  /// For the page, by the program: what arm_extended.yaml says, and how to go on with it; may be empty.
  std::string extended_text, next_command;
  Verdict verdict = Verdict::kCannotTell;
  std::string summary;           ///< the verdict in one or two sentences
  double noise_floor_m = 0.0;    ///< rms distance of a body that noise alone makes
  double ceiling_rms_m = 0.0;    ///< rms on unseen trials that a flexible model of the residuals reaches
  double explained_share = 0.0;  ///< of what lies between baseline and ceiling, by the named effects
  /// Of the squared error on unseen trials with the effects: what a flexible model of it still learns, so
  /// what is neither named nor noise.
  double discrepancy_share = 0.0;
  double left_out_share = 0.0;                    ///< of the recordings' means that no model is compared with
  std::optional<ExchangedNames> exchanged_names;  ///< then no effects were looked for
  std::optional<ToldPayloads> told_payloads;      ///< others were found
  /// That trials are predicted better with a constant beyond its range in the arm file, as the summary says.
  bool narrow_range = false;
  Fit baseline, extended;
  std::vector<NamedEffect> effects;  ///< what the verdict stands on, in the order of what they explain
  /// What every arm has: bodies and base within placement_sd of where they should be, and what explains
  /// little beside the others.
  std::vector<NamedEffect> small_departures;
  /// In the model, because unseen trials are predicted better with them, though hardly there: they stand in
  /// for what is left, or for one another.
  std::vector<NamedEffect> stand_ins;
  std::vector<Candidate> ranking;  ///< every candidate, best first
  std::optional<DiscoveredLaw> discovered_law;
  Structure before, after;
  std::vector<Shift> shifts;
  ExtendedArm extended_arm;
  std::optional<NextExperiment> next_experiment;
  std::vector<std::string> notes;  ///< what was left out of the data and why, and other remarks
  std::vector<TrialCurves> trials;
  std::map<std::string, std::string> input_units;  ///< "Pa", "N", "rad", "kg" by name of an input
  AlongArm along;
  std::vector<Snapshot> snapshots;
  std::vector<Rung> ladder;     ///< from fits of single instants to one arm
  std::string ladder_sentence;  ///< on which rung the mismatch shows
  std::vector<ParameterVariation> parameter_variation;
};

struct Options {
  double block_s = 0.2;  ///< over which frames are averaged: half of it where a body's way bends,
                         ///< up to three times where the arm rests
  int most_effects = 8;  ///< in one verdict; more than 4 only where much is left, or another is certain
  int refits = 4;        ///< of the screen's best, per round
  /// Patterns of constants that keep the arm file's value, and of those that have one value in all segments,
  /// as identify::matching() and identify::tie_constants() have them.
  std::vector<std::string> held, tied;
  unsigned jobs = 0;  ///< threads; 0: one per core
  /// Effects of the arm file: in the baseline and in everything else, at their values.
  std::vector<model::Present> known;
};

/// Called with the share of the work that is done, 0 ... 1, and what is being done.
using Progress = std::function<void(double, const std::string&)>;

/// 1. Means over short times; white noise from their scatter; what a hand or a swing disturbs is left out.
/// 2. Baseline: the arm's constants (gains, stiffness and length laws), one value for all trials, and the
///    inertia of its known masses.
/// 3. Score screen of the catalogue: signatures orthogonal to all constants, sums over stretches of two
///    seconds, so that correlated residuals widen the intervals.
/// 4. The best are refitted together with the constants. A posterior over all effects at once, with a
///    background of small departures and correlated errors, says how probable each is; the most probable is
///    taken into the model where it is more probable than not, and again from 3.
/// 5. A Gaussian process over inputs, their speeds and past, payload, attitude and time says what could be
///    explained at all, before and after. Where something is left, a law of it is looked for: moments that go
///    with inputs, their past, payload, attitude or curvature.
/// 6. Verdict; a name only where no rival does as well.
/// @throws identify::IdentifyError where the trials cannot be used
/// @throws std::invalid_argument for patterns that match nothing
SOFTARM_EXPORT Diagnosis diagnose(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                                  const Options& options = {}, const Progress& progress = {});

}  // namespace softarm::diagnose
