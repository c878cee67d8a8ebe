#include "campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "effect_size.h"
#include "random_stream.h"
#include "scenario_parts.h"

namespace softarm::rig {
namespace {

constexpr std::uint64_t kCasePurpose = 0x63617365;
constexpr int kDraws = 5;

double drawn(const Span& span, RandomStream& random) {
  return random.uniform(span.low, span.high);
}

std::size_t drawn_index(std::size_t count, RandomStream& random) {
  return std::min(count - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(count)));
}

/// A place within a parameter's usual range: sizes that span more than a factor of three evenly in their
/// logarithm.
double usual(const HiddenParameter& parameter, double place) {
  const double low = parameter.usual_low, high = parameter.usual_high;
  if (parameter.whole) return std::min(high, low + std::floor(place * (high - low + 1.0)));
  if (low > 0.0 && high > 3.0 * low) return low * std::pow(high / low, place);
  return low + place * (high - low);
}

/// A size of either sign is given by its largest on both sides: no smaller than a fifth of that.
double usual_size(const HiddenParameter& parameter, double place) {
  if (parameter.usual_low < 0.0 && parameter.usual_high > 0.0)
    return (0.2 + 0.8 * place) * parameter.usual_high;
  return usual(parameter, place);
}

std::string drawn_form(const HiddenEffect& effect, FormChoice choice, RandomStream& random) {
  if (effect.forms.empty()) return "";
  if (choice == FormChoice::kDefault || effect.forms.size() == 1) return effect.forms.front();
  const std::size_t from = choice == FormChoice::kOther ? 1 : 0;
  return effect.forms[from + drawn_index(effect.forms.size() - from, random)];
}

/// @param size_place where in its usual range the size lies
/// @param scale of the size: below 1, an effect that is too small to matter
HiddenChoice draw_choice(const HiddenEffect& effect, FormChoice forms, double size_place, double scale,
                         RandomStream& random) {
  HiddenChoice choice;
  choice.effect = effect.id;
  choice.form = drawn_form(effect, forms, random);
  const std::vector<std::string> sizes = size_of(effect, choice.form).keys;
  for (const HiddenParameter& parameter : effect.parameters) {
    const double place = random.uniform(), sign = random.uniform() < 0.5 ? -1.0 : 1.0;
    const bool is_size = std::find(sizes.begin(), sizes.end(), parameter.key) != sizes.end();
    double value = is_size ? usual_size(parameter, size_place) : usual(parameter, place);
    if (is_size && parameter.low <= -value) value *= sign;  // usual sizes are given on one side
    if (parameter.is_of(choice.form)) choice.values[parameter.key] = value;
  }
  return scale == 1.0 ? choice : scaled(choice, scale);
}

bool kept_apart(const CampaignSpec& spec, const std::string& a, const std::string& b) {
  return std::any_of(spec.apart.begin(), spec.apart.end(), [&](const auto& pair) {
    return (pair.first == a && pair.second == b) || (pair.first == b && pair.second == a);
  });
}

/// Draws effects one by one and hides them in all trials; those that do not fit the arm are passed over.
std::vector<HiddenChoice> hide_some(const CampaignSpec& spec, std::vector<std::string> from,
                                    std::size_t count, const Span& size, double scale,
                                    std::vector<Scenario>& trials, RandomStream& random) {
  std::vector<HiddenChoice> hidden;
  while (hidden.size() < count && !from.empty()) {
    const std::size_t i = drawn_index(from.size(), random);
    const HiddenEffect& effect = *find_hidden_effect(from[i]);
    from.erase(from.begin() + static_cast<std::ptrdiff_t>(i));
    if (std::any_of(hidden.begin(), hidden.end(),
                    [&](const HiddenChoice& other) { return kept_apart(spec, effect.id, other.effect); }))
      continue;
    const double place = drawn(size, random), factor = scale < 1.0 ? scale * random.uniform() : 1.0;
    // This arm may have no tendons, no vacuum, ...; or fewer chambers than the drawn number.
    for (int draw = 0; draw < kDraws; ++draw) {
      const HiddenChoice choice = draw_choice(effect, spec.forms, place, factor, random);
      std::vector<Scenario> with = trials;
      try {
        for (Scenario& trial : with) hide(choice, trial);
      } catch (const std::invalid_argument&) {
        continue;
      }
      trials = std::move(with);
      hidden.push_back(choice);
      break;
    }
  }
  return hidden;
}

/// The true arm of a case: no two that were made alike are alike.
void spread_constants(const CampaignSpec& spec, ArmSpec& arm, RandomStream& random) {
  const auto factor = [&](double sd) { return std::exp(sd * random.normal()); };
  for (SegmentSpec& segment : arm.segments) {
    const double stiffness = factor(spec.stiffness_spread);
    segment.stiffness_base_nm2 *= stiffness;
    segment.stiffness_per_min_nm2_per_pa *= stiffness;
    segment.stiffness_per_jamming_nm2_per_pa *= stiffness;
    for (StiffnessGrowth& growth : segment.stiffness_growth) growth.added_nm2 *= stiffness;
    segment.torsional_stiffness_nm2 *= stiffness;
    for (StiffnessAtPressure& knot : segment.stiffness_by_pressure) knot.bending_stiffness_nm2 *= stiffness;
    segment.mass_kg *= factor(spec.mass_spread);
    segment.length_m *= factor(spec.length_spread);
    for (ChamberSpec& chamber : segment.chambers) chamber.moment_gain_nm_per_pa *= factor(spec.gain_spread);
    for (CableSpec& cable : segment.cables) cable.spool_radius_m *= factor(spec.gain_spread);
  }
}

/// A draw of one trial's seed, protocol and sensors.
Scenario draw_trial(const CampaignSpec& spec, const Scenario& arm, int trial, RandomStream& random) {
  Scenario scenario = arm;
  scenario.seed = static_cast<std::uint64_t>(random.uniform() * 0x1.0p53);
  const auto round = [trial](std::size_t count) { return static_cast<std::size_t>(trial) % count; };
  const double speed = spec.speeds[round(spec.speeds.size())];
  const double turn = random.uniform(0.0, 2.0 * M_PI);
  scenario.mount.q_mocap_base = *attitude_named(spec.attitudes[round(spec.attitudes.size())]) *
                                Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  for (DriveSpec* drive :
       {static_cast<DriveSpec*>(&scenario.pressures), &scenario.tensions, &scenario.angles}) {
    if (!drive->random) continue;
    drive->random->lowest_hz *= speed;
    drive->random->highest_hz *= speed;
  }
  scenario.duration_s = drawn(spec.seconds, random);
  if (const double least_s = least_duration(scenario).first; scenario.duration_s < least_s)
    throw std::invalid_argument(
        fmt::format("campaign {}: trials.seconds is {:.3g}, scenario {} needs {} at least", spec.name,
                    scenario.duration_s, arm.name, least_s));
  const double payload_kg = drawn(spec.payload_kg, random);
  scenario.payload.repeat_s = 0.0;
  scenario.payload.publish = true;
  scenario.payload.schedule.clear();
  if (spec.payload_kg.high > 0.0)
    scenario.payload.schedule = {{0.0, {0.0}}, {0.25 * scenario.duration_s, {payload_kg}}};
  scenario.mocap.rate_hz = std::round(drawn(spec.mocap_rate_hz, random));
  scenario.mocap.ring_noise = {drawn(spec.position_sd_m, random), drawn(spec.orientation_sd_rad, random)};
  scenario.mocap.dropout_probability = drawn(spec.dropout_probability, random);
  if (spec.slow_position_sd_m.high > 0.0) {
    const double sd_m = drawn(spec.slow_position_sd_m, random);
    const double correlation_s = drawn(spec.slow_correlation_s, random);
    for (std::size_t ring = 1; ring <= scenario.mocap.ring_fractions.size(); ++ring)
      scenario.sensors.correlated_noise.push_back({static_cast<int>(ring), {sd_m, 0.0}, correlation_s});
  }
  return scenario;
}

}  // namespace

