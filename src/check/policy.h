// What the checks of a recording decide by. Nothing else in this room decides: figures beside the code are
// tolerances of its numbers, factors of an estimator and sizes of its tables.
#pragma once

#include <cmath>
#include <cstddef>

namespace softarm::check {

inline constexpr double kDegree = M_PI / 180.0;

/// Found on recordings of the virtual rig with and without each fault, such that no sound one is blamed, and
/// looked at on those of laboratories. Distances were found on the arm online_200mm, 0.2 m long, and stand
/// here as shares of an arm's length; those in an input's units are what such inputs can be.
///
/// "noises" are standard deviations of the noise of what is compared, "periods" the median steps of a
/// stream's stamps. Least numbers of samples are those from which on their estimate was steady there.
struct Policy {
  /// Stamps and streams.
  struct Timing {
    double other_epoch_s = 2.0;          ///< stamps further from receipt are of another clock altogether
    double stray_s = 3600.0;             ///< a longer pause, or another clock, is not of one recording
    std::size_t few_strays = 10;         ///< messages beyond such a pause that are called lost
    double longest_s = 7.0 * 86400.0;    ///< of a recording: what lasts longer is more than one
    double jump_s = 1.0;                 ///< as the frame assembler: a smaller step back is a late sample
    double duplicate_share = 0.001;      ///< fewer are not worth a word
    double few_duplicates = 2.0;         ///< the same, however short the recording
    std::size_t few_late = 2;            ///< samples out of order, not worth a word
    std::size_t least_steps = 20;        ///< for a spread of steps
    double single_step = 1.6;            ///< periods: longer steps are lost frames, not irregular ones
    double irregular_share = 0.02;       ///< of the period: robust sd of the steps of a body's stream
    double irregular_input_share = 0.1;  ///< the same, of an input's
    double irregular_s = 5e-5;           ///< the same: less is the grain of clocks, however quick the stream
    double very_irregular_share = 0.25;  ///< of the period: it would matter to any arm
    double slow_hz = 10.0;               ///< bodies seen less often miss the arm's motion
    double body_gap_s = 0.25;            ///< as the frame gate: frames do without bodies from then on
    double gap_periods = 8.0;            ///< a shorter gap is a few lost samples
    double left_out_grain = 0.1;     ///< of what the import left out: a slow stream's gap is longer by that
    double serious_gap_share = 0.2;  ///< of the recording
    double never_held_s = 2.0;       ///< no input should be held for longer
    double one_frame = 0.5;          ///< periods: stamps so close together are of one frame
    std::size_t least_frames = 20;   ///< for how far apart the stamps of a frame are
    double most_frames = 0.95;       ///< of all must come within the tolerance
    double tolerance = 1.5;          ///< times that way: a tolerance that is proposed, ...
    double least_tolerance = 1.0 / 3.0;  ///< ... of a period at least ...
    double most_tolerance = 0.5;         ///< ... and at most, or frames run into each other
    double holds = 1.2;          ///< times the longest gap: for how long an input is to hold, if it is
    double one_stretch_s = 0.1;  ///< wrong stamps so close together are said as one stretch
    double same_event_s = 0.5;   ///< findings of all drivers so close together are one
    double same_figure = 0.1;    ///< of it: findings of a driver that differ by less are one
  } timing;

  /// Receipt against stamps.
  struct Receipt {
    std::size_t least_samples = 20;  ///< for quantiles of the delay
    double least_delay = 0.02;       ///< its quantile: a few stamps are off, and most queues empty at times
    std::size_t drift_blocks = 8;    ///< of the recording, whose least delays are compared
    std::size_t block_samples = 20;  ///< in each
    double block_least = 0.1;        ///< quantile of its delays
    double few_slopes = 0.2;         ///< of the pairs of blocks may have the other sign, or a drift is chance
    double ahead_s = 0.001;          ///< nothing can be received before it is stamped
    double long_s = 0.1;             ///< latency between stamp and receipt
    double jitter_s = 0.001;         ///< of it
    double very_shaky_s = 0.03;      ///< jitter worth a warning
    double drift = 2e-5;             ///< s per s: more than two quartz clocks
    double drifted_s = 5e-4;         ///< over the whole recording, from which on a drift is said
    double run_away = 1.2;           ///< of what a drift comes to: being ahead by so much is the drift
    double most_latency_s = 3600.0;  ///< that the arm file takes
  } receipt;

