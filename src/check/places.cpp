// Rings that sit beside their places, moved during the trial, or are loose: what remains when the estimator
// has fitted them all. One ring that is off pulls the fit, and the others with it: of what follows from one
// another only the first is said.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "policy.h"
#include "residuals.h"
#include "settings.h"

namespace softarm::check {
namespace {

/// The worst ring of all in some respect.
struct Worst {
  std::size_t body = 0;
  double size = 0.0, se = 0.0, t_s = 0.0;

  void take(std::size_t b, double size_now, double se_now = 0.0, double t_now = 0.0) {
    if (size_now > size) *this = {b, size_now, se_now, t_now};
  }
};

void say_slips(Context& context, const Worst& slip) {
  const std::string& name = context.arm.bodies[slip.body].name;
  CheckFinding& finding = context.add(
      "ring_slips", name,
      fmt::format("relative to the other bodies it moves by {:.1f} mm during the trial, about t = {:.1f} s",
                  1e3 * slip.size, slip.t_s));
  finding.figure = slip.size;
  finding.unit = "m";
  finding.spans = {{slip.t_s, slip.t_s}};
  finding.remedy =
      "fix the ring to the skin; leave out what comes before or after, and state the arclength that holds "
      "for the rest. The residuals also move if the arm bends otherwise than its model";
}

void say_beside(Context& context, const Worst& off) {
  const std::string& name = context.arm.bodies[off.body].name;
  CheckFinding& finding = context.add(
      "ring_beside", name,
      fmt::format("on average {:.1f} mm beside any shape of the arm that fits the others", 1e3 * off.size));
  finding.figure = off.size;
  finding.figure_sd = off.se;
  finding.unit = "m";
  finding.remedy =
      "its centre is not on the backbone (correct it in the mocap software, or by "
      "section_in_body.position_m), it "
      "sits at another arclength_m, or a section of the arm is not as the file says";
}

void say_wanders(Context& context, const Worst& lasting) {
  const std::string& name = context.arm.bodies[lasting.body].name;
  CheckFinding& finding =
      context.add("ring_wanders", name,
                  fmt::format("relative to the other bodies it is off by {:.2g} mm (rms), in changing "
                              "directions, for longer than a tenth of a second at a time",
                              1e3 * lasting.size));
  finding.figure = lasting.size;
  finding.unit = "m";
  finding.remedy =
      "a loose ring, noise that is correlated in time (it does not average out: state the sum), or an "
      "arm that bends otherwise than its model";
  if (context.found({"noise_understated"})) return;  // that one sets it
  const Track& track = context.tracks[lasting.body + 1];
  const double sd_m = std::hypot(lasting.size, track.white_sd_m);
  if (sd_m > track.body->position_sd_m) finding.setting = position_sd_setting(track, sd_m);
}

/// @param tilt_rad what the rings that are off may make of the fitted tangents
void say_tangents(Context& context, const Residuals& residuals, double tilt_rad) {
  for (std::size_t b = 0; b < context.arm.bodies.size(); ++b) {
    const arm::MeasuredBody& body = context.arm.bodies[b];
    const ResidualSeries& series = residuals.tangents[b];
    if (series.size() < kPolicy.places.least_frames) continue;
    const double lasting = lasting_of(series);
    const double off = std::hypot(lasting, mean_of(series).head<2>().norm());
    if (off < kPolicy.places.tilt_rad + tilt_rad || off > kPolicy.places.most_tilt_rad) continue;
    CheckFinding& finding = context.add(body.orientation_usable ? Severity::kWarning : Severity::kInformation,
                                        "tangent_off", body.name,
                                        fmt::format("its z axis is {:.1f} deg off the backbone's tangent "
                                                    "that the positions give ({:.1f} deg of this varies)",
                                                    off / kDegree, lasting / kDegree));
    finding.figure = off;
    finding.unit = "rad";
    finding.remedy =
        "a loose ring, noise that is correlated in time, or a frame that was not aligned with the arm: align "
        "it at rest, or do without its orientation";
    finding.setting = without_orientation(context, context.tracks[b + 1]);
  }
}

void check_places(Context& context) {
  if (context.arm.bodies.size() < kPolicy.places.least_bodies ||
      context.recording.frames.size() < kPolicy.places.least_frames)
    return;
  // Residuals mean nothing where the geometry is not right yet.
  if (context.found({"length_unit", "body_far_away", "body_order", "base_upside_down", "base_attitude"}))
    return;
  const arm::Arm arm = repaired_arm(context);
  const Residuals residuals = residuals_of(context, arm, kPolicy.places.most_frames, true);
  Worst off, lasting, slip;
  for (std::size_t b = 0; b < arm.bodies.size(); ++b) {
    const ResidualSeries& series = residuals.bodies[b];
    if (series.size() < kPolicy.places.least_frames) continue;
    off.take(
        b, mean_of(series).norm(),
        spread_of(series) / std::sqrt(static_cast<double>(series.size()) / kPolicy.places.frames_per_value));
    lasting.take(b, lasting_of(series));
    const Slip change = slip_of(series);
    if (change.change > context.of_length(kPolicy.places.slip) &&
        change.significance > kPolicy.places.slip_errors)
      slip.take(b, change.change, 0.0, change.t_s);
  }
  if (slip.size > 0.0) {
    for (CheckFinding& f : context.findings) {
      if (f.id != "base_bumped" || f.spans.empty()) continue;
      if (std::abs(f.spans.front().from_s - slip.t_s) > kPolicy.places.same_event_s) continue;
      f.what += "; the rings do not move along: its markers slipped, or the arm in its mount";
      return;
    }
    say_slips(context, slip);
  } else if (off.size > context.of_length(kPolicy.places.off) + kPolicy.places.off_errors * off.se) {
    say_beside(context, off);
  } else {
    double slow_m = 0.0;
    for (const Track& track : context.tracks) slow_m = std::max(slow_m, track.slow_sd_m);
    // Frames may then hold bodies of several instants. (Of inputs it is mere information.)
    const bool mixed =
        std::any_of(context.findings.begin(), context.findings.end(), [](const CheckFinding& f) {
          return f.id == "split_frames" ||
                 (f.id == "irregular_stamps" && f.severity != Severity::kInformation);
        });
    if (!mixed &&
        lasting.size > context.of_length(kPolicy.places.lasting) + kPolicy.places.lasting_slow * slow_m &&
        lasting.size > kPolicy.places.lasting_of_white * context.tracks[lasting.body + 1].white_sd_m) {
      say_wanders(context, lasting);
    }
  }
  const double spacing_m = arm.total_length_m() / static_cast<double>(arm.bodies.size());
  say_tangents(context, residuals,
               kPolicy.places.tilt_of_off * std::max({slip.size, off.size, lasting.size}) / spacing_m);
}

}  // namespace

Check make_places() {
  return {check_places,
          {{"ring_slips", Severity::kWarning},
           {"ring_beside", Severity::kWarning},
           {"ring_wanders", Severity::kWarning},
           {"tangent_off", {}}}};
}

}  // namespace softarm::check
