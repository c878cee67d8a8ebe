// Campaigns: what is drawn lies in its ranges, follows from the seed alone, and can be simulated.
#include "rig/campaign.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include "rig/effect_size.h"
#include "rig/simulator.h"
#include "rig/truth_yaml.h"
#include "scenario_text.h"

namespace softarm::rig {
namespace {

using ::testing::HasSubstr;

constexpr char kCampaign[] = R"(format: 1
name: trial
arms: [{scenario: case, arm: online_200mm}]
effects:
  count_weights: [1, 1, 1]
  from: [hysteresis, base_compliance, gain_nonlinearity, pressure_lag]
  size: [0.5, 1]
distractors: {at_most: 2, from: [catalogue], size: 0.1}
arm_spread: {stiffness: 0.1, gain: 0.1, mass: 0.02, length: 0.005}
trials:
  count: 4
  attitudes: [hanging, horizontal]
  speeds: [1, 2]
  seconds: [8, 10]
  pause_s: [60, 90]
  payload_kg: [0.01, 0.1]
mocap: {rate_hz: [60, 240], position_sd_m: [0.0002, 0.0006], orientation_sd_rad: 0.01, dropout_probability: [0, 0.01]}
)";

std::vector<Scenario> campaign_arms() {
  return {parse_scenario(kScenarioText, "case.yaml")};
}

TEST(Campaign, DrawsLieInTheirRanges) {
  const CampaignSpec spec = parse_campaign(kCampaign, "campaign.yaml");
  const std::vector<Scenario> base = campaign_arms();
  std::set<std::size_t> counts;
  std::set<std::uint64_t> seeds;
  std::set<std::string> effects;
  for (int number = 0; number < 200; ++number) {
    const CampaignCase one = draw_case(spec, base, 3, number);
    ASSERT_EQ(one.trials.size(), 4u);
    counts.insert(one.effects.size());
    for (const HiddenChoice& choice : one.effects) {
      effects.insert(choice.effect);
      for (const HiddenParameter& parameter : find_hidden_effect(choice.effect)->parameters) {
        if (!parameter.is_of(choice.form)) continue;
        const double size = std::abs(choice.values.at(parameter.key));
        EXPECT_GE(size, parameter.usual_low * (1.0 - 1e-12)) << choice.effect << ' ' << parameter.key;
        EXPECT_LE(size, parameter.usual_high * (1.0 + 1e-12)) << choice.effect << ' ' << parameter.key;
      }
    }
    EXPECT_LE(one.distractors.size(), 2u);
    for (const HiddenChoice& choice : one.distractors)
      for (const HiddenChoice& effect : one.effects) EXPECT_NE(choice.effect, effect.effect);
    for (std::size_t i = 0; i < one.trials.size(); ++i) {
      const Scenario& trial = one.trials[i];
      seeds.insert(trial.seed);
      EXPECT_EQ(trial.hidden.size(), one.effects.size() + one.distractors.size());
      EXPECT_GE(trial.duration_s, 8.0);
      EXPECT_LE(trial.duration_s, 10.0);
      // One after the other.
      const double before_s = i == 0 ? -60.0 : one.trials[i - 1].session_s + one.trials[i - 1].duration_s;
      EXPECT_GE(trial.session_s, before_s + 60.0);
      EXPECT_LE(trial.session_s, i == 0 ? 0.0 : before_s + 90.0);
      EXPECT_GE(trial.mocap.rate_hz, 60.0);
      EXPECT_LE(trial.mocap.rate_hz, 240.0);
      EXPECT_EQ(trial.payload.schedule.size(), 2u);
      EXPECT_NEAR(trial.pressures.random->highest_hz, (i % 2 + 1) * base[0].pressures.random->highest_hz,
                  1e-12);
      // The same arm in all trials, and not the scenario's.
      EXPECT_EQ(trial.arm.segments[0].stiffness_base_nm2, one.trials[0].arm.segments[0].stiffness_base_nm2);
      EXPECT_NE(trial.arm.segments[0].stiffness_base_nm2, base[0].arm.segments[0].stiffness_base_nm2);
      // Hanging and horizontal in turn: how the base's tangent stands to gravity.
      const double up = (trial.mount.q_mocap_base * Eigen::Vector3d::UnitZ()).z();
      EXPECT_NEAR(up, i % 2 == 0 ? -1.0 : 0.0, 1e-9);
    }
  }
  EXPECT_EQ(counts, (std::set<std::size_t>{0, 1, 2}));
  EXPECT_EQ(effects.size(), 4u);
  EXPECT_EQ(seeds.size(), 800u);
}

TEST(Campaign, ACaseFollowsFromSeedAndNumberAlone) {
  const CampaignSpec spec = parse_campaign(kCampaign, "campaign.yaml");
  const auto text = [&](std::uint64_t seed, int number, int attempt = 0) {
    std::string all;
    for (const Scenario& trial : draw_case(spec, campaign_arms(), seed, number, attempt).trials)
      all += truth_yaml(trial);
    return all;
  };
  EXPECT_EQ(text(1, 7), text(1, 7));
  EXPECT_NE(text(1, 7), text(1, 8));
  EXPECT_NE(text(1, 7), text(2, 7));
  EXPECT_NE(text(1, 7), text(1, 7, 1));
}

TEST(Campaign, CasesCanBeSimulated) {
  const CampaignSpec spec = parse_campaign(kCampaign, "campaign.yaml");
  for (int number = 0; number < 5; ++number) {
    for (const Scenario& trial : draw_case(spec, campaign_arms(), 1, number).trials) {
      Simulator simulator(trial);
      for (int frame = 0; frame < 30; ++frame) ASSERT_TRUE(simulator.next());
    }
  }
}

TEST(Campaign, TruthNamesWhatIsHidden) {
  Scenario scenario = campaign_arms()[0];
  hide({"base_compliance", "", {{"stiffness_nm_per_rad", 6.5}}}, scenario);
  const std::string truth = truth_yaml(scenario);
  EXPECT_THAT(truth, HasSubstr("effect: base_compliance"));
  EXPECT_THAT(truth, HasSubstr("stiffness_nm_per_rad: 6.5"));
  EXPECT_THAT(truth, HasSubstr("stiffness_base_nm2: 0.027"));
  EXPECT_THAT(truth, HasSubstr("seed: 18446744073709551615"));
}

TEST(Campaign, MistakesAreOneLine) {
  struct Mistake {
    std::string from, to;
    std::vector<std::string> says;
  };
  const std::vector<Mistake> mistakes{
      {"format: 1", "format: 2", {"format", "2"}},
      {"name: trial", "name: a b", {"name", "letters"}},
      {"arms: [{scenario: case, arm: online_200mm}]", "arms: []", {"arms", "at least one"}},
      {"from: [hysteresis,", "from: [hysteria,", {"effects.from", "hysteria", "catalogue, outside, all"}},
      {"from: [hysteresis, base_compliance, gain_nonlinearity, pressure_lag]",
       "from: [hysteresis]",
       {"effects.from", "1 effects", "up to 2"}},
      {"count_weights: [1, 1, 1]", "count_weights: [0, 0]", {"effects.count_weights", "above 0"}},
      {"size: [0.5, 1]", "forms: some", {"effects.forms", "some", "any, default, other"}},
      {"size: [0.5, 1]", "apart: [creep]", {"effects.apart", "creep", "two effects"}},
      {"size: [0.5, 1]", "signal: {leftover_snr: [9, 5]}", {"effects.signal.leftover_snr", "larger"}},
      {"size: [0.5, 1]", "signal: {wished: {most_m: 2}}", {"effects.signal.wished.most_m", "2"}},
      {"size: [0.5, 1]",
       "signal: {wished: {noise: 1}}",
       {"effects.signal.wished.noise", "unknown", "least_noise"}},
      {"size: [0.5, 1]", "signal: {wished: {}, raw_snr: 20}", {"effects.signal.raw_snr", "wished"}},
      {"size: [0.5, 1]", "size: [1, 0.5]", {"effects.size", "larger"}},
      {"attitudes: [hanging,", "attitudes: [lying,", {"trials.attitudes", "lying", "horizontal"}},
      {"stiffness: 0.1", "stiffness: 0.9", {"arm_spread.stiffness", "0.9", "0 ... 0.5"}},
      {"speeds: [1, 2]", "speed: [1, 2]", {"trials.speed", "unknown", "speeds"}},
  };
  for (const Mistake& mistake : mistakes) {
    std::string text = kCampaign;
    const std::size_t at = text.find(mistake.from);
    ASSERT_NE(at, std::string::npos) << mistake.from;
    text.replace(at, mistake.from.size(), mistake.to);
    try {
      parse_campaign(text, "campaign.yaml");
      ADD_FAILURE() << "accepted: " << mistake.to;
    } catch (const ScenarioError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      EXPECT_THAT(what, HasSubstr("campaign.yaml: ")) << mistake.to;
      for (const std::string& part : mistake.says) EXPECT_THAT(what, HasSubstr(part)) << mistake.to;
    }
  }
}

constexpr char kKinds[] = R"(
kinds:
  - {kind: nothing, sample: 2, full: 9}
  - kind: two
    sample: 3
    effects:
      count_weights: [0, 0, 1]
      from: [hysteresis, base_compliance, gain_nonlinearity, pressure_lag, creep]
      forms: other
      apart: [hysteresis+pressure_lag, base_compliance+creep]
      signal: {leftover_snr: [5, 8], least_leftover_m: 6.0e-5}
    trials: {count: 2, attitudes: [standing], seconds: 9}
)";