  /// Clocks of bodies and inputs, by the arm's motion.
  struct Clocks {
    std::size_t least_poses = 60;    ///< of the outermost body
    std::size_t least_values = 20;   ///< of an input
    double driven_noises = 10.0;     ///< range of an input that says something
    double driven_pa = 500.0;        ///< range below which a pressure does not drive the arm
    double least_s = 4.0;            ///< of a trial
    double sample_s = 0.05;          ///< of the motion that is fitted: short against an arm's
    int least_samples = 80;          ///< the same
    double slow_s = 5.0;             ///< courses slower than that are no answer to the inputs
    int most_slow = 40;              ///< functions for them
    std::size_t most_steps = 30;     ///< payloads that are announced: so many of them are a signal
    double plays[2] = {0.08, 0.25};  ///< widths of hysteresis, of the range
    std::size_t few_inputs = 3;      ///< so many have all products with squares as regressors
    std::size_t some_inputs = 4;     ///< so many have all products
    double block_s = 2.0;            ///< over which residuals are correlated
    int least_blocks = 9;            ///< for a standard deviation
    double hysteresis_share = 0.5;   ///< of what the plays change: a standard deviation
    double most_shift_s = 1.0;       ///< looked for
    double scan_s = 0.1;             ///< the steps in which it is
    double bin_s = 0.1;              ///< of what moves when, over the whole recording
    double most_bins = 4000.0;       ///< of a long one: the bins are longer there
    double most_samples = 3000.0;    ///< the same, of the motion that is fitted at each peak
    std::size_t most_peaks = 12;     ///< of the correlation that are looked at
    double least_overlap_s = 18.0;   ///< of bodies and inputs at a shift
    double least_overlap = 0.25;     ///< the same, of the recording
    double piece_s = 6.0;            ///< every other one is fitted, the others judge
    double ridge = 1e-3;             ///< of a regressor's mean square, against those that a half hardly has
    double explained_as_stamped = 0.8;  ///< of the motion, across halves or in all: no other shift counts
    double explained_elsewhere = 0.6;   ///< the same, at a shift that is believed,
    double left_elsewhere = 0.5;        ///< ... and so much at most of what is left as stamped
    double apart_s = 1.5;               ///< shifts closer together are one
    double as_good = 1.6;               ///< of what the best leaves: another shift is nearly as good
    double explained_well = 0.995;      ///< of the motion: no model is wrong enough to matter
    double least_explained = 0.3;       ///< of the motion by the inputs
    double least_sd_s = 0.04;           ///< a standard deviation beyond it says nothing
    double lag_s = 0.08;                ///< of an arm's own: beyond it a lag is worth a warning
    double lead_s = 0.02;               ///< the arm cannot come before its inputs
    double sds = 2.0;                   ///< standard deviations by which either must be exceeded
  } clocks;

  /// Labels and lost, frozen, leaping, turned bodies.
  struct Tracking {
    double unit_norm = 0.1;      ///< a quaternion whose norm is further from 1 is none
    double no_pose_share = 0.1;  ///< of the samples, worth a warning

    double one_instant = 0.4;         ///< periods: poses of two bodies so close together belong together
    double memory_s = 0.5;            ///< a body seen longer ago may be anywhere
    double apart = 0.025;             ///< of the length: closer bodies cannot be told apart
    double near_share = 0.35;         ///< of the distance between two: where the other was
    double far_share = 0.65;          ///< ... and where it was itself not
    double exchanged_periods = 4.0;   ///< between two exchanged poses: those in between are doubtful
    std::size_t most_compared = 400;  ///< instants at which spacings are compared

