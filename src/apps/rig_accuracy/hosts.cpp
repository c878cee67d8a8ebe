#include "rig_accuracy/hosts.h"

#include <cmath>
#include <stdexcept>

#include "rig_accuracy/paths.h"

namespace softarm::rig_accuracy {
namespace {

using rig::ProgrammePart;

/// To some values and back at each rate, with holds.
rig::Programme cycle(std::vector<double> to, std::vector<double> rates) {
  ProgrammePart part;
  part.kind = ProgrammePart::Kind::kCycle;
  part.to = std::move(to);
  part.rates = std::move(rates);
  part.hold_s = 0.6;
  rig::Programme programme;
  programme.parts = {part};
  programme.repeat = true;
  return programme;
}

/// The same arm in two segments, each with two cables at right angles: those of the second pass through the
/// first.
rig::Scenario in_sections(rig::Scenario scenario) {
  const rig::CableSpec cable = scenario.arm.segments.at(0).cables.at(0);
  rig::SegmentSpec half = scenario.arm.segments.at(0);
  half.length_m *= 0.5;
  half.mass_kg *= 0.5;
  half.cables.clear();
  scenario.name += "_in_sections";
  scenario.arm.segments.assign(2, half);
  scenario.arm.servos = 0;
  for (rig::SegmentSpec& segment : scenario.arm.segments) {
    for (const double azimuth_rad : {0.0, M_PI / 2.0}) {
      segment.cables.push_back(cable);
      segment.cables.back().input = scenario.arm.servos++;
      segment.cables.back().azimuth_rad = azimuth_rad;
      segment.cables.back().spool_radius_m *= 0.5;  // the same curvature
    }
  }
  scenario.angles.programme = cycle({0.6, 0.3, 0.5, 0.4}, {0.3, 0.6});
  return scenario;
}

}  // namespace

std::vector<rig::Scenario> hosts(const std::string& config, double seconds) {
  std::vector<rig::Scenario> all;
  for (const char* name : {"trial_10s", "semi_physical_200mm", "hybrid_85mm", "cable_235mm"}) {
    const std::string file = config + "/scenarios/" + name + ".yaml";
    rig::Scenario scenario = rig::parse_scenario(read(file), file);
    scenario.duration_s = seconds;
    // Gravity out of the plane in which the inputs bend the arm, so that it twists too.
    scenario.mount.q_mocap_base =
        scenario.mount.q_mocap_base * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX());
    if (scenario.pressures.random) {
      // No multiples of a usual dead band: at its very edge rounding would decide what a regulator does.
      scenario.pressures.random.reset();
      scenario.pressures.programme = cycle({41.3e3, 12.7e3, 26.1e3}, {20e3, 60e3});
    }
    if (scenario.angles.random) {
      scenario.angles.random.reset();
      scenario.angles.programme = cycle({0.785}, {0.3, 0.6});
    }
    if (!scenario.vacuum.schedule.empty())
      scenario.vacuum.schedule = {{0.0, {0.0}}, {1.5, {60e3}}, {5.0, {20e3}}, {7.0, {60e3}}};
    if (!scenario.payload.schedule.empty()) {
      const double kg = scenario.angles.rest > 0.0 ? 0.02 : 0.1;
      scenario.payload.schedule = {{0.0, {kg}}, {4.0, {2.0 * kg}}};
    }
    all.push_back(scenario);
  }
  all.push_back(in_sections(all.back()));
  return all;
}

rig::HiddenChoice usual_choice(const rig::HiddenEffect& effect, const std::string& form, double towards_deg) {
  rig::HiddenChoice choice{effect.id, form, {}};
  for (const rig::HiddenParameter& parameter : effect.parameters) {
    if (!parameter.is_of(form)) continue;
    const double low = parameter.usual_low, high = parameter.usual_high;
    double value = low < 0.0 && high > 0.0 ? 0.5 * high : 0.5 * (low + high);
    if (effect.id == "occlusion" && parameter.key == "beyond_deg") value = 10.0;
    if (effect.id == "contact" && parameter.key == "distance_m") value = 0.75 * low + 0.25 * high;
    if (parameter.key == "fold_per_m") value = low;
    if (parameter.whole) value = parameter.otherwise.value_or(low);
    if (parameter.key == "azimuth_deg" || parameter.key == "towards_deg") value = towards_deg;
    choice.values[parameter.key] = value;
  }
  return choice;
}

std::optional<rig::Scenario> hidden_in(rig::Scenario scenario, const rig::HiddenChoice& choice) {
  try {
    rig::hide(choice, scenario);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
  return scenario;
}

}  // namespace softarm::rig_accuracy
