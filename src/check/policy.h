// What the checks of a recording decide by. Nothing else in this room decides: figures beside the code are
// tolerances of its numbers and sizes of its tables.
#pragma once

#include <cmath>
#include <cstddef>

namespace softarm::check {

/// Found on recordings of the virtual rig with and without each fault, such that no sound one is blamed, and
/// looked at on those of laboratories. Distances were found on the arm online_200mm, 0.2 m long, and stand
/// here as shares of an arm's length; those in an input's units are what such inputs can be.
struct Policy {
  /// Stamps and streams.
  struct Timing {
    double other_epoch_s = 2.0;          ///< stamps further from receipt are of another clock altogether
    double jump_s = 1.0;                 ///< as the frame assembler: a smaller step back is a late sample
    double duplicate_share = 0.001;      ///< fewer are not worth a word
    double irregular_share = 0.02;       ///< of the period: robust sd of the steps of a body's stream
    double irregular_input_share = 0.1;  ///< the same, of an input's
    double very_irregular_share = 0.25;  ///< the same: it would matter to any arm
    double slow_hz = 10.0;               ///< bodies seen less often miss the arm's motion
    double never_held_s = 2.0;           ///< no input should be held for longer
    double same_event_s = 0.5;           ///< findings of all drivers so close together are one
  } timing;

  /// Receipt against stamps.
  struct Receipt {
    double ahead_s = 0.001;      ///< nothing can be received before it is stamped
    double long_s = 0.1;         ///< latency between stamp and receipt
    double jitter_s = 0.001;     ///< of it
    double very_shaky_s = 0.03;  ///< jitter worth a warning
    double drift = 2e-5;         ///< s per s: more than two quartz clocks
    double drifted_s = 5e-4;     ///< over the whole recording, from which on a drift is said
  } receipt;

  /// Clocks of bodies and inputs, by the arm's motion.
  struct Clocks {
    double most_shift_s = 1.0;      ///< looked for
    int least_blocks = 9;           ///< of two seconds, for a standard deviation
    double explained_well = 0.995;  ///< of the motion: no model is wrong enough to matter
    double least_explained = 0.3;   ///< of the motion by the inputs
    double least_sd_s = 0.04;       ///< a standard deviation beyond it says nothing
    double lag_s = 0.08;            ///< of an arm's own: beyond it a lag is worth a warning
    double lead_s = 0.02;           ///< the arm cannot come before its inputs
    double driven_pa = 500.0;       ///< range below which a pressure does not drive the arm
  } clocks;

  /// Labels and lost, frozen, leaping, turned bodies.
  struct Tracking {
    double memory_s = 0.5;            ///< a body seen longer ago may be anywhere
    double apart = 0.025;             ///< of the length: closer bodies cannot be told apart
    double near_share = 0.35;         ///< of the distance between two: where the other was
    double far_share = 0.65;          ///< ... and where it was itself not
    double frozen_s = 0.25;           ///< as the frame gate
    std::size_t frozen_samples = 10;  ///< the same
    double white_m = 2e-6;            ///< less noise may be rounding of the numbers
    double hardly = 0.02;             ///< of the samples: repeats that chance makes
    double repeated_share = 0.2;      ///< of the samples, worth a word
    double lost_share = 0.02;         ///< of the frames; single dropouts up to that are the rule
    double lost_s = 0.1;              ///< in one piece
    double jump = 0.005;              ///< of the length: a leap off the neighbours' median
    double jump_rad = 0.05;           ///< the same, of an orientation
    double jump_noise = 8.0;          ///< ... beyond so many sds of the noise
    double jump_motion = 6.0;         ///< ... and so many times what is usual in that motion
    double over_rad = 2.2;            ///< within one sample; nothing turns by that
    double back_rad = 1.0;            ///< near enough to where it was
  } tracking;

  /// Mocap noise against the arm file's.
  struct Noise {
    double too_small = 1.6;  ///< measured over stated
    double too_large = 3.0;  ///< stated over measured
    double lag_s = 0.1;      ///< at which white noise is not correlated any more
  } noise;

  /// The arm at rest.
  struct Rest {
    double still = 0.005;       ///< of the length: a mean may wander by so much while the arm is called still
    double least_s = 0.3;       ///< shorter stillness may be a turning point
    double held_share = 0.25;   ///< of an input's range, above its least value: it is driven
    double rest_share = 0.005;  ///< of an input's range
  } rest;

  /// Places of bodies against the arm file.
  struct Places {
    std::size_t least_frames = 40;  ///< fewer do not show lasting residuals
    double off = 1.75e-3;           ///< of the length: a mean residual
    double slip = 2.5e-3;           ///< of the length: its change
    double lasting = 7.5e-4;        ///< of the length: residuals that stay for a while
    double tilt_rad = 0.02;         ///< of a tangent against the fitted one
    double same_event_s = 1.0;      ///< a bump of the base and a slip of the rings are one event
    double neighbours_s = 0.5;      ///< residuals so close together ought to differ by noise alone
    double chance = 0.25;           ///< of the variance: covariance of neighbours that is chance
    double ring_off = 3e-3;         ///< of the length: one ring along the arm, by spacing
    double stretch_warn = 0.015;    ///< of all rings together
    double stretch_tell = 0.003;    ///< the same, worth a word
    double stretched = 0.005;       ///< of the length: what the stretch must come to for a warning
    double most_bend_rad = 1.2;     ///< beyond it arcs from chords are too rough
    double base_moves = 2.5e-3;     ///< of the length: drift of the mount
    double base_moves_rad = 0.3 * M_PI / 180.0;  ///< the same, a turn
    double base_far = 0.025;                     ///< of the length: drift that spoils the recording
    double base_far_rad = 2.0 * M_PI / 180.0;    ///< the same, a turn
    double sag = 2.5e-3;  ///< of the length: residuals that another direction of gravity could explain
  } places;

  /// Levels and courses of the inputs.
  struct Inputs {
    double most_gauge_pa = 7e5;      ///< what soft arms stand
    double most_rest_pa = 4e4;       ///< of a level at rest that may be real
    double least_most_pa = 500.0;    ///< a chamber that is driven at all
    double offset_pa = 500.0;        ///< of a sensor at rest
    double offset_share = 0.02;      ///< of the range: the same
    double least_offset_pa = 150.0;  ///< the same, however small the range
    double least_tension_n = 0.02;   ///< of what may be friction
    double least_angle_rad = 0.02;   ///< of what may be play
    double stuck_s = 0.3;            ///< a value that holds so long may be stuck
    std::size_t stuck_samples = 10;  ///< the same
    double coarse_share = 0.01;      ///< of the range, steps and noise beyond it
    double sharp = 0.35;  ///< of the steps beside it: a course that stops from one sample to the next
  } inputs;
};
inline constexpr Policy kPolicy{};

}  // namespace softarm::check
