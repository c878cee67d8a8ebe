// What the estimation decides by, beside what an arm file sets (arm::EstimatorOptions). Nothing else in this
// room decides: constants beside the code are tolerances of its numbers and steps of its solvers.
#pragma once

#include <cstddef>

namespace softarm::estimate {

/// Found on the virtual rig and on the recordings of laboratories (test/estimate, scripts/demo).
struct Policy {
  /// Which bodies count.
  struct Bodies {
    double far = 1.5;      ///< of the arm's length from the base: beyond it is no measurement
    double huber = 3.5;    ///< distance in standard deviations beyond which the robust loss bends
    double outlier = 6.0;  ///< standard deviations at which a body may be set aside ...
    double outlier_against_rest = 4.0;  ///< ... if it is also that many times worse than the others
    double look_again_sd = 1.0;         ///< change of a fit beyond which another body may be an outlier
  } bodies;

  /// Where a fit without a last frame begins: at what arcs through the bodies say.
  struct Start {
    double too_close = 0.02;          ///< of the arm's length: an arc to a body so near would be noise
    double curvature_sd_per_m = 1.0;  ///< of an arc: half a millimetre over 50 mm
    double flexibility_sd = 1.0;      ///< of a segment, in that of its base stiffness
    /// Length over that at rest, where the arm file has no range: what elongating arms do.
    double least_stretch = 0.7, most_stretch = 1.5;
  } start;

  /// Which fits count.
  struct Fit {
    double bad_start = 0.05;    ///< rms distance over the arm's length above which the last frame is no start
    double poor = 0.025;        ///< the same above which a fit is tried again from another start
    double inconsistent = 0.1;  ///< the same above which a converged fit is inconsistent
    /// A fit that has not met its tolerance by then is none, unless chi^2 can hardly fall further: a tenth of
    /// a standard deviation. Of the fits of test/estimate 96 in a hundred end within 20.
    int most_iterations = 59;
    double converged_chi2 = 0.01;
    double inflation_level = 0.999;  ///< of chi^2: above it standard deviations are scaled by the misfit
    double other_length = 2.0;       ///< ratio from which on a refusal names the lengths, as of other units
    double other_direction_chi2 = 3.0;  ///< two standard deviations, less some allowance for curvature
    /// What a frame does not determine stays where an arm could have it: the flexibility near that of the
    /// base stiffness, the payload near none. Far weaker than any measurement that matters, and left out of
    /// the covariance.
    double weak_flexibility_sd = 3.0;  ///< relative
    double weak_payload_sd_kg = 5.0;
  } fit;

  /// Which parameters are determined.
  struct Determined {
    double lost_share = 1e-6;  ///< of a parameter in directions of no information, from which on it is not
    /// Nor is it where its standard deviation exceeds anything an arm could have: three radians of actuated
    /// bending, several times the base's flexibility, half the length, tens of kilograms.
    double absurd_sd[4] = {3.0, 3.0, 5.0, 0.5};  ///< in the order of a segment's parameters
    double absurd_payload_sd = 500.0;            ///< in units of the problem's payload
    /// Share of c: EI = EI_base / c is followed no farther up than to that of an arm half as flexible.
    double farthest_softer = 0.5;
  } determined;

  /// Windows of frames.
  struct Window {
    double change_probability =
        1e-7;                     ///< of a shared value, below which it has changed: at 240 Hz one in hours
    double misfit_level = 0.999;  ///< of chi^2: above it the frames have an error of the model in common
    double longest_spacing_s = 0.2;  ///< frames further apart have a gap between them
    double swing_s = 0.2;            ///< the laws' passing errors, lag and damping, last as long as a swing
    double acceleration_s = 0.25;    ///< over which the tip's acceleration is fitted: half a swing
    double acceleration_by_chance = 0.01;  ///< with which noise is taken for an acceleration
    /// Bodies within this share of the arm's length of where they were: the same posture, in which the laws'
    /// passing errors and the model's stay as they are. They depend on pressures and shape, smoothly: a tenth
    /// is a fraction of what an arm moves. Larger is more careful.
    double posture = 0.1;
    std::size_t linearised = 8;    ///< postures that are linearised anew at each frame
    int groups = 64;               ///< in which frames leave the window
    int noise_frames = 200;        ///< over which the noise from frame to frame is averaged
    double least_noise = 0.01;     ///< of the stated one: what is less is rounding
    double least_offset_m = 1e-6;  ///< what bodies are off by where nothing is said of it: also numbers round
    double least_offset_rad = 1e-5;
  } window;