TEST(Campaign, AKindReplacesWhatItSays) {
  const std::string text = std::string(kCampaign) + kKinds;
  const CampaignSpec plain = parse_campaign(text, "campaign.yaml");
  ASSERT_EQ(plain.kinds.size(), 2u);
  EXPECT_EQ(plain.kinds[0].name, "nothing");
  EXPECT_EQ(plain.kinds[0].full, 9);
  EXPECT_EQ(plain.kinds[1].full, 3);  // as the sample
  EXPECT_EQ(plain.trials, 4);
  EXPECT_FALSE(plain.signal);
  EXPECT_EQ(parse_campaign(text, "campaign.yaml", "nothing").trials, 4);
  const CampaignSpec two = parse_campaign(text, "campaign.yaml", "two");
  EXPECT_EQ(two.trials, 2);
  EXPECT_EQ(two.attitudes, std::vector<std::string>{"standing"});
  EXPECT_EQ(two.most_distractors, 2);  // of the document
  ASSERT_TRUE(two.signal);
  EXPECT_EQ(two.signal->leftover_snr.high, 8.0);
  EXPECT_FALSE(two.signal->raw_snr);
  EXPECT_THROW(parse_campaign(text, "campaign.yaml", "three"), ScenarioError);
}

TEST(Campaign, ABackgroundHasSoManyDeparturesAtLeast) {
  std::string text = std::string(kCampaign) + kKinds;
  const std::string plain = "distractors: {at_most: 2, from: [catalogue], size: 0.1}";
  text.replace(text.find(plain), plain.size(),
               "distractors: {at_least: 3, at_most: 5, from: [catalogue], size: 0.1}");
  const std::string signal = "signal: {leftover_snr: [5, 8],";
  text.replace(text.find(signal), signal.size(), signal + " background_m: [2.0e-4, 8.0e-4],");
  const CampaignSpec spec = parse_campaign(text, "campaign.yaml", "two");
  ASSERT_TRUE(spec.signal && spec.signal->background_m);
  EXPECT_EQ(spec.signal->background_m->low, 2e-4);
  EXPECT_EQ(spec.signal->background_m->high, 8e-4);
  std::set<std::size_t> counts;
  for (int number = 0; number < 30; ++number)
    counts.insert(draw_case(spec, campaign_arms(), 5, number).distractors.size());
  EXPECT_EQ(counts, (std::set<std::size_t>{3, 4, 5}));
  text.replace(text.find("at_least: 3"), 11, "at_least: 6");
  EXPECT_THROW(parse_campaign(text, "campaign.yaml"), ScenarioError);
}

