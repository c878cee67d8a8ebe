// What can be hidden in body and inputs, on arms of several segments, with tendons and with a cable: taken or
// refused in a line, and where it is taken the arm moves otherwise and nothing blows up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#include "rig/hidden.h"
#include "rig/simulator.h"

namespace softarm::rig {
namespace {

constexpr double kSeconds = 2.0;
constexpr double kMovesM = 1e-5;
/// Of arms below half a kilogram and half a metre.
constexpr double kMostJ = 3.0, kMostReachM = 0.5;

/// A shipped arm that is driven fast enough to show something in two seconds, coarse to be cheap.
Scenario lively(const std::string& name) {
  const std::string file = std::string(SOFTARM_SOURCE_DIR) + "/config/scenarios/" + name + ".yaml";
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  Scenario s = parse_scenario(text.str(), file);
  s.duration_s = kSeconds;
  s.session_s = 600.0;  // something has drifted
  s.mocap.rate_hz = 100.0;
  s.numerics = {3, 0.005};
  // Gravity out of the plane in which a cable bends the arm, so that it twists too.
  s.mount.q_mocap_base =
      s.mount.q_mocap_base * Eigen::AngleAxisd(0.5, Eigen::Vector3d(1.0, 1.0, 0.0).normalized());
  for (DriveSpec* drive : {static_cast<DriveSpec*>(&s.pressures), &s.tensions, &s.angles}) {
    drive->settle_s = 0.1;
    drive->ramp_s = 0.4;
    drive->random.reset();
  }
  if (s.arm.chambers > 0) {
    const auto count = static_cast<std::size_t>(s.arm.chambers);
    std::vector<double> all(count, 10e3), none(count, 5e3);
    all[0] = 40e3;
    s.pressures.schedule = {{0.0, none}, {0.3, all}, {1.2, none}};
  }
  if (s.arm.tendons > 0) {
    const auto count = static_cast<std::size_t>(s.arm.tendons);
    std::vector<double> pull(count, 0.5);
    pull[0] = 3.0;
    s.tensions.schedule = {
        {0.0, std::vector<double>(count, 0.2)}, {0.3, pull}, {1.2, std::vector<double>(count, 0.5)}};
  }
  if (s.arm.servos > 0) s.angles.schedule = {{0.0, {0.175}}, {0.3, {0.7}}, {1.2, {0.4}}};
  if (!s.payload.schedule.empty()) s.payload.schedule = {{0.0, {0.02}}, {0.8, {0.04}}};
  return s;
}

const std::vector<std::string>& arms() {
  static const std::vector<std::string> names{"two_segment", "hybrid_85mm", "cable_235mm"};
  return names;
}

/// Effects of the body and the inputs: the table ends with those of the sensors.
std::vector<HiddenEffect> arm_effects() {
  const std::vector<HiddenEffect>& all = hidden_effects();
  const HiddenEffect* sensors = find_hidden_effect("correlated_noise");
  return {all.begin(), all.begin() + (sensors - all.data())};
}

std::vector<std::string> forms_of(const HiddenEffect& effect) {
  return effect.forms.empty() ? std::vector<std::string>{""} : effect.forms;
}

/// As strong as is usual; a wall as near as usual, in the arm's way.
HiddenChoice strong(const HiddenEffect& effect, const std::string& form, double towards_deg) {
  HiddenChoice choice{effect.id, form, {}};
  for (const HiddenParameter& p : effect.parameters) {
    if (!p.is_of(form)) continue;
    double value = std::abs(p.usual_low) > std::abs(p.usual_high) ? p.usual_low : p.usual_high;
    if (p.key == "stiffness_nm_per_rad" || p.key == "over_s") value = p.usual_low;
    if (p.whole) value = p.otherwise.value_or(p.usual_low);
    if (p.key == "azimuth_deg") value = towards_deg;
    if (p.key == "distance_m" || p.key == "fold_per_m") value = p.usual_low;
    choice.values[p.key] = value;
  }
  return choice;
}

std::vector<Sample> run(const Scenario& scenario) {
  std::vector<Sample> samples;
  try {
    Simulator simulator(scenario);
    while (auto sample = simulator.next()) samples.push_back(std::move(*sample));
  } catch (const SimulationError& error) {
    ADD_FAILURE() << error.what();
  }
  return samples;
}

double farthest_deg(const std::vector<Sample>& samples) {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  for (const Sample& sample : samples)
    if (sample.truth.tip_base.p.head<2>().norm() > tip.head<2>().norm()) tip = sample.truth.tip_base.p;
  return std::atan2(tip.y(), tip.x()) * 180.0 / M_PI;
}

/// Most that a ring, or the payload that is made known, is elsewhere.
double difference(const std::vector<Sample>& a, const std::vector<Sample>& b) {
  double most = a.size() == b.size() ? 0.0 : 1e9;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    for (std::size_t i = 0; i < a[k].truth.rings_base.size(); ++i)
      most = std::max(most, (a[k].truth.rings_base[i].p - b[k].truth.rings_base[i].p).norm());
  return most;
}

bool tells_another_payload(const std::vector<Sample>& a, const std::vector<Sample>& b) {
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    if (a[k].payload && b[k].payload && a[k].payload->kg != b[k].payload->kg) return true;
  return false;
}

void expect_sane(const std::vector<Sample>& samples) {
  ASSERT_EQ(samples.size(), 201u);
  for (const Sample& sample : samples) {
    // NaN fails all of these.
    ASSERT_LT(std::abs(sample.truth.energy_j), kMostJ) << sample.stamp_s;
    for (const Pose& ring : sample.truth.rings_base) {
      ASSERT_LT(ring.p.norm(), kMostReachM) << sample.stamp_s;
      ASSERT_NEAR(ring.q.norm(), 1.0, 1e-9) << sample.stamp_s;
    }
    for (const auto& segment : sample.truth.segments) {
      ASSERT_GT(segment.bending_stiffness_nm2, 0.0);
      ASSERT_GT(segment.length_m, 0.0);
    }
  }
}

/// What an arm refuses for the lack of something, or because it has it already; the rest it must take.
std::set<std::string> refused_by(const std::string& arm) {
  std::set<std::string> refused{"jamming_law", "jamming_memory",    "jamming_settling", "jamming_yield",
                                "vacuum_gain", "vacuum_shortening", "tendon_length"};
  if (arm != "cable_235mm") refused.insert("tendon_slack");
  if (arm == "two_segment") refused.insert("axial_compliance");
  if (arm == "hybrid_85mm") refused.insert({"axial_compliance", "shear", "payload_offset", "payload_scale"});
  if (arm == "cable_235mm")
    refused.insert({"shear", "line_delay", "axial_memory", "pressure_elongation", "pressure_lag",
                    "pressure_leak", "pressure_stiffening", "radial_expansion", "regulator_error",
                    "flow_limit", "supply_ripple", "valve_stiction", "tendon_friction", "torsion pressure",
                    "torsion tension"});
  if (arm != "two_segment")  // no chambers that bend it, or a single one
    refused.insert(
        {"chamber_bulge", "chamber_mismatch", "gain_nonlinearity", "pressure_dead_zone", "supply_sag"});
  return refused;
}

TEST(HiddenOnArms, EveryEffectIsTakenOrRefusedInALineAndMovesTheArm) {
  for (const std::string& arm : arms()) {
    const Scenario scenario = lively(arm);
    const std::vector<Sample> ideal = run(scenario);
    expect_sane(ideal);
    std::set<std::string> refused;
    for (const HiddenEffect& effect : arm_effects())
      for (const std::string& form : forms_of(effect)) {
        SCOPED_TRACE(arm + ": " + effect.id + " " + form);
        Scenario with = scenario;
        try {
          hide(strong(effect, form, farthest_deg(ideal)), with);
        } catch (const std::invalid_argument& error) {
          EXPECT_GT(std::string(error.what()).size(), 10u);
          EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
          refused.insert(effect.id == "torsion" ? effect.id + " " + form : effect.id);
          continue;
        }
        // An arm that hits a rough wall needs the steps that are usual.
        Scenario without = scenario;
        if (with.body.wall)
          with.numerics.max_step_s = without.numerics.max_step_s = NumericsSpec{}.max_step_s;
        const std::vector<Sample> other = with.body.wall ? run(without) : ideal;
        const std::vector<Sample> samples = run(with);
        expect_sane(samples);
        if (effect.id == "payload_scale")
          EXPECT_TRUE(tells_another_payload(samples, other));
        else
          EXPECT_GT(difference(samples, other), kMovesM);
      }
    EXPECT_THAT(refused, testing::ContainerEq(refused_by(arm))) << arm;
  }
}

/// A number in [0, below), the same everywhere.
std::size_t below(std::size_t count, std::mt19937_64& random) {
  return static_cast<std::size_t>(random() % count);
}

/// Two of these, each as strong as may be, leave nothing that holds a bent arm.
bool softens(const std::string& effect) {
  return effect == "kink" || effect == "curvature_softening";
}

TEST(HiddenOnArms, SeveralEffectsAtOnce) {
  constexpr int kDraws = 3;
  constexpr std::size_t kAtOnce = 4;
  const std::vector<HiddenEffect> effects = arm_effects();
  std::mt19937_64 random(20);
  for (const std::string& arm : arms()) {
    const Scenario scenario = lively(arm);
    const std::vector<Sample> ideal = run(scenario);
    for (int draw = 0; draw < kDraws; ++draw) {
      Scenario with = scenario;
      std::string trace = arm;
      for (int tries = 0; with.hidden.size() < kAtOnce && tries < 100; ++tries) {
        const HiddenEffect& effect = effects[below(effects.size(), random)];
        const std::vector<std::string> forms = forms_of(effect);
        const std::string& form = forms[below(forms.size(), random)];
        if (softens(effect.id) && std::any_of(with.hidden.begin(), with.hidden.end(),
                                              [](const HiddenChoice& one) { return softens(one.effect); }))
          continue;
        Scenario more = with;
        try {
          hide(strong(effect, form, farthest_deg(ideal)), more);
        } catch (const std::invalid_argument&) {
          continue;
        }
        with = more;
        trace += ", " + effect.id + " " + form;
      }
      SCOPED_TRACE(trace);
      if (with.body.wall) with.numerics.max_step_s = NumericsSpec{}.max_step_s;
      ASSERT_EQ(with.hidden.size(), kAtOnce);
      const std::vector<Sample> samples = run(with);
      expect_sane(samples);
      EXPECT_GT(difference(samples, ideal), kMovesM);
    }
  }
}

}  // namespace
}  // namespace softarm::rig
