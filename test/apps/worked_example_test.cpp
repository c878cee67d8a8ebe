// The worked example of doc/worked_example.md in short: a base that yields, hidden behind a lower EI.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "program.h"

namespace softarm {
namespace {

constexpr const char* kCampaign = R"(format: 1
name: short
arms: [{scenario: demo, arm: online_200mm}]
effects: {count_weights: [0, 1], from: [base_compliance], size: 0.5}
arm_spread: {stiffness: 0.15, gain: 0.1, mass: 0, length: 0}
trials: {count: 5, attitudes: [hanging, horizontal], speeds: [0.5, 1, 3], seconds: 6, payload_kg: [0, 0.15]}
mocap: {rate_hz: 60, position_sd_m: 0.0005}
)";

double number_after(const std::string& text, const std::string& key) {
  std::smatch found;
  EXPECT_TRUE(std::regex_search(text, found, std::regex(key + ": *([0-9.eE+-]+)"))) << key;
  return found.empty() ? 0.0 : std::stod(found[1]);
}

TEST(WorkedExample, ABaseThatYieldsIsFoundAndStiffnessCorrected) {
  const TestFolder folder;
  const std::string campaign = folder.write("short.yaml", kCampaign), trials = folder / "c/case_001/*.bag";
  ASSERT_EQ(softarm_program("campaign " + campaign + " --cases 1 --seed 1 --out " + (folder / "c")).status,
            0);
  const std::string fitted = folder / "fitted.yaml", report = folder / "report";
  ASSERT_EQ(
      softarm_program("identify --arm online_200mm " + trials + " --leave-one-out --out " + fitted).status,
      0);
  const Outcome diagnosed = softarm_program("diagnose --arm " + fitted + " " + trials + " --out " + report);
  ASSERT_EQ(diagnosed.status, 0) << diagnosed.err;

  const std::string sealed = text_of(folder / "c/truth/case_001/trial_01.truth.yaml");
  const double truth = number_after(sealed, "stiffness_base_nm2");
  const double compliance = 1.0 / number_after(sealed, "stiffness_nm_per_rad");
  const double before = number_after(text_of(fitted), "\\n *base_nm2");
  EXPECT_LT(before, 0.97 * truth) << "the fit hides the base behind a lower EI";

  const auto written = nlohmann::json::parse(text_of(report + "/report.json"));
  ASSERT_EQ(written["effects"].size(), 1U) << diagnosed.out;
  EXPECT_EQ(written["effects"][0]["name"], "base_compliance");
  const auto& size = written["effects"][0]["parameters"]["compliance_rad_per_nm"];
  EXPECT_NEAR(size["value"], compliance, 0.1 * compliance);
  for (const auto& shift : written["shifts"]) {
    if (shift["name"] != "segment_1.bending_stiffness.base") continue;
    EXPECT_LT(std::abs(shift["after"].get<double>() - truth), 0.25 * std::abs(before - truth));
  }
  EXPECT_LT(written["extended"]["held_out_rms_m"].get<double>(),
            0.8 * written["baseline"]["held_out_rms_m"].get<double>());

  const std::string verdict = written["verdict"].get<std::string>();
  const std::string extended = text_of(report + "/arm_extended.yaml");
  EXPECT_THAT(extended, ::testing::StartsWith("# softarm diagnose: constants and effects fitted together"));
  EXPECT_THAT(extended, ::testing::HasSubstr("\n# softarm diagnose: verdict: " + verdict + "; "));
  EXPECT_THAT(extended, ::testing::HasSubstr("\n# softarm diagnose: base_compliance ("));
  EXPECT_THAT(extended, ::testing::HasSubstr("\neffects_verdict: " + verdict + "  #"));

  const auto& origin = written["origin"];
  EXPECT_THAT(origin["command"].get<std::string>(),
              ::testing::StartsWith("softarm diagnose --arm " + fitted));
  ASSERT_GT(origin["files"].size(), 1U);
  EXPECT_EQ(origin["files"][0]["name"], fitted);
  const std::string sum = folder / "sum";
  ASSERT_EQ(std::system(("sha256sum < " + fitted + " > " + sum).c_str()), 0);
  EXPECT_EQ(origin["files"][0]["sha256"], text_of(sum).substr(0, 64));
}

}  // namespace
}  // namespace softarm