    double frozen_s = 0.25;             ///< as the frame gate
    std::size_t frozen_samples = 10;    ///< the same
    double white_m = 2e-6;              ///< less noise may be rounding of the numbers
    double hardly = 0.02;               ///< of the samples: repeats that chance makes
    double still_mount = 0.9;           ///< of its samples repeat: a filtered or a fixed pose
    double repeated_share = 0.2;        ///< of the samples, worth a word
    double serious_frozen_share = 0.1;  ///< of the samples
    double serious_frozen_s = 2.0;      ///< in one piece
    double frozen_periods = 3.0;        ///< frozen samples so close together are one stretch

    double lost_share = 0.02;         ///< of the frames; single dropouts up to that are the rule
    double lost_s = 0.1;              ///< in one piece
    double lost_periods = 6.0;        ///< the same, of a slow stream
    double serious_lost_share = 0.3;  ///< of the frames
    double lost_stretch = 1.5;        ///< periods: lost frames so close together are one stretch

    int neighbours = 3;                 ///< on either side of a pose, which it is compared with
    double neighbours_s = 0.12;         ///< ... no further away
    std::size_t least_neighbours = 4;   ///< in all
    double usual_s = 0.4;               ///< over which it is seen what is usual in that motion
    double jump = 0.005;                ///< of the length: a leap off the neighbours' median
    double jump_rad = 0.05;             ///< the same, of an orientation
    double jump_noises = 8.0;           ///< ... beyond so many noises
    double jump_motion = 6.0;           ///< ... and so many times what is usual in that motion
    double serious_jump_share = 0.05;   ///< of the samples
    double serious_base_share = 0.005;  ///< the same, of the base
    double jump_periods = 2.0;          ///< jumps so close together are one stretch

    double over_rad = 2.2;             ///< within one sample; nothing turns by that
    double back_rad = 1.0;             ///< near enough to where it was
    double serious_over_share = 0.02;  ///< of the samples, where the orientation is used
    double over_periods = 2.5;         ///< turned samples so close together are one stretch
    double along_axis = 0.95;          ///< cosine: a turn about such an axis is said as about a frame's own
    double negative = 0.5;  ///< cosine of half the angle: beyond, a quaternion is the other's negative
  } tracking;

  /// Mocap noise against the arm file's.
  struct Noise {
    double most_sd_m = 0.1;        ///< that the arm file takes
    double too_small = 1.6;        ///< measured over stated
    double too_large = 3.0;        ///< stated over measured
    double lag_s = 0.1;            ///< at which white noise is not correlated any more
    double lag_periods = 6.0;      ///< the same, of a slow stream
    std::size_t least_blocks = 5;  ///< of that length at rest
    double errors = 3.0;           ///< standard errors beyond which a variance is more than white noise's
    double slow_m = 5e-5;          ///< what lasts, worth a word: cameras, no arm, wander by less,
    double slow_of_white = 0.5;    ///< ... against the white noise
    double slow_of_stated = 0.3;   ///< ... and against the arm file's
  } noise;

  /// The arm at rest, and noise where it is.
  struct Rest {
    std::size_t least_poses = 10;  ///< of a body that is looked at
    double still = 0.005;          ///< of the length: a mean may wander by so much while the arm is still
    double still_noises = 6.0;     ///< the same, in noises of that mean
    double block_s = 0.1;          ///< of that mean
    double block_periods = 4.0;    ///< the same, of a slow stream
    double drift = 5e-3;           ///< of the length: a straight line through a rest may change by so much
    double shortened = 0.2;        ///< of a rest that drifts, until it does not
    double drift_errors = 3.0;     ///< ... and by so many standard errors
    double rest_share = 0.005;     ///< of an input's range, by which it may wander
    double rest_noises = 6.0;      ///< the same
    double rest_steps = 1.1;       ///< the same, in steps of its converter
    std::size_t first_values = 7;  ///< of a sensor, whose median is its level
    double least_s = 0.3;          ///< shorter stillness may be a turning point
    double trimmed = 0.15;         ///< of a stillness: where it was seen to end, it ended a little before
    double driven_noises = 20.0;   ///< range of an input that may hold the arm
    double held_share = 0.25;      ///< of an input's range, above its least value: it is driven
    double first_s = 1.0;          ///< of a recording without rest: shapes are looked at there

