// What the diagnosis decides by. Nothing else in this room decides: constants beside the code are tolerances
// of its numbers, sizes of tables and physics.
#pragma once

#include <cmath>
#include <cstddef>

#include "softarm/arm/arm.h"

namespace softarm::diagnose {

/// Where not said otherwise the values were chosen on simulated campaigns (config/campaigns/development.yaml
/// and proof_development.yaml), and hold for the proof's final draw (scripts/prove). Distances were chosen on
/// the arm online_200mm, 0.2 m long and seen with 0.5 mm per coordinate, and stand here as shares of that
/// length or of that noise.
struct Policy {
  /// What is taken for known beforehand, and how the fit meets bodies that lie off.
  struct Fit {
    double constant_sd = 3.0;  ///< of a constant of the arm about the file's value, in its scales
    double size_sd = 5.0;      ///< of an effect's sizes about 0, in usual sizes
    double shape_sd = 1.0;     ///< of an effect's other parameters about the screen's, in usual ones
    double most_viscoelastic_lag_s = 0.2;      ///< end of its range
    double mount_sd_rad = 0.5 * M_PI / 180.0;  ///< by which a body's marker cluster is usually mounted askew
    double most_mount_rad = 0.2;               ///< end of its range
    double roughly_sd = 1.0;                   ///< the same of a fit that only shows how to go on
    double converged_sd = 0.5;  ///< step left to a fit that is called converged, in standard deviations
    double huber = 4.0;         ///< threshold of Huber's loss over the bodies' typical distance
    double stretch_s = 2.0;     ///< residuals further apart than that count as independent
    double refit_from_start_chi2 = 10.0;  ///< chi^2 per degree of freedom: the first fit may have run away
    double same_misfit = 1.25;  ///< ratio within which two misfits are one: priors need no other weight
  } fit;

  /// Clocks that are apart by seconds, looked for before anything is fitted.
  struct Delay {
    double longest_s = 5.0, step_s = 0.1;  ///< either way, as far as an offset of clocks may be
    double greatest_rate = 0.05;           ///< as far as their rates may differ
    double seen_s = 0.35;     ///< up to which the screen, linear about no delay, finds it by itself
    double least_gain = 5.0;  ///< of the log likelihood, of a delay, and of a rate beside it: less is not
                              ///< worth a fit, which decides
    double finest = 0.1;      ///< of a step, to which the likeliest one is looked for
    long fewest_blocks = 20;  ///< of a trial, that the inputs' place in time is told by
    /// Up to which a clock that is apart and pressures that lag are one: what they differ in is of second
    /// order, and a quarter of the means over 0.2 s that are compared.
    double alike_s = 0.05;
    /// Standard deviation of a delay of the other kind that hides in a short one, of which only the sum is
    /// told: lines of a metre and drivers that stamp upon arrival.
    double hidden_sd_s = 0.02;
  } delay;

  /// What of the arm's motion is not known. On clean and untidy development cases the errors of blocks are
  /// beyond the noise by 0.05 to 0.15 of what inertia and lag do to the arm in its modes.
  struct Motion {
    double usual_swing_s = 0.8;    ///< in which a swing has fallen to 1/e, of an arm without modes
    double longest_swing_s = 5.0;  ///< the same of any arm, whatever its wall's lag says
    double share = 0.1, first_order_share = 0.3;  ///< of what inertia and lag do
    double stiffness_share = 0.005;               ///< of the stiffness
    /// Shares, and the error of a calm arm over the median, with which motions are compared: the likeliest.
    double shares[6] = {0.05, 0.1, 0.2, 0.3, 0.5, 1.0};
    double stiffness_shares[6] = {0.002, 0.005, 0.01, 0.02, 0.05, 0.1};
    double calm_errors[6] = {0.25, 0.5, 0.7, 0.85, 1.0, 1.4};
    double degrees_of_freedom = 4.0;  ///< of Student's t of the errors with which motions are compared
    double modes_gain = 1.0;  ///< of the log likelihood, from which on motion in modes is taken for the arm's
    double least_stiffness = 0.02;  ///< left of the wall's: below it nothing holds the arm
    double no_inertia_chi2 = 25.0;  ///< fall of chi^2 without any inertia, from which on trials have none
    double swing = 3.0;             ///< of the noise: beyond it what is not known is left out
    double calm = 0.1;              ///< of the noise, per axis: what is not known of the motion of a calm arm
    double calm_share = 0.25;       ///< of the time, at least, is called calm
  } motion;