  /// A payload that changes. On the rig, whose hand takes 0.2 s to hang a weight on and holds it for 0.6 s,
  /// what the arm feels is off by all of the change at first, by 0.4 of it after 0.8 s, and by less than a
  /// tenth after 2 s, when `identify` and `diagnose` use frames again as well.
  struct Payload {
    double fades_s = 0.8;  ///< in which what the arm feels comes e times nearer to what hangs on it
    double hand_s = 0.8;  ///< where the swing is followed: for so long a hand may be on the arm, then none is
    double settles_s = 2.0;  ///< for so long after a change nothing is identifiable
    double trifle = 0.01;    ///< of all that hangs on the base: a smaller change does not count
    /// A payload that is estimated changes where the newest frames are that many standard deviations from
    /// those before.
    double seen_sd = 5.0;
    double least_share = 0.01;  ///< of an estimated payload's variance is its own: what is less is rounding
    double newest_s = 0.03, compared_s = 0.6;
  } payload;

  /// An arm that is followed through its swings (`dynamics: modal`).
  struct Swing {
    int modes = 2;            ///< of lowest frequency: in two planes
    double unknown = 0.1;     ///< of the arm's length, the body farthest off: how far a hand may have bent it
    double walk = 0.0015;     ///< the same, per root of a second, by which equilibria move as no law says
    double inputs_rel = 0.2;  ///< of what the laws say that inputs move them by: its standard deviation
    double spring_rel = 0.15;  ///< the same of a mode's stiffness: of EI and of what moves,
    double spring_s = 0.1;     ///< ... as if that changed in a part of a swing
    double by_chance = 1e-4;   ///< with which what a mode does is noise
    double jump = 0.1;  ///< of the length, from frame to frame: no arm swings so, and the body is wrong
    double least_information = 1e-6;  ///< on the mode that bodies tell least, relative
    /// Modes are drawn anew where a body is this share of the length from where it was then, or what they
    /// depend on has changed by this share. A tenth of EI or of the mass changes a frequency by a twentieth.
    double redraw = 0.1;
  } swing;

  /// Effects of the arm file, which a fit has as a line about a place.
  struct Effects {
    /// Between the line and what the effects do, at a body, in its standard deviations; also between the
    /// shape that is kept and the estimate. A tenth makes the error of an estimate half a per cent larger.
    double agrees_sd = 0.1;
    /// By how much a fit may have moved on before the line's slope is differenced anew; on the way each
    /// solution corrects it. Bending to two sides (rad), flexibility (share), length (share). Estimates are
    /// 0.01 sd (rms) from those of full convergence, as with a quarter of these, which takes 1.1 to 1.8 times
    /// as long.
    double slope_holds[4] = {0.6, 0.6, 0.8, 0.04};
    double slope_holds_payload = 0.5;       ///< the same, in units of the problem's payload,
    double slope_holds_gravity_m_s2 = 0.5;  ///< ... of the base's attitude,
    double slope_holds_s = 0.5;             ///< ... and of what effects remember
    double errors_hold = 0.5;  ///< the same, in shares of these, for what errors of the effects' numbers do
    /// Length over that at rest, within which effects are worked out: a fit on its way may be beyond.
    double least_length = 0.5, most_length = 2.0;
    /// What a line is off by is expected to go with the way, in shares of slope_holds. Of ways below
    /// `typical_way` it is what it is at that way; an older observation counts `forgets` of itself. What is
    /// seen on a way below `short_way` is the solver's own error and corrects no slope.
    double typical_way = 0.2, forgets = 0.9, short_way = 0.02;
  } effects;
};
inline constexpr Policy kPolicy{};

}  // namespace softarm::estimate