    double noise_window_s = 0.5;    ///< some windows fall into stillness
    double quiet_windows = 0.25;    ///< quantile of their noise that is taken
    std::size_t window_steps = 24;  ///< coordinates before a window may end
    std::size_t least_steps = 6;    ///< coordinates of a window that counts
    double uneven_steps = 0.3;      ///< periods: second differences want steps that are more alike
    double longest_step = 2.0;      ///< periods
  } rest;

  /// Units, order and attitudes of the bodies.
  struct Geometry {
    double least_ratio = 0.6, most_ratio = 1.6;  ///< distances over the arm file's; beyond, another unit
    /// The same of the others, where one is beyond most_ratio times the length: up to here it is another
    /// thing.
    double most_others = 2.0;
    double least_unit = 0.75, most_unit = 1.35;        ///< the same with the unit put right
    double least_order = 0.2, most_order = 20.0;       ///< the same: a wrong order can make as much
    double least_attitude = 0.4, most_attitude = 2.0;  ///< the same: beyond, directions mean nothing
    double near_base = 0.6;                ///< of the length: the chord to a body there is half its bend off
    double base_off_rad = 50.0 * kDegree;  ///< of the base's z axis from such a chord
    double far_base_off_rad = 80.0 * kDegree;  ///< the same, of any chord: arms bend
    double upside_down_rad = 120.0 * kDegree;  ///< the same: z points away from the arm
    double backwards_rad = 100.0 * kDegree;    ///< of a ring's z axis from the chord
    double half_turn_rad = 150.0 * kDegree;    ///< about the backbone, against the base
  } geometry;

  /// Places of bodies against the arm file, and the mount's.
  struct Places {
    std::size_t least_bodies = 3;   ///< fewer have no neighbours to be compared with
    std::size_t least_frames = 40;  ///< fewer do not show lasting residuals
    std::size_t most_frames = 300;  ///< that are fitted
    double frames_per_value = 10;   ///< frames of the estimator, ten a second, that are one independent value
    double worse_fit = 2.0;         ///< times the usual residual of a frame: it is fitted anew
    double off = 1.75e-3;           ///< of the length: a mean residual
    double off_errors = 4.0;        ///< the same, in standard errors
    double slip = 2.5e-3;           ///< of the length: its change
    double slip_errors = 5.0;       ///< the same, in standard errors
    std::size_t ends = 8;           ///< an eighth of a trial at either end is too short for a change
    double lasting = 7.5e-4;        ///< of the length: residuals that stay for a while
    double lasting_slow = 3.0;      ///< ... beyond so many noises that do not average out
    double lasting_of_white = 0.3;  ///< ... and of the white noise
    double tilt_rad = 0.02;         ///< of a tangent against the fitted one
    double tilt_of_off = 4.0;       ///< ... beyond what rings off their places make of it over their spacing
    double most_tilt_rad = 1.0;     ///< beyond it is turned over: the attitude's matter
    double same_event_s = 1.0;      ///< a bump of the base and a slip of the rings are one event
    double neighbours_s = 0.5;      ///< residuals so close together ought to differ by noise alone
    double chance = 0.25;           ///< of the variance: covariance of neighbours that is chance