  /// Which effects go into the model.
  struct Selection {
    /// Effects in the model beyond which another is looked for only where more is left than departures of
    /// every arm come to (Words::small), or what is left is certain (Posterior::certain).
    std::size_t few_effects = 4;
    /// With so many effects in the model of which probably none is there, nothing more is taken that is
    /// probably not there either: is_lost().
    std::size_t most_stand_ins = 2;
    double trivial = 1.25e-4;  ///< of the length: an effect that moves less beyond the constants is too small
    double clearly_there = 4.0;  ///< of trivial: one that moves more to first order needs no fit without it
    double least_z = 5.0;        ///< of an effect that is there, if too small to matter
    double screen_z = 3.5;       ///< of one that is worth a refit
    std::size_t always_refitted = 2;  ///< of those
    double near_best = 0.25;  ///< share of the best one's gain in the screen from which on others are too
    /// Share of the best refit's gain from which on its evidence is by derivatives of its own: by those of
    /// the model without it, it is off by a thousandth of the gain: what two that are nearly the same differ
    /// in.
    double leads = 0.5;
    /// ... and no more behind the best than this, as a log likelihood of white noise: of errors that are
    /// correlated a tenth of it is left.
    double hopeless = 500.0;
    double rival_z = 3.0;                 ///< separation below which two effects are one class
    double rival_gain = 0.5 * 3.0 * 3.0;  ///< the same as a difference of log scores on unseen trials
    double rival_cosine = 0.95;           ///< of the signatures of two effects that may be one class
    /// Of what is left beyond the noise, rms: one that explains less by no more than this may be there
    /// instead. Nobody knows what made the rest. It lies in some ten directions that trials tell apart, so a
    /// third of it favours one of two by chance, half of it now and then.
    double rival_left = 0.5;
    double rival_explains = 0.5;    ///< at least, of what the other explains, in squares
    std::size_t most_compared = 2;  ///< with an effect of the model in the end: each costs a refit
    double distinct_cosine = 0.5;   ///< of two that neither hides nor feigns the other
    double identifiable_sd = 2.0;   ///< from 0, of a size that is identifiable
    double other_optimum = 0.02;    ///< fall of chi^2 that an effect of no size brings: the constants' own
  } selection;

  /// How probable effects are.
  struct Posterior {
    double expected = 0.5;  ///< effects of the catalogue that an arm is expected to have, before the data
    /// By how much of the arm's length every effect moves the bodies beyond what constants absorb, were it
    /// the only one; each as probable as another beforehand. Up to twice what is too small to matter
    /// (Selection::trivial): what moves them further is there.
    double background[5] = {1e-5, 3e-5, 8e-5, 1.5e-4, 2.5e-4};
    /// Standard deviation of the share by which what an effect does goes otherwise than its law says: over a
    /// trial, over the order of the trials, and over what drives the arm. No size of what acts in few
    /// instants is surer than that. Rightly named effects leave three tenths of hidden ones of other forms
    /// (doc/proof.md: 0.09 of the squares, median), these are half of that. Values up to 0.35 say the same of
    /// development cases, but from 0.2 on what one effect does otherwise may pass for the next.
    double form = 0.1;
    double most_background = 0.3;  ///< of a usual size: of what constants absorb nearly all
    double certain = 0.99;  ///< probability from which on an effect may join another upon one posterior
    double named = 0.5;     ///< probability of a class from which on the best of it goes into the model
    /// Two effects are one class where the second is there instead of the first with this probability, and
    /// where the first's being there makes it so many times less likely.
    double rival = 0.1, turns = 2.0;
    /// Odds that what was found is there and no stand-in for what nothing explains: this, times what it
    /// explains and what departures of every arm come to (Words::small), over the square of what is left, all
    /// as rms distances of a body. One body that sits elsewhere and clocks that are apart have
    /// `sensors` times these odds: hardly any physics that is missing looks like them. Of 1036 statements
    /// about 733 cases in four worlds (doc/proof.md) such odds fit as well as free powers of both ratios.
    double no_stand_in = 8.0, sensors = 4.0;
    /// Factor by which a posterior's variances are usually wrong, either way, as one standard deviation of
    /// its logarithm: on real arms by tens, on simulated ones hardly. It counts where folds tell few numbers.
    double wrong_variance = 10.0;
    double least_white = 0.3;         ///< of the stated variance, at least: by more nobody overstates a noise
    std::size_t most_instants = 300;  ///< or groups of neighbouring ones: the cost goes with its square
    long fewest_instants = 20;        ///< with fewer nothing is said
    /// Of the recordings, that are weighed anew in a resample: trials, or where these are fewer equal pieces
    /// of each.
    std::size_t fewest_units = 6;
    std::size_t most_effects = 3, leaders = 5, grown_from = 2;  ///< of the search for sets, upon one fit
    double beside = 8.0;  ///< fall of the log evidence beyond which a background is not looked at
  } posterior;

