// Places of the rings along the arm at rest, against the arm file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "math_of_poses.h"
#include "policy.h"
#include "settings.h"
#include "shape.h"
#include "softarm/arm/laws.h"

namespace softarm::check {
namespace {

/// The payload that is known while the arm rests.
double payload_kg(const Context& context, const CheckSpan& span) {
  double kg = context.arm.payload.default_kg.value_or(0.0);
  for (const ValuePoint& p : context.payload) {
    if (p.t_s <= span.to_s) kg = p.value;
  }
  return kg;
}

/// What the weight of arm and payload stretches it by, were it straight, over its length: of segments whose
/// axial stiffness the arm file has.
double weight_stretch(const Context& context, const CheckSpan& span) {
  const auto base = context.rod_base();
  if (!base) return 0.0;
  const arm::Arm& arm = context.arm;
  const double along_m_s2 = base->linear().col(2).dot(arm.gravity_m_s2), payload = payload_kg(context, span);
  double beyond_kg = arm.tip_mass_kg, end_m = arm.total_length_m(), longer_m = 0.0;
  for (auto s = arm.segments.rbegin(); s != arm.segments.rend(); ++s) {
    const double mass_kg = s->mass_per_length_kg_m * s->length_m, begin_m = end_m - s->length_m;
    const double loaded_m = std::clamp(arm.payload.arclength_m - begin_m, 0.0, s->length_m);
    const double kg_m = (beyond_kg + 0.5 * mass_kg) * s->length_m + payload * loaded_m;
    if (s->axial_stiffness_n) longer_m += along_m_s2 * kg_m / *s->axial_stiffness_n;
    beyond_kg += mass_kg;
    end_m = begin_m;
  }
  return longer_m / arm.total_length_m();
}

/// Length of the arm by its laws at the inputs at rest, over that at zero input; 1 where they are unknown.
double law_stretch(const Context& context, const CheckSpan& span) {
  arm::InputValues values;
  for (const Signal& signal : context.signals) values.push_back(signal.mean(span.from_s, span.to_s));
  const auto predicted = predict(context.arm, values);
  if (!predicted) return 1.0;
  double length_m = 0.0;
  for (const arm::SegmentPrediction& p : *predicted) length_m += p.length_m;
  return length_m / context.arm.total_length_m();
}

/// Arclengths of the places, from chords and the angles between them.
std::vector<double> arclengths(const std::vector<Place>& places, double* bend_rad) {
  std::vector<double> result;
  Eigen::Vector3d last = Eigen::Vector3d::Zero(), direction = Eigen::Vector3d::UnitZ();
  double sum = 0.0;
  *bend_rad = 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Eigen::Vector3d chord = places[k].p_base - last;
    const double turn = angle_between(direction, chord);
    const double bend = k == 0 ? 2.0 * turn : turn;  // within this piece
    *bend_rad += bend;
    sum += chord.norm() * (1.0 + bend * bend / 24.0);
    result.push_back(sum);
    last = places[k].p_base;
    direction = chord;
  }
  return result;
}

/// One ring alone: against the line through base and the others, which must agree far better without it.
void say_misplaced(Context& context, const std::vector<Place>& places, const std::vector<double>& measured,
                   double noise_m) {
  if (places.size() < kPolicy.places.least_bodies) return;
  std::size_t worst = 0;
  double worst_share = kPolicy.places.ring_alone, place_m = 0.0;  // what the others are off, over what it is
  for (std::size_t k = 0; k < places.size(); ++k) {
    double xy = 0.0, xx = 0.0;
    for (std::size_t j = 0; j < places.size(); ++j) {
      if (j == k) continue;
      xy += places[j].arclength_m * measured[j];
      xx += places[j].arclength_m * places[j].arclength_m;
    }
    if (!(xx > 0.0)) continue;
    const double slope = xy / xx;
    double rest_m = 0.0;
    for (std::size_t j = 0; j < places.size(); ++j) {
      if (j != k) rest_m = std::max(rest_m, std::abs(measured[j] - slope * places[j].arclength_m));
    }
    const double here_m = measured[k] / slope, off_m = std::abs(here_m - places[k].arclength_m);
    if (off_m < context.of_length(kPolicy.places.ring_off) + kPolicy.places.ring_noises * noise_m ||
        rest_m >= worst_share * off_m)
      continue;
    worst = k;
    worst_share = rest_m / off_m;
    place_m = here_m;
  }
  if (!(place_m > 0.0)) return;
  const Track& track = context.tracks[places[worst].track];
  const double off_m = place_m - places[worst].arclength_m;
  CheckFinding& finding = context.add(
      std::abs(off_m) > kPolicy.places.serious_ring * places.back().arclength_m ? Severity::kSerious
                                                                                : Severity::kWarning,
      "ring_misplaced", track.name,
      fmt::format("at rest it sits {:.1f} mm {} than the arm file says (arclength {:.1f} mm, not {:.1f} mm)",
                  1e3 * std::abs(off_m), off_m > 0.0 ? "further towards the tip" : "nearer to the base",
                  1e3 * place_m, 1e3 * places[worst].arclength_m));
  finding.figure = off_m;
  finding.unit = "m";
  finding.remedy = "push it back, or state its present arclength";
  // The arm file takes places on the arm, in order.
  const double before_m = worst > 0 ? places[worst - 1].arclength_m : 0.0,
               after_m =
                   worst + 1 < places.size() ? places[worst + 1].arclength_m : context.arm.total_length_m();
  if (place_m > before_m + kPolicy.places.grain_m && place_m < after_m - kPolicy.places.grain_m)
    finding.setting = fmt::format("bodies[{}].arclength_m: {:.4f}", track.name, place_m);
}

/// All lengths of an arm that is longer by so much.
std::string stretched_arm(const arm::Arm& arm, double stretch) {
  // To the micrometre, and no body beyond the sum of the rounded segments.
  const auto rounded = [](double x) { return std::round(1e6 * x) * 1e-6; };
  std::vector<std::string> settings;
  double total_m = 0.0;
  for (const arm::Segment& segment : arm.segments) {
    const double length_m = rounded(stretch * segment.length_m);
    total_m += length_m;
    settings.push_back(fmt::format("segments[{}].length_m: {:.6f}", segment.name, length_m));
    // Limits that it leaves would be refused with it.
    settings.push_back(fmt::format("segments[{}].length_range_m: [{:.6f}, {:.6f}]", segment.name,
                                   stretch * segment.length_range_m.low,
                                   stretch * segment.length_range_m.high));
  }
  const auto place = [&](double arclength_m) { return std::min(total_m, rounded(stretch * arclength_m)); };
  for (const arm::MeasuredBody& body : arm.bodies)
    settings.push_back(fmt::format("bodies[{}].arclength_m: {:.6f}", body.name, place(body.arclength_m)));
  settings.push_back(fmt::format("payload.arclength_m: {:.6f}", place(arm.payload.arclength_m)));
  return joined(settings);
}

void check_spacing(Context& context) {
  const auto span = context.rest();
  if (!span) return;
  const std::vector<Place> places = shape_in(context, *span).places;
  if (places.empty()) return;
  double bend = 0.0;
  const std::vector<double> measured = arclengths(places, &bend);
  if (bend > kPolicy.places.most_bend_rad) return;
  const double law = law_stretch(context, *span) + weight_stretch(context, *span);
  double xy = 0.0, xx = 0.0, noise = 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double expected = law * places[k].arclength_m;
    xy += expected * measured[k];
    xx += expected * expected;
    const Track& track = context.tracks[places[k].track];
    const double n = std::max(1.0, (span->to_s - span->from_s) / std::max(track.period_s, 1e-4));
    // What does not average out at the base is in all distances.
    noise = std::max(noise, std::hypot(track.white_sd_m / std::sqrt(n),
                                       std::max(track.slow_sd_m, context.tracks[0].slow_sd_m)));
  }
  if (!(xx > 0.0)) return;
  const double stretch = xy / xx, off = stretch - 1.0;
  if (off < kPolicy.places.shortest || off > kPolicy.places.longest) return;  // another matter: units, order
  const double length_m = places.back().arclength_m;
  if (std::abs(off) > kPolicy.places.stretch_notable &&
      std::abs(off) * length_m > kPolicy.places.stretch_noises * noise) {
    const bool warn = std::abs(off) > kPolicy.places.stretch_warn &&
                      std::abs(off) * length_m > context.of_length(kPolicy.places.stretched);
    CheckFinding& finding = context.add(
        warn ? Severity::kWarning : Severity::kInformation, "stretched", "",
        fmt::format(
            "at rest the bodies lie {:.1f} % {} apart than the arm file says ({:.1f} mm over {:.0f} mm)",
            100.0 * std::abs(off), off > 0.0 ? "further" : "less far", 1e3 * off * length_m, 1e3 * length_m));
    finding.figure = off;
    finding.unit = "1";
    finding.remedy =
        "measure the arm at rest along its backbone; an arm that is pressurised at rest or stretched by a "
        "payload is longer; otherwise check the mocap's calibration (wand length)";
    finding.setting = stretched_arm(context.arm, stretch);
  }
  say_misplaced(context, places, measured, noise);
}

}  // namespace

Check make_spacing() {
  return {check_spacing, {{"stretched", {}}, {"ring_misplaced", {}}}};
}

}  // namespace softarm::check