TEST(Campaign, SizesMayBeWishedFor) {
  std::string text = std::string(kCampaign) + kKinds;
  EXPECT_FALSE(parse_campaign(text, "campaign.yaml", "two").signal->wished);
  const std::string signal = "signal: {leftover_snr: [5, 8], least_leftover_m: 6.0e-5}";
  text.replace(text.find(signal), signal.size(), "signal: {wished: {least_noise: 0.5, most_m: 2.0e-3}}");
  const CampaignSpec spec = parse_campaign(text, "campaign.yaml", "two");
  ASSERT_TRUE(spec.signal && spec.signal->wished);
  EXPECT_EQ(spec.signal->wished->least_noise, 0.5);
  EXPECT_EQ(spec.signal->wished->most_m, 2e-3);
}

TEST(Campaign, FormsAndPairsAreThoseThatAreAllowed) {
  CampaignSpec spec = parse_campaign(std::string(kCampaign) + kKinds, "campaign.yaml", "two");
  spec.most_distractors = 0;
  for (const FormChoice forms : {FormChoice::kOther, FormChoice::kDefault}) {
    spec.forms = forms;
    for (int number = 0; number < 100; ++number) {
      const CampaignCase one = draw_case(spec, campaign_arms(), 5, number);
      ASSERT_EQ(one.effects.size(), 2u);
      std::set<std::string> ids;
      for (const HiddenChoice& choice : one.effects) {
        ids.insert(choice.effect);
        const HiddenEffect& effect = *find_hidden_effect(choice.effect);
        if (effect.forms.empty()) continue;
        EXPECT_EQ(choice.form == effect.forms.front(), forms == FormChoice::kDefault) << choice.effect;
      }
      EXPECT_NE(ids, (std::set<std::string>{"hysteresis", "pressure_lag"}));
      EXPECT_NE(ids, (std::set<std::string>{"base_compliance", "creep"}));
      ASSERT_EQ(one.plain.size(), one.trials.size());
      EXPECT_TRUE(one.plain[0].hidden.empty());
      EXPECT_EQ(one.plain[0].seed, one.trials[0].seed);
    }
  }
}