  /// What is said of the whole.
  struct Verdict {
    double explained = 0.9, partly = 0.5;  ///< shares of what could be explained
    double as_noise_chi2 =
        2.0;  ///< chi^2 per degree of freedom on unseen trials, up to which residuals are noise
    double shared = 3.75e-4;      ///< of the length: what motion and trivial effects leave that bodies share
    double shared_z = 2.33;       ///< from which on that, or `lone`, is no chance: one in a hundred
    double flexible = 5e-4;       ///< of the length: what a flexible model finds beyond this is something
    double flexible_share = 0.1;  ///< ... if it is that share of what is left, or more
    double lone = 0.5;            ///< of the noise floor: what one body alone may show beyond the others
    double lone_ratio = 1.7;      ///< of that body's mean square over the bodies' median
    double detectable_z = 5.0;    ///< that an effect of usual size must have to be detectable
    double few_detectable = 0.5;  ///< share of the catalogue below which "consistent" says too much
  } verdict;

  /// Where along the arm, and when, an effect is.
  struct Place {
    double straight =
        5e-4;  ///< of the tip's distance from the base: deflection below which an arm has no plane of bending
    double goes_with = 0.5;      ///< correlation from which on an effect goes with an input
    double mostly = 0.8;         ///< share of the squares that a stretch of the arm must hold
    double on_share = 0.2;       ///< of an effect's largest size, from which on it is there
    double seldom = 0.6;         ///< share of the time below which it is not always there
    double attitude_rad = 0.05;  ///< spread of gravity's direction below which it is the mount's own noise
    double past_s = 8.0;         ///< over which an arm's past is averaged for a picture
    int fewest_blocks = 10;      ///< fewer do not say when, nor with what, an effect goes
  } place;

  /// Which trials count as unseen, and how they are predicted.
  struct Unseen {
    double session_pause_s =
        1800.0;  ///< between the beginnings of trials, from which on it is another session
    std::size_t fewest_sessions = 3;  ///< from which on a session is predicted by the others
    /// From which on a jackknife compares them: of two it says little of one number, and much of all.
    std::size_t fewest_sequences = 2;
    /// Share of chi^2 of unseen trials by which the model at first-order constants may differ from
    /// what the first order expects: more, and they are fitted anew.
    double first_order = 0.02;
  } unseen;

  /// Patterns in what is left.
  struct Structure {
    long fewest_stretches = 8;  ///< of a correlation with an input: with fewer chance makes any
  } structure;

  /// The flexible model: kernel regression of residuals on inputs, their past, payload, attitude and time.
  /// Each of its scales is tried, so these are a coarse grid over what residuals of arms are like.
  struct Flexible {
    std::size_t most_blocks = 1200;  ///< evenly over the trials: the cost goes with its cube
    std::size_t folds = 3;           ///< of input sequences: it learns from two thirds of them
    long fewest_instants = 20;       ///< with fewer it learns nothing
    double past_s[2] = {1.0, 8.0};   ///< time constants of what is remembered of the inputs
    /// Widths of what loops, as shares of an input's range, the narrow ones (`narrow` of them) first: from a
    /// valve to a wall.
    double play[4] = {0.02, 0.05, 0.15, 0.4};
    std::size_t narrow = 2;
    double reach[2] = {1.0, 2.5};        ///< length scales, in standard deviations of each feature
    double reach_alone[2] = {0.1, 0.4};  ///< the same of inputs one by one: a kink is narrow
    double noise[3] = {0.03, 0.3, 3.0};  ///< variance of the noise over that of what is learnt
  } flexible;

