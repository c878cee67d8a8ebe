// What the live monitor decides by, beside what its user may set (MismatchMonitorParams). Nothing else in
// this room decides.
#pragma once

#include <cstddef>

namespace softarm::monitor {

/// Chosen on streams of the virtual rig with and without sudden changes (test/monitor, scripts/prove).
/// Distances were chosen on the arm online_200mm, 0.2 m long and seen with 0.5 mm per coordinate, and stand
/// here as shares of that length or of that noise.
struct Policy {
  /// The stretch over which discrepancies are averaged.
  struct Window {
    double bin_s = 0.025;
    std::size_t bins = 10;
    double seconds() const { return bin_s * static_cast<double>(bins); }
    std::size_t fewest_bins = 5;    ///< in it
    double full = 0.7;              ///< share of its time that they must span
    double seen = 0.6;              ///< share of its bins in which a body is, for its mean to be the window's
    double gap_s = 0.15;            ///< in the stream, after which a window is begun anew
    double stale_s = 0.5;           ///< without a window, after which nothing is said
    double time_jump_s = 1.0;       ///< back: another recording has begun
    double longest_step_s = 1.0;    ///< a longer pause counts as no more in what is learned
    std::size_t fewest_points = 5;  ///< of an estimate's backbone: fewer do not show a shape
  } window;

  /// The laws' lasting errors: standard deviations, beyond those of the arm file's LawPrior.
  struct Laws {
    double gain = 0.15;           ///< relative, of the moment
    double turn_rad = 0.1;        ///< of its direction
    double length_per_nm = 0.05;  ///< of the length, by each N m of actuation
    double lag_s = 0.1;           ///< of the arm after its inputs
    double offset = 3.0;          ///< of the noise: of a body's place
    // What counts as free in a fit without laws: more than it can be.
    double free_curvature = 6.0;    ///< over the length
    double free_flexibility = 3.0;  ///< of its logarithm
    double free_length = 0.5;       ///< of the length
    double free_payload_kg = 0.1;   ///< beyond the end of the arm file's range
  } laws;

  /// What is expected of a window against the corrected laws.
  struct Expected {
    double floor = 4e-4;          ///< of the length: what remains of the model however long one looks
    double floor_noise = 0.15;    ///< of the noise: what remains of mocap
    double at_first = 1.0;        ///< of the noise, before anything was learned
    double learn_s = 30.0;        ///< memory of what windows are off by
    double first_weight_s = 0.5;  ///< of what is believed at first
    double outlier = 3.0;         ///< windows beyond so many times what is expected count as much as that
    double common = 4.0;          ///< successive windows err alike: so many count as one
    // Shares to which is known what is allowed for.
    double inertia_share = 0.3;
    double correction_share = 0.15;
    double law_change_share = 0.15;  ///< of what the laws' predictions change by within a window
    double any_direction = 0.1;      ///< of the variance of each, otherwise than its shape
    double lag_jitter_s = 0.006;
  } expected;

  /// Alarms.
  struct Alarm {
    double suspicion = 0.5;       ///< of the threshold: the reference waits
    double suspicious_s = 3.0;    ///< ... at most so long
    double doubt = 0.01;          ///< ... then it learns anew, so much at a time
    double payload_doubt = 0.05;  ///< after the payload changed: a scale's error, a hook's
    double hand = 0.7;            ///< of the hold-off: nothing is learned of an arm that is held
    double clear_s = 1.0;         ///< below suspicion, after which an alarm ends
    double chance_chi2 = 2.5;     ///< per degree of freedom, below which no change is looked for
    double unexplained = 0.5;     ///< share of a change below which its best explanation is none
  } alarm;

  /// Kind, place and onset of a change.
  struct Naming {
    double seconds = 1.0;          ///< while an alarm is so young they are looked at again
    double per_value = 3.0;        ///< gain of one more free value by chance, doubled log likelihood (BIC)
    double lead = 6.0;             ///< of the doubled log likelihood, by which the likeliest must lead ...
    double lead_share = 0.02;      ///< ... and as a share of its own
    double place = 4.0;            ///< the same, for a place: two standard deviations ...
    double place_share = 0.03;     ///< ... and something for the model
    double rising = 0.15;          ///< of a change's size: where it begins
    double longest_onset_s = 2.0;  ///< looked back
    int contact_places = 12;       ///< evenly along the arm, where a contact is looked for
    double straight = 0.02;        ///< of the length: tip off the base's axis, no plane of bending
  } naming;
};
inline constexpr Policy kPolicy{};

}  // namespace softarm::monitor
