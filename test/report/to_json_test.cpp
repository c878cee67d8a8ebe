// report.json against its contract.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "example_diagnosis.h"
#include "softarm/report/report.h"

namespace softarm::diagnose {
namespace {

using nlohmann::json;
using ::testing::IsSupersetOf;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<std::string> keys(const json& object) {
  std::vector<std::string> names;
  for (const auto& item : object.items()) names.push_back(item.key());
  return names;
}

TEST(ToJson, HasTheKeysOfTheContract) {
  const diagnose::Diagnosis d = testing::example_diagnosis();
  const json report = json::parse(report::to_json(d));
  EXPECT_THAT(keys(report), IsSupersetOf({"format", "verdict", "noise_floor_m", "baseline", "extended",
                                          "effects", "ranking", "residual_structure", "next_experiment"}));
  EXPECT_EQ(report["format"], 1);
  EXPECT_EQ(report["verdict"], "explained");
  EXPECT_DOUBLE_EQ(report["noise_floor_m"], d.noise_floor_m);
  for (const char* fit : {"baseline", "extended"})
    EXPECT_THAT(keys(report[fit]), IsSupersetOf({"rms_m", "held_out_rms_m", "held_out_mean_m",
                                                 "held_out_max_m", "held_out_log_score"}));
  EXPECT_DOUBLE_EQ(report["extended"]["held_out_rms_m"], d.extended.held_out_plain_rms_m);
  EXPECT_DOUBLE_EQ(report["extended"]["rms_m"], d.extended.plain_rms_m);
  EXPECT_DOUBLE_EQ(report["extended"]["held_out_weighted_rms_m"], d.extended.held_out_rms_m);
  EXPECT_DOUBLE_EQ(report["extended"]["weighted_rms_m"], d.extended.rms_m);
  EXPECT_DOUBLE_EQ(report["extended"]["held_out_max_m"], 1e-3);
  EXPECT_DOUBLE_EQ(report["left_out_share"], d.left_out_share);
  EXPECT_DOUBLE_EQ(report["discrepancy_share"], d.discrepancy_share);
  EXPECT_THAT(keys(report["next_experiment"]), IsSupersetOf({"action", "separates", "expected_separation"}));
  EXPECT_EQ(report["next_experiment"]["menu"][0]["hardest"], (json{"rigid_ends", "shear"}));
  EXPECT_DOUBLE_EQ(report["next_experiment"]["today"], 0.8);
  EXPECT_EQ(report["ladder"]["rungs"].size(), 3U);
  EXPECT_THAT(keys(report["ladder"]["rungs"][0]), IsSupersetOf({"id", "description", "unknowns", "rms_m"}));
  EXPECT_EQ(report["parameter_variation"][0]["against"], "payload");
  EXPECT_THAT(keys(report["residual_structure"]), IsSupersetOf({"whiteness_p", "where"}));
  EXPECT_DOUBLE_EQ(report["residual_structure"]["whiteness_p"], d.after.whiteness_p);
  ASSERT_EQ(report["ranking"].size(), d.ranking.size());
  for (const json& one : report["ranking"])
    EXPECT_THAT(keys(one), IsSupersetOf({"name", "probability", "collinearity", "detectable"}));
}

TEST(ToJson, SaysWhatAnEffectIs) {
  const json effects = json::parse(report::to_json(testing::example_diagnosis()))["effects"];
  ASSERT_EQ(effects.size(), 2U);
  EXPECT_THAT(keys(effects[0]), IsSupersetOf({"name", "probability", "parameters", "where", "held_out_gain",
                                              "confusable_with", "sentence"}));
  EXPECT_EQ(effects[0]["name"], "base_compliance");
  const json small = json::parse(report::to_json(testing::example_diagnosis()))["small_departures"];
  ASSERT_EQ(small.size(), 1U);
  EXPECT_EQ(small[0]["name"], "marker_slip");
  EXPECT_EQ(keys(small[0]), keys(effects[0]));
  EXPECT_DOUBLE_EQ(small[0]["share"], 0.004);
  const json stand_ins = json::parse(report::to_json(testing::example_diagnosis()))["stand_ins"];
  ASSERT_EQ(stand_ins.size(), 1U);
  EXPECT_EQ(stand_ins[0]["name"], "axial_memory");
  EXPECT_EQ(keys(stand_ins[0]), keys(effects[0]));
  const json& stiffness = effects[0]["parameters"]["K_base"];
  EXPECT_THAT(keys(stiffness), IsSupersetOf({"value", "low", "high", "unit"}));
  EXPECT_DOUBLE_EQ(stiffness["value"], 5.21);
  EXPECT_EQ(stiffness["unit"], "N m/rad");
  EXPECT_EQ(
      effects[0]["where"],
      (json{{"s_from", 0.0}, {"s_to", 0.0}, {"axis", "in_plane"}, {"when", "always"}, {"input", "payload"}}));
  EXPECT_EQ(effects[0]["confusable_with"], (json{"rigid_ends", "shear"}));
  // Made of its parts where the engine gave none.
  EXPECT_EQ(
      effects[1]["sentence"],
      "Pressure and moment lag in a loop, at any speed, 30 to 170 mm from the base, in the plane of bending, "
      "whenever a pressure turns round, goes with chamber_1; half width of the loop: 2.48 kPa (90 % interval "
      "2.21 to 2.76); probability 88 %.");
}

TEST(ToJson, SaysWhichRingsHaveOneAnothersNames) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  EXPECT_FALSE(json::parse(report::to_json(d)).contains("exchanged_names"));
  d.exchanged_names = diagnose::ExchangedNames{{"low", "tip"}, {"tip", "low"}, {"first"}, 0.05, 0.001};
  EXPECT_EQ(json::parse(report::to_json(d))["exchanged_names"],
            (json{{"said", {"low", "tip"}}, {"seen", {"tip", "low"}}, {"trials", {"first"}}}));
}

TEST(ToJson, SaysWhichPayloadsAreNotWhatWasTold) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  EXPECT_FALSE(json::parse(report::to_json(d)).contains("told_payloads"));
  d.told_payloads = diagnose::ToldPayloads{
      {{"all", {}, {}, 0.0, 0.4, 0.375, 0.425}, {"late", 10.5, {}, 0.4, 0.0, 0.0, 0.0625}},
      0.005,
      0.001,
      0.75};
  EXPECT_EQ(
      json::parse(report::to_json(d))["told_payloads"],
      (json{{"trials",
             {{{"trial", "all"}, {"told_kg", 0.0}, {"found_kg", 0.4}, {"low_kg", 0.375}, {"high_kg", 0.425}},
              {{"trial", "late"},
               {"told_kg", 0.4},
               {"found_kg", 0.0},
               {"low_kg", 0.0},
               {"high_kg", 0.0625},
               {"from_s", 10.5}}}},
            {"as_told_held_out_mean_m", 0.005},
            {"held_out_mean_m", 0.001},
            {"probability", 0.75}}));
}