    double grain_m = 1e-4;                  ///< rings closer together are at one place
    double ring_off = 3e-3;                 ///< of the length: one ring along the arm, by spacing
    double ring_noises = 6.0;               ///< the same
    double ring_alone = 0.4;                ///< of it: the others must agree so well without it
    double serious_ring = 0.05;             ///< of the outermost arclength
    double stretch_warn = 0.015;            ///< of all rings together
    double stretch_notable = 0.003;         ///< the same, worth a word
    double stretch_noises = 5.0;            ///< the same
    double stretched = 0.005;               ///< of the length: what the stretch must come to for a warning
    double shortest = -0.3, longest = 0.6;  ///< stretches; beyond, it is units or order
    double most_bend_rad = 1.2;             ///< beyond it arcs from chords are too rough

    std::size_t base_poses = 30;            ///< of a mount that is looked at
    double base_block_s = 0.5;              ///< over which they are averaged
    double base_block_periods = 10.0;       ///< the same, of a slow stream
    std::size_t base_blocks = 3;            ///< of them
    double base_moves = 2.5e-3;             ///< of the length: drift of the mount
    double base_moves_rad = 0.3 * kDegree;  ///< the same, a turn
    double base_moves_usual = 6.0;          ///< ... beyond so many usual changes from block to block
    double bumped = 0.6;                    ///< of the drift comes at once
    double base_far = 0.025;                ///< of the length: drift that spoils the recording
    double base_far_rad = 2.0 * kDegree;    ///< the same, a turn
  } places;

  /// Gravity, by the arm's sag.
  struct Gravity {
    double none_m_s2 = 1.0;         ///< less is the arm file's wish for none
    double same_m_s2 = 0.1;         ///< directions that differ by less are one
    std::size_t least_bodies = 3;   ///< fewer do not show the shape of a sag
    std::size_t least_frames = 20;  ///< recorded
    std::size_t most_frames = 40;   ///< that are fitted, in each direction
    std::size_t least_fits = 10;    ///< of them
    double sag = 2.5e-3;            ///< of the length: residuals that another direction could explain
    double sag_noises = 3.0;        ///< ... beyond so many noises
    double better = 0.5;            ///< of the residuals is left with the right direction
    double rises = 0.01;            ///< of the length, under a payload: gains that a load changes make less
    double sds = 3.0;               ///< beyond that
  } gravity;

  /// Units and levels at rest of the inputs.
  struct Inputs {
    std::size_t least_values = 5;     ///< for a unit
    std::size_t first_values = 15;    ///< whose median is the level at first
    double spikes = 0.01;             ///< quantile at either end
    double most_gauge_pa = 7e5;       ///< what soft arms stand
    double most_rest_pa = 4e4;        ///< of a level at rest that may be real
    double near_ambient = 0.15;       ///< of ambient: a least gauge pressure that is the air's own
    double least_gauge_pa = -6e4;     ///< chambers are hardly evacuated
    double least_vacuum_pa = -1.1e5;  ///< there is no less than nothing
    double least_most_pa = 500.0;     ///< a chamber that is driven at all
    double tiny = 0.5;                ///< of the file's unit, gauge: more is a course, if of another unit
    double most_rad = 30.0;           ///< of a servo: five turns
    double most_tension_n = 1000.0;   ///< of a tendon
    double offset_pa = 500.0;         ///< of a sensor at rest
    double offset_share = 0.02;       ///< of the range: the same
    double least_offset_pa = 150.0;   ///< the same, however small the range
    double least_tension_n = 0.02;    ///< of what may be friction
    double least_angle_rad = 0.02;    ///< of what may be play
    double offset_errors = 5.0;       ///< standard errors of the level, on top
    double below_noises = 4.0;        ///< by which it falls below a level that is then no zero,
    double below_share = 0.01;        ///< ... and of the range
    double one_level_pa = 1.0;        ///< chambers that rest so close together are commanded there
  } inputs;

