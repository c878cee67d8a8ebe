// Effects of arm files against the catalogue.
#include "softarm/effects/arm_effects.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <string>

#include "drive_trials.h"
#include "effects/catalogue.h"
#include "softarm/arm/arm_file.h"

namespace softarm::effects::testing {
namespace {

std::string refusal(const arm::Arm& arm, const arm::EffectEntry& entry) {
  try {
    effects::effects_of(arm, {entry});
  } catch (const arm::ArmError& error) {
    return error.what();
  }
  return "";
}

TEST(ArmEffects, EveryEffectOfTheCatalogueComesBackAsItWas) {
  const arm::Arm arm = shipped_arm("online_200mm");
  int checked = 0;
  for (const auto& effect : effects::catalogue()) {
    if (!effect->applies_to(arm)) continue;
    const model::Present present{
        effect.get(), effect->grid(arm, model::FineRod(arm)).front() + usual(*effect) - usual(*effect, 0.0)};
    arm::EffectEntry entry = effects::entry_of(present);
    if (!refusal(arm, entry).empty()) continue;  // a usual size beyond the arm, in an effect for longer ones
    const std::vector<model::Present> again = effects::effects_of(arm, {entry});
    ASSERT_EQ(again.size(), 1u);
    EXPECT_EQ(again[0].effect, effect.get());
    EXPECT_EQ(again[0].values, present.values) << effect->info().id;
    ++checked;
  }
  EXPECT_GE(checked, 30);
}

TEST(ArmEffects, EachSaysItsLaw) {
  std::set<std::string> laws;
  for (const auto& effect : effects::catalogue()) {
    EXPECT_FALSE(effect->info().law.empty()) << effect->info().id;
    EXPECT_TRUE(laws.insert(effect->info().law).second) << effect->info().id;
  }
}

TEST(ArmEffects, OneSaysHowFarTheClocksAreApart) {
  int of_clocks = 0;
  for (const auto& effect : effects::catalogue()) {
    const model::Info& info = effect->info();
    if (!info.of_clocks) continue;
    ++of_clocks;
    EXPECT_EQ(info.sizes, 1) << info.id;
    EXPECT_EQ(info.parameters.at(0).unit, "s") << info.id;
  }
  EXPECT_EQ(of_clocks, 1);
}

TEST(ArmEffects, OneSaysHowFastTheClocksDriftAndThatIsNoDelay) {
  int of_clock_rates = 0;
  for (const auto& effect : effects::catalogue()) {
    const model::Info& info = effect->info();
    if (!info.of_clock_rates) continue;
    ++of_clock_rates;
    EXPECT_EQ(info.sizes, 2) << info.id;
    EXPECT_EQ(info.parameters.at(0).unit, "1") << info.id;
    EXPECT_EQ(info.parameters.at(1).unit, "s") << info.id;
    EXPECT_FALSE(info.of_clocks || info.delays) << info.id;
  }
  EXPECT_EQ(of_clock_rates, 1);
}

TEST(ArmEffects, WhatIsLeftOutIsUsualAndSizesAreNought) {
  const arm::Arm arm = shipped_arm("online_200mm");
  const std::vector<model::Present> list =
      effects::effects_of(arm, {{"creep", {{"share", 0.2}}}, {"tether", {}}});
  EXPECT_DOUBLE_EQ(list[0].values[1], list[0].effect->info().parameters[1].usual);
  EXPECT_DOUBLE_EQ(list[1].values[0], 0.0);
}

/// Of before a contact could be all along a stretch, and of before it could be a round post.
TEST(ArmEffects, AContactOfAnOldFileTouchesAtOnePlace) {
  const std::string path = ::testing::TempDir() + "old_contact.yaml";
  for (const std::string more : {", friction: 0.3", ", friction: 0.3, curvature_per_m: 25"}) {
    std::ifstream in(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/online_200mm.yaml");
    std::ofstream(path) << in.rdbuf() << "effects: [{id: contact, parameters: {stiffness_n_per_m: 80, "
                        << "place_m: 0.15, azimuth_rad: 0.3, distance_m: 0.01" << more << "}}]\n";
    const arm::Arm arm = arm::load_arm_file(path);
    const std::vector<model::Present> list = effects::load_effects(arm, path);
    ASSERT_EQ(list.size(), 1u);
    const model::Info& info = list[0].effect->info();
    ASSERT_EQ(info.parameters.back().symbol, "extent_m");
    EXPECT_EQ(list[0].values[list[0].values.size() - 1], 0.0);
    EXPECT_EQ(list[0].effect->held_places_m(model::FineRod(arm), list[0].values), std::vector<double>{0.15});
  }
}

TEST(ArmEffects, AnEntrySaysWhichOfItsNumbersAreNotFitted) {
  const arm::Arm arm = shipped_arm("online_200mm");
  const model::Present contact = effects::effects_of(arm, {{"contact", {{"extent_m", 0.08}}}}).at(0);
  for (const arm::EffectNumber& number : effects::entry_of(contact).numbers)
    EXPECT_EQ(number.fitted, number.name != "extent_m") << number.name;
}

TEST(ArmEffects, StandardDeviationsComeAlongAndBack) {
  const arm::Arm arm = shipped_arm("online_200mm");
  const arm::EffectEntry entry{"creep", {{"share", 0.2, 0.03}, {"time_s", 5.0}}};
  const model::Present present = effects::effects_of(arm, {entry}).at(0);
  ASSERT_EQ(present.sd.size(), 4);
  EXPECT_DOUBLE_EQ(present.sd[0], 0.03);
  EXPECT_DOUBLE_EQ(present.sd[1], 0.0);
  const arm::EffectEntry again = effects::entry_of(present);
  EXPECT_DOUBLE_EQ(again.numbers.at(0).sd.value(), 0.03);
  EXPECT_FALSE(again.numbers.at(1).sd);
}

TEST(ArmEffects, CorrelationsComeAlongAndBack) {
  const arm::Arm arm = shipped_arm("online_200mm");
  // Numbers of one effect, and of two; the entries need not have all parameters, nor in their order.
  const std::vector<arm::EffectEntry> entries{
      {"creep", {{"time_s", 5.0, 1.0, {{0, "share", 0.6}, {1, "mass_kg", -0.3}}}, {"share", 0.2, 0.03}}},
      {"tip_mass", {{"mass_kg", 0.1, 0.02, {{0, "share", -0.83}}}}},
      {"base_compliance", {{"compliance_rad_per_nm", 0.3, 0.02}}}};
  const std::vector<model::Present> effects = effects_of(arm, entries);
  EXPECT_NEAR(model::correlation(effects[0], 0, effects[0], 1), 0.6, 1e-12);
  EXPECT_NEAR(model::correlation(effects[0], 1, effects[1], 0), -0.3, 1e-12);
  EXPECT_NEAR(model::correlation(effects[1], 0, effects[0], 0), -0.83, 1e-12);
  EXPECT_NEAR(model::correlation(effects[0], 0, effects[0], 0), 1.0, 1e-12);
  EXPECT_EQ(model::correlation(effects[0], 0, effects[2], 0), 0.0);
  EXPECT_EQ(model::correlation(effects[0], 2, effects[1], 0), 0.0);
  const std::vector<model::Present> again = effects_of(arm, entries_of(effects));
  for (std::size_t a = 0; a < effects.size(); ++a) {
    for (std::size_t b = 0; b < effects.size(); ++b) {
      for (Eigen::Index i = 0; i < effects[a].values.size(); ++i) {
        for (Eigen::Index j = 0; j < effects[b].values.size(); ++j)
          EXPECT_NEAR(model::correlation(again[a], i, again[b], j),
                      model::correlation(effects[a], i, effects[b], j), 1e-12);
      }
    }
  }
  // Without any there is nothing to carry.
  EXPECT_EQ(effects_of(arm, {{"creep", {{"share", 0.2, 0.03}}}}).at(0).correlated.size(), 0);
}

TEST(ArmEffects, CorrelationsThatCannotBeAreRefused) {
  const arm::Arm arm = shipped_arm("online_200mm");
  const auto refused = [&](const std::vector<arm::EffectCorrelation>& correlations, const char* says) {
    std::vector<arm::EffectEntry> entries{{"creep", {{"share", 0.2, 0.03}, {"time_s", 5.0, 1.0}}},
                                          {"tip_mass", {{"mass_kg", 0.1, 0.02}}}};
    entries[0].numbers[0].correlations = correlations;
    try {
      effects_of(arm, entries);
      ADD_FAILURE() << says;
    } catch (const arm::ArmError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  };
  refused({{5, "mass_kg", 0.5}}, "there are 2 effects");
  refused({{1, "mass", 0.5}}, "tip_mass.mass is no parameter with a standard deviation");
  refused({{1, "mass_kg", -1.5}}, "value -1.5 is outside the allowed range [-1, 1]");
  refused({{0, "share", 0.5}}, "creep.share is correlated with itself");
  refused({{1, "mass_kg", 0.5}, {1, "mass_kg", 0.5}}, "is given twice");
  refused({{1, "mass_kg", 0.9}, {0, "time_s", 0.9}}, "cannot be correlated so all at once");
}

TEST(ArmEffects, AnUnknownVerdictIsADoubt) {
  const std::string path = ::testing::TempDir() + "doubted_arm.yaml";
  const auto doubt = [&](const std::string& more) {
    std::ifstream in(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/online_200mm.yaml");
    std::ofstream(path) << in.rdbuf() << more;
    return effects::doubt_about_effects(path);
  };
  const std::string effect = "effects: [{id: creep, parameters: {share: 0.2}}]\n";
  EXPECT_EQ(doubt(""), "");
  EXPECT_EQ(doubt("effects_verdict: unknown\n"), "") << "of no effects";
  EXPECT_EQ(doubt(effect), "");
  EXPECT_EQ(doubt("effects_verdict: explained\n" + effect), "");
  EXPECT_NE(doubt("effects_verdict: unknown\n" + effect).find("something else is there"), std::string::npos);
  EXPECT_NE(doubt("effects_verdict: cannot_tell\n" + effect).find("probably not what is there"),
            std::string::npos);
}

TEST(ArmEffects, WhatTheCatalogueDoesNotKnowIsOneLine) {
  const arm::Arm arm = shipped_arm("online_200mm");
  const struct {
    arm::EffectEntry entry;
    std::string says;
  } cases[] = {
      {{"base_complaince", {}, "arm.yaml:9"},
       "arm.yaml:9: key 'effects[0].id': value 'base_complaince' is no effect of the catalogue; did you mean "
       "'base_compliance'?"},
      {{"tendon_friction", {{"coefficient", 0.1}}, "arm.yaml:9"}, "is not for this arm"},
      {{"base_compliance", {{"compliance", 0.1}}, "arm.yaml:9"},
       "key 'effects[0].parameters.compliance': unknown key"},
      {{"base_compliance", {{"compliance_rad_per_nm", 11.0}}, "arm.yaml:9"},
       "value 11 is outside the allowed range [0, 10] rad/(N m)"},
      {{"marker_slip", {{"x_m", 1e-3}}, "arm.yaml:9"}, "key 'effects[0].parameters.body': is missing"},
      {{"marker_slip", {{"x_m", 1e-3}, {"body", 5.0}}, "arm.yaml:9"},
       "value 5 is outside the allowed range [1, 4]"},
      {{"marker_slip", {{"x_m", 1e-3}, {"body", 2.0, 0.5}}, "arm.yaml:9"},
       "key 'effects[0].sd.body': value 0.5: it is an index"},
      {{"marker_slip", {{"x_m", 1e-3}, {"body", 1.5}}, "arm.yaml:9"}, "value 1.5 is not an integer"},
      {{"chamber_mismatch", {{"share", 0.1}, {"chamber", 4.0}}, "arm.yaml:9"}, "[1, 3]"},
  };
  for (const auto& c : cases) {
    const std::string message = refusal(arm, c.entry);
    EXPECT_NE(message.find(c.says), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace softarm::effects::testing