TEST(ToJson, SaysTheLawThatWasLearnt) {
  const diagnose::DiscoveredLaw law = testing::example_law();
  const json said = json::parse(report::to_json(testing::example_diagnosis()))["discovered_law"];
  EXPECT_THAT(keys(said), IsSupersetOf({"held_out_mean_before_m", "held_out_mean_after_m", "share",
                                        "share_of_flexible", "sequences", "resembles", "sentence"}));
  EXPECT_EQ(said["resembles"], (json{{"name", "pressure_lag"}, {"cosine", 0.91}}));
  ASSERT_EQ(said["terms"].size(), 2U);
  const json& lag = said["terms"][0];
  EXPECT_EQ(lag["goes_with"], law.terms[0].goes_with);
  EXPECT_EQ(lag["unit"], "Pa");
  EXPECT_DOUBLE_EQ(lag["from"], -14.1e3);
  EXPECT_DOUBLE_EQ(lag["y_nm"]["value"], 2.1e-3);
  EXPECT_EQ(lag["y_nm"]["unit"], "N m");
  EXPECT_EQ(lag["has_direction"], false);
  EXPECT_EQ(said["terms"][1]["rises"], true);
}

TEST(ToJson, TheLearntLawIsAnEquationWithItsSources) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  const diagnose::DiscoveredLaw law = testing::example_law();
  const json said = json::parse(report::to_json(d))["discovered_law"];
  EXPECT_EQ(said["source"], law.source);
  ASSERT_EQ(said["terms"].size(), law.terms.size());
  for (std::size_t i = 0; i < law.terms.size(); ++i) {
    EXPECT_EQ(said["terms"][i]["equation"], law.terms[i].law);
    EXPECT_EQ(said["terms"][i]["symbols"], law.terms[i].symbols);
    EXPECT_EQ(said["terms"][i]["source"], law.terms[i].source);
  }
  d.discovered_law->source.clear();
  d.discovered_law->terms[0].law.clear();
  d.discovered_law->terms[0].source.clear();
  const json without = json::parse(report::to_json(d))["discovered_law"];
  EXPECT_FALSE(without.contains("source"));
  for (const char* key : {"equation", "symbols", "source"})
    EXPECT_FALSE(without["terms"][0].contains(key)) << key;
}