  /// Courses of the inputs.
  struct Signals {
    double few_values = 0.01;       ///< of a course that may be no values of it, such as single zeros
    int least_turns = 20;           ///< steps, for telling a sensor from a command
    double turns_share = 0.15;      ///< of the steps: noise turns round, a command holds or moves on
    std::size_t least_steps = 12;   ///< for a quantum
    double single_quantile = 0.02;  ///< of the steps: one quantum
    double most_quanta = 40.0;      ///< of a step that still shows them
    double off_quanta = 0.05;       ///< by which a step may be off a whole number of quanta,
    double off_per_quantum = 0.2;   ///< ... that share of it for each of them, if more
    double quanta_share = 0.95;     ///< of the steps are whole numbers of quanta
    std::size_t few_single = 3;     ///< steps of one quantum are chance
    double finest = 1e-5;           ///< of the range: finer is how numbers are written

    std::size_t least_values = 20;   ///< of a course
    double moves_noises = 6.0;       ///< range of an input that moves
    double driven_noises = 8.0;      ///< range of one that is looked at, in noises and in quanta
    double stuck_s = 0.3;            ///< a value that holds so long may be stuck
    std::size_t stuck_samples = 10;  ///< the same
    std::size_t beside = 6;          ///< samples before and after it, whose steps are usual
    double usual_hold = 0.9;         ///< quantile of all holds
    double stuck_holds = 4.0;        ///< usual holds: a noisy sensor that holds longer sticks
    double sharp = 0.35;  ///< of the steps beside it: a course that stops from one sample to the next
    double leap = 4.0;    ///< usual steps, or noises: it goes on elsewhere
    double still = 1e-4;  ///< of the range: lesser steps are no motion
    double serious_stuck_share = 0.2;  ///< of the recording
    std::size_t least_clipped = 2;     ///< times at the limit
    double coarse_share = 0.01;        ///< of the range, steps and noise beyond it
    double one_value = 0.1;            ///< of a quantum: values that differ by less are one
    std::size_t least_distinct = 6;    ///< values of a course in steps
    double least_noise = 1e-4;         ///< of the range, worth a word
    double flicker = 0.5;              ///< of a quantum: less noise is between two values
  } signals;

  /// Inputs that are dead.
  struct Dead {
    double most_places = 0.98;     ///< quantile of the places, at either end: few are jumps
    double swings_s = 3.0;         ///< after a payload is hung on or taken off
    double hung_on_s = 1.0;        ///< before that is said
    double moves = 0.04;           ///< of the length: the arm is driven by something; sag and creep are less
    double least_explained = 0.3;  ///< of the motion by the inputs that change
    double unexplained = 0.05;     ///< of the motion: beyond it its direction is looked at
    double along = 0.9;         ///< of that, along the line of the input that is constant (0.96 on the rig)
    double driven_along = 0.7;  ///< of what the others explain, at most: else it may be theirs
  } dead;

  /// Inputs that bend the arm elsewhere than the arm file says.
  struct Directions {
    double least_explained =
        0.5;              ///< of the motion across the arm, by all inputs: else something else moves it
    double moves = 0.04;  ///< of the length, by the input over its range: it is seen
    double most_sd_rad = 0.2;
    double along = 0.9;       ///< cosine of directions of one input in several segments that are one
    double off_rad = 0.8;     ///< 46 degrees: of four chambers another one's place is nearer
    double sds = 3.0;         ///< beyond that
    double alike_rad = 0.45;  ///< 26 degrees: chambers are glued in by hand, and a bent arm is not linear
    /// By which bodies may follow their inputs, s: as far as valves, hoses and clocks are late.
    double lags_s[9] = {-0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
    double as_much = 1.5;   ///< ratio of what is left up to which another lag explains as much
    double no_more = 2e-3;  ///< of the motion, which it may leave besides: samples go straight in between
    std::size_t most_ordered = 6;  ///< inputs of which all orders are tried
  } directions;

  /// The payload that is announced.
  struct Payload {
    double most_kg = 100.0;  ///< that the arm file takes
    double grams = 20.0;     ///< times the most that the arm file allows: another unit
    double late_s = 1.0;     ///< after the first sample
  } payload;
};
inline constexpr Policy kPolicy{};

}  // namespace softarm::check