CampaignCase draw_case(const CampaignSpec& spec, const std::vector<Scenario>& arms, std::uint64_t seed,
                       int number, int attempt) {
  RandomStream random(seed, kCasePurpose + 0x10000ULL * static_cast<std::uint64_t>(number) +
                                0x1000000000000ULL * static_cast<std::uint64_t>(attempt));
  CampaignCase drawn_case;
  drawn_case.arm = drawn_index(arms.size(), random);
  Scenario arm = arms[drawn_case.arm];
  spread_constants(spec, arm.arm, random);
  double begin_s = 0.0;
  for (int trial = 0; trial < spec.trials; ++trial) {
    drawn_case.trials.push_back(draw_trial(spec, arm, trial, random));
    drawn_case.trials.back().session_s = begin_s;
    begin_s += drawn_case.trials.back().duration_s;
    if (spec.pause_s.high > 0.0) begin_s += drawn(spec.pause_s, random);
  }

  drawn_case.plain = drawn_case.trials;
  double total = 0.0;
  for (double weight : spec.effect_count_weights) total += weight;
  double place = total * random.uniform();
  std::size_t count = 0;
  while (count + 1 < spec.effect_count_weights.size() && place >= spec.effect_count_weights[count])
    place -= spec.effect_count_weights[count++];
  drawn_case.effects = hide_some(spec, spec.effects, count, spec.effect_size, 1.0, drawn_case.trials, random);
  if (drawn_case.effects.size() < count)
    throw std::invalid_argument(fmt::format("campaign {}: scenario {} takes {} of the effects, {} were drawn",
                                            spec.name, arm.name, drawn_case.effects.size(), count));
  std::vector<std::string> others;
  for (const std::string& id : spec.distractors)
    if (std::none_of(drawn_case.effects.begin(), drawn_case.effects.end(),
                     [&](const HiddenChoice& effect) { return effect.effect == id; }))
      others.push_back(id);
  const std::size_t distractors =
      static_cast<std::size_t>(spec.fewest_distractors) +
      drawn_index(static_cast<std::size_t>(spec.most_distractors - spec.fewest_distractors) + 1, random);
  drawn_case.distractors =
      hide_some(spec, others, distractors, {0.0, 0.0}, spec.distractor_size, drawn_case.trials, random);
  return drawn_case;
}

}  // namespace softarm::rig