  /// What single instants, and their pooling, say.
  struct Instants {
    double identifiable = 0.15;         ///< relative sd of EI and M0 up to which they are worth a dot
    double identifiable_rad = 0.2;      ///< the same, of phi
    double vacuum_step_pa = 10e3;       ///< of two conditions of an arm
    double payload_step_kg = 1e-3;      ///< the same
    double stiffness_sd = 1.0;          ///< of the logarithm of EI of one condition: hardly held
    double as_noise_chi2 = 1.2;         ///< chi^2 per degree of freedom up to which one arm explains all
    double mostly = 0.8, little = 0.2;  ///< shares of what is beyond the noise
    std::size_t fewest = 40;            ///< of a parameter, for a test of its variation
    double fewest_stretches = 12.0;     ///< that are exchanged in that test
    double p = 0.01;                    ///< of a variation that is said
    double times = 2.0;                 ///< from which on a ratio is said as one
  } instants;

  /// What to record next.
  struct Experiment {
    std::size_t most_rivals = 4;      ///< told apart at once
    std::size_t most_collinear = 12;  ///< brought to light at once
    double candidate_z = 3.0;         ///< of one that may be what no effect explains
    double seen_z = 5.0;              ///< at which an effect of usual size is seen
    double useful_z = 2.0;            ///< separation that is worth an experiment ...
    double better = 1.5;              ///< ... if it is that many times today's
    double least_solved = 0.7;        ///< share of it in which the arm has an equilibrium
    double least_step = 0.2;  ///< share of a step to a rival that is tried, where the arm does not bear all
    double new_attitude_rad = 0.35;  ///< from all that were recorded
    double moved = 1e-3;             ///< share of the largest input below which an input does nothing
    double pull_bend = 0.3;          ///< force over EI / L^2: it moves the tip by a tenth of the length
    double bracket = 0.15;           ///< of the length: beside the arm
    double payload_share = 0.5;      ///< of the arm's weight, where none was ever hung on
    double payload_times = 1.5;      ///< of the heaviest that was: another one, if that is more
    double payload_heavier = 1.05;   ///< of today's: what is less is the same payload again
    double least_vacuum_pa = 1e3;    ///< of one that was ever on: sensors rest so far from ambient
    long fewest_frames = 10;         ///< of a recorded trial that is repeated
    double clock_sd_s = 0.002;       ///< of stamps of one clock
    double rest_s = 2.0, move_s = 2.0, hold_s = 20.0, after_s = 6.0;
    double jam_at_s = 5.0, jam_s = 1.0;          ///< a vacuum is applied to a bent arm, and takes so long
    double let_go_s = 9.0, jammed_wait_s = 8.0;  ///< the other inputs go; then the vacuum stays so long
    int cycles = 6;
    double seconds = 24.0;  ///< of a trial that is recorded again
    /// Over which its frames are averaged, at least. A dozen experiments are weighed: over 0.2 s, they took a
    /// quarter of the time of a diagnosis.
    double block_s = 0.5;
  } experiment;

  /// Rings that have one another's names.
  struct Names {
    std::size_t instants = 40;  ///< of a trial, evenly, that are looked at: names stay exchanged for long
    double mostly = 0.5;  ///< share of them, from which on an order is the trial's, no ghosts for a while
  } names;

  /// Payloads that are not what was told. What the recordings say of them costs a second diagnosis, under
  /// other payloads; that one decides.
  struct Told {
    double least_share =
        0.25;  ///< of the heaviest that was told, or found: a smaller difference is an effect's
    double least_time = 0.2;  ///< of a trial, in which it hangs
    double least_z = 5.0;     ///< of one that is worth that
    double offset_sd = 0.3;   ///< of the length, by which what hangs may be off its axis
    double exchanged = 0.9;   ///< share of the gain from which on what was told elsewhere explains it better
    std::size_t most_in_sets =
        8;                       ///< trials told the same, of which all sets are looked at: 247; of more all
    std::size_t most_steps = 8;  ///< from what was told to what hung
    /// Step over the heaviest payload, or over the payload's standard deviation, after which none is made.
    double settled = 0.02, settled_sd = 0.5;
    /// Ratio of plain errors on unseen trials, of all that is found under other payloads to all that is
    /// found as told: below it those are the arm's. Numbers that were fitted to the trials themselves make
    /// some of it.
    double better = 0.8;
  } told;

  /// Which trials are one sequence of commands.
  struct Sequences {
    /// Rms difference of two trials' inputs over their spread, below which their commands are the same: noise
    /// of 300 Pa on pressures that go up and down by 20 kPa makes 0.05, programmes that are unrelated 1.4.
    double same = 0.25;
    double overlap = 0.8;  ///< of the shorter trial, that must be compared
  } sequences;