TEST(Campaign, ColouredNoiseIsOnEveryRing) {
  std::string text = kCampaign;
  text.replace(text.find("dropout_probability: [0, 0.01]"), 30,
               "slow_position_sd_m: [1.0e-5, 2.0e-5], slow_correlation_s: 2");
  for (const Scenario& trial :
       draw_case(parse_campaign(text, "campaign.yaml"), campaign_arms(), 1, 0).plain) {
    ASSERT_EQ(trial.sensors.correlated_noise.size(), trial.mocap.ring_fractions.size());
    for (const CorrelatedNoise& noise : trial.sensors.correlated_noise) {
      EXPECT_GE(noise.sd.position_sd_m, 1e-5);
      EXPECT_LE(noise.sd.position_sd_m, 2e-5);
      EXPECT_EQ(noise.correlation_s, 2.0);
    }
  }
}

TEST(Campaign, EffectsAreScaledByWhatMakesThemLarger) {
  const HiddenChoice soft{"base_compliance", "", {{"stiffness_nm_per_rad", 6.0}}};
  EXPECT_DOUBLE_EQ(scaled(soft, 2.0).values.at("stiffness_nm_per_rad"), 3.0);
  const HiddenChoice tilt{"base_tilt", "", {{"angle_deg", 1.0}, {"azimuth_deg", 77.0}}};
  EXPECT_DOUBLE_EQ(scaled(tilt, 0.1).values.at("angle_deg"), 0.1);
  EXPECT_DOUBLE_EQ(scaled(tilt, 0.1).values.at("azimuth_deg"), 77.0);
  EXPECT_DOUBLE_EQ(scaled(tilt, 1e9).values.at("angle_deg"), 60.0);  // most that is allowed
  const HiddenChoice spot{
      "soft_spot", "even", {{"centre_fraction", 0.4}, {"width_fraction", 0.2}, {"share", -0.3}}};
  EXPECT_DOUBLE_EQ(scaled(spot, 0.5).values.at("share"), -0.15);
  EXPECT_DOUBLE_EQ(scaled(spot, 0.5).values.at("centre_fraction"), 0.4);
  // Every effect of the catalogue has a size, whichever form it takes.
  for (const HiddenEffect& effect : hidden_effects()) {
    for (const std::string& form : effect.forms.empty() ? std::vector<std::string>{""} : effect.forms) {
      for (const std::string& key : size_of(effect, form).keys)
        EXPECT_TRUE(std::any_of(effect.parameters.begin(), effect.parameters.end(),
                                [&](const HiddenParameter& p) { return p.key == key && p.is_of(form); }))
            << effect.id << ' ' << key;
      if (effect.catalogued) {
        EXPECT_FALSE(size_of(effect, form).keys.empty()) << effect.id << ' ' << form;
      }
    }
  }
}

TEST(Campaign, ShippedCampaignsAreRead) {
  for (const char* name :
       {"development", "proof_development", "proof_final", "untidy_development", "untidy_final"}) {
    const std::string path = std::string(SOFTARM_SOURCE_DIR) + "/config/campaigns/" + name + ".yaml";
    std::ifstream file(path);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const CampaignSpec spec = parse_campaign(text, path);
    for (const CampaignKind& kind : spec.kinds) {
      const CampaignSpec of_kind = parse_campaign(text, path, kind.name);
      EXPECT_EQ(of_kind.trials, 9) << name << ' ' << kind.name;
      EXPECT_LE(kind.sample, kind.full);
    }
    EXPECT_EQ(spec.kinds.empty(), std::string(name) == "development");
  }
}

TEST(Campaign, ATrialTooShortForItsDrivesIsRefused) {
  std::string text = kCampaign;
  text.replace(text.find("[8, 10]"), 7, "[2, 3]");
  EXPECT_THROW(draw_case(parse_campaign(text, "campaign.yaml"), campaign_arms(), 1, 0),
               std::invalid_argument);
}

}  // namespace
}  // namespace softarm::rig