TEST(ToJson, AbsentIsAbsent) {
  diagnose::Diagnosis d;
  d.effects.resize(1);
  d.effects[0].where.s_from_m = 0.03;
  d.ranking.resize(1);
  const json report = json::parse(report::to_json(d));
  EXPECT_FALSE(report.contains("next_experiment"));
  EXPECT_FALSE(report.contains("ladder"));
  EXPECT_FALSE(report.contains("discovered_law"));
  EXPECT_FALSE(report.contains("ceiling_rms_m"));
  EXPECT_EQ(report["effects"][0]["where"], (json{{"s_from", 0.03}}));
  EXPECT_EQ(report["effects"][0]["parameters"], json::object());
  EXPECT_FALSE(report["ranking"][0].contains("held_out_log_score_gain"));
  EXPECT_EQ(report["residual_structure"]["where"], json::object());
  EXPECT_EQ(report["ranking"].size(), 1U);
  EXPECT_TRUE(json::parse(report::to_json(diagnose::Diagnosis()))["effects"].is_array());
}

TEST(ToJson, SaysWhereItComesFrom) {
  const report::Origin origin{"softarm diagnose 'a b.bag'", "2026-05-04T12:30Z", {{"a b.bag", "0123"}}};
  const json report = json::parse(report::to_json(testing::example_diagnosis(), origin));
  EXPECT_EQ(report["origin"], (json{{"command", "softarm diagnose 'a b.bag'"},
                                    {"date", "2026-05-04T12:30Z"},
                                    {"files", {{{"name", "a b.bag"}, {"sha256", "0123"}}}}}));
  EXPECT_FALSE(json::parse(report::to_json(testing::example_diagnosis())).contains("origin"));
}

TEST(ToJson, NumbersThatAreNoneAreLeftOut) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  d.noise_floor_m = kNan;
  d.baseline.held_out_log_score = -kInfinity;
  d.effects[0].parameters[0].high = kInfinity;
  d.ranking[0].z = kNan;
  d.after.by_input_p["chamber_1"] = kNan;
  const std::string text = report::to_json(d);
  const json report = json::parse(text);
  EXPECT_FALSE(report.contains("noise_floor_m"));
  EXPECT_THAT(keys(report["baseline"]),
              ::testing::UnorderedElementsAre("rms_m", "held_out_rms_m", "held_out_mean_m", "held_out_max_m",
                                              "weighted_rms_m", "held_out_weighted_rms_m"));
  EXPECT_FALSE(report["effects"][0]["parameters"]["K_base"].contains("high"));
  EXPECT_TRUE(report["effects"][0]["parameters"]["K_base"].contains("low"));
  EXPECT_FALSE(report["ranking"][0].contains("z"));
  EXPECT_FALSE(report["residual_structure"]["by_input_p"].contains("chamber_1"));
  EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("null")));
}

TEST(ToJson, ANumberThatWasHeldHasNoInterval) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  d.effects.front().parameters.push_back({"extent_m", "m", "", 0.08, 0.08, 0.08, false});
  const json parameters = json::parse(report::to_json(d))["effects"][0]["parameters"];
  EXPECT_EQ(parameters["extent_m"], (json{{"value", 0.08}, {"unit", "m"}, {"fitted", false}}));
  EXPECT_FALSE(parameters["K_base"].contains("fitted"));
}

TEST(ToJson, TakesNamesAsTheyAre) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  d.trials[0].name = "a \"quoted\" \\ name\n";
  d.trials[1].name = "not UTF-8: \xff\xfe";
  const json report = json::parse(report::to_json(d));
  EXPECT_EQ(report["trials"][0]["name"], "a \"quoted\" \\ name\n");
  EXPECT_EQ(report["trials"][1]["name"], "not UTF-8: \xEF\xBF\xBD\xEF\xBF\xBD");
}

TEST(ToString, IsWhatTheContractSays) {
  EXPECT_EQ(to_string(diagnose::Verdict::kConsistent), "consistent");
  EXPECT_EQ(to_string(diagnose::Verdict::kExplained), "explained");
  EXPECT_EQ(to_string(diagnose::Verdict::kPartlyExplained), "partly_explained");
  EXPECT_EQ(to_string(diagnose::Verdict::kUnknown), "unknown");
  EXPECT_EQ(to_string(diagnose::Verdict::kCannotTell), "cannot_tell");
  EXPECT_EQ(to_string(diagnose::Finding::kNotOfThisArm), "not_of_this_arm");
}

}  // namespace
}  // namespace softarm::diagnose