  /// A law that is learnt from what nothing in the catalogue explains. Tried on untidy development cases with
  /// an effect outside the catalogue, and on a valve that acts on another chamber (discovered_law_test.cpp).
  struct Law {
    std::size_t most_terms = 3;                 ///< of one law: a sentence each
    double times_s[4] = {0.3, 1.0, 4.0, 15.0};  ///< of what follows: from a line to the creep of a wall
    double least_left = 0.02;  ///< of a signature's squares, beyond constants and effects: else they are it
    /// Of the length: by which a moment of its own, that nobody looks for, usually moves the bodies of one
    /// trial, rms: as the least background of untidy development cases.
    double trial_offset = 1e-3;
    std::size_t few_trials = 6;  ///< fewer are resampled by stretches, not whole
    std::size_t halvings = 50;   ///< each gives two resamples (Shah and Samworth 2013)
    /// Share of the resamples in which a term must be chosen, of the 0.6 to 0.9 of Meinshausen and
    /// Buhlmann 2010. With three of some 90 terms in each, 0.5 wrong ones are expected at most; true refits
    /// judge those.
    double stable = 0.6;
    double alike = 0.7;                ///< squared canonical correlation of terms that stand for each other
    double least_more = 0.1;           ///< by which a further term must add to what those before it take
    std::size_t folds = 3;             ///< of input sequences, each predicted by true refits to the others
    std::size_t fewest_sequences = 2;  ///< with fewer nothing is new to what was fitted
    /// Of what a flexible model learns of the squared error that is left: less is no law of it. Of all that
    /// is left a law must take least_share.
    double of_flexible = 0.3, least_share = 0.1;
    double resembles = 0.7;  ///< cosine with an effect's signature, from which on it is said
  } law;

  /// What is worth a word.
  struct Words {
    double interval_sd = 1.6449;  ///< half of a 90 % interval, in standard deviations
    double likely = 0.1;          ///< probability of one that is not named
    /// Of what all effects explain, below which one is a small departure if it explains no more than `small`
    /// of the arm's length; the same where something else is left, of what could be explained. Several
    /// departures of that size are what every arm has (half a millimetre on one of 0.2 m).
    double small_share = 0.1;
    double small_part = 0.25, small = 2.5e-3;
    double weight = 0.05;  ///< share to which weights are known that were told, or follow from a drawing
    double left_out_share = 0.1;  ///< of the recordings, beyond which the verdict's line says it
    /// Ratio of a gain or a stiffness to the arm file's beyond which the file is asked about: an arm differs
    /// from its file by less, if the file is of it and its inputs are. In the whole proof it was said of none
    /// of 662 simulated cases, and of 6 of 71 with recordings of pouch arms.
    double far = 2.0;
    double far_sd = 3.0;  ///< standard deviations by which that must be sure
    double worse = 1.05;  ///< ratio of a trial's mean errors beyond which it is said to be predicted worse
    double stands_out = 5.0;    ///< z of the screen from which on "absent" would be too much
    double no_better = 0.95;    ///< share of the error from which on a flexible model has learnt nothing
    double pattern_p = 0.01;    ///< of a pattern in what is left that is worth mention
    double identifiable = 0.5;  ///< relative standard deviation up to which a shift of a constant is one
    std::size_t ranked = 8;     ///< candidates in the table on the terminal
  } words;

  /// Correlations of the effects' numbers in the extended arm file: as few, and as short, as say the same.
  struct Stated {
    int fewest_digits = 2, most_digits = 9;  ///< behind the point
    double left_out = 10.0;                  ///< units of the last digit, below which one is left out
    /// Ratio within which the variance of every mixture of the numbers must stay: intervals change by an
    /// eighth at most.
    double same_variance = 1.25;
    /// Variance of the surest mixture, of numbers with a standard deviation of 1: one that is surer is stated
    /// so. It moves the arm by a thousandth of what a number alone does.
    double surest = 1e-6;
  } stated;
};
inline constexpr Policy kPolicy{};

/// Standard deviation of the mocap's noise, per coordinate: what the arm file says, root mean square of its
/// bodies, m.
double noise_m(const arm::Arm& arm);

/// Mass of the arm with its tip, without payload, kg.
double mass_kg(const arm::Arm& arm);

}  // namespace softarm::diagnose
