// Arm files with effects, as a user has them: simulated, estimated, refused.
#include <gmock/gmock.h>

#include <boost/algorithm/string.hpp>

#include "arm/arm_writer.h"
#include "program.h"
#include "softarm/arm/arm_file.h"

namespace softarm {
namespace {

std::string extended(const std::vector<arm::EffectEntry>& effects) {
  const arm::ArmText file =
      arm::read_arm_text(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/online_200mm.yaml");
  return arm::update_arm_text(file.text, file.source, arm::parse_arm(file.text, file.source), effects, {},
                              "diagnose");
}

const char* const kScenario = R"(format: 1
name: of_an_arm_file
seed: 3
duration_s: 12
arm: arm.yaml
mount: {attitude: horizontal}
pressures:
  random: {min_pa: 0, max_pa: 50000, highest_hz: 0.08}
payload:
  schedule: [{t_s: 0, kg: 0.2}]
mocap: {rate_hz: 60}
)";

/// Median of EI over the rows in which it is identifiable; of the truth over all.
double median_stiffness(const std::string& csv) {
  std::istringstream file(text_of(csv));
  std::vector<std::string> names, cells;
  std::vector<double> values;
  for (std::string line; std::getline(file, line);) {
    boost::split(cells, line, [](char c) { return c == ','; });
    if (names.empty()) {
      names = cells;
      continue;
    }
    const auto cell = [&](const std::string& name) {
      return cells.at(static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()));
    };
    const bool truth = std::find(names.begin(), names.end(), "status") == names.end();
    if (truth || (cell("status") == "ok" && cell("identifiable_EI") == "1"))
      values.push_back(std::stod(cell("EI")));
  }
  if (values.size() < 100) throw std::runtime_error("too few rows with identifiable EI");
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

TEST(ExtendedArm, IsSimulatedAndEstimatedWithItsEffects) {
  const TestFolder dir;
  dir.write("arm.yaml", extended({{"base_compliance", {{"compliance_rad_per_nm", 0.2}}},
                                  {"axial_compliance", {{"compliance_per_n", 0.005}}}}));
  const std::string scenario = dir.write("scenario.yaml", kScenario);
  const Outcome simulated = softarm_program("simulate " + scenario + " --out " + dir / "trial.bag");
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  EXPECT_NE(text_of(dir / "trial.truth.yaml").find("base_compliance"), std::string::npos);
  const Outcome with = softarm_program("estimate --arm " + dir / "arm.yaml" + " " + dir / "trial.bag" +
                                       " --out " + dir / "with");
  ASSERT_EQ(with.status, 0) << with.err;
  EXPECT_NE(with.err.find("effects: in the model: base_compliance"), std::string::npos) << with.err;
  ASSERT_EQ(softarm_program("estimate --arm online_200mm " + dir / "trial.bag" + " --out " + dir / "without")
                .status,
            0);
  const double truth = median_stiffness(dir / "trial.truth.csv");
  EXPECT_NEAR(median_stiffness(dir / "with/trial/estimates.csv"), truth, 0.02 * truth);
  EXPECT_LT(median_stiffness(dir / "without/trial/estimates.csv"), 0.9 * truth);
}

TEST(ExtendedArm, EstimateWarnsOfEffectsThatTheirDiagnosisDoubted) {
  const TestFolder dir;
  ASSERT_EQ(softarm_program("simulate trial_10s --seconds 2 --out " + dir / "trial.bag").status, 0);
  const std::string effects = extended({{"base_compliance", {{"compliance_rad_per_nm", 0.2}}}});
  const auto said = [&](const std::string& verdict) {
    const std::string arm = dir.write("arm.yaml", effects + "effects_verdict: " + verdict + "\n");
    const Outcome o =
        softarm_program("estimate --force --arm " + arm + " " + dir / "trial.bag" + " --out " + dir / "out");
    EXPECT_EQ(o.status, 0) << o.err;
    return o.err;
  };
  EXPECT_THAT(said("unknown"),
              ::testing::ContainsRegex(
                  "softarm: warning: [^\n]*arm.yaml: [^\n]*\"unknown\": [^\n]*something else is there"));
  EXPECT_THAT(
      said("cannot_tell"),
      ::testing::ContainsRegex(
          "softarm: warning: [^\n]*arm.yaml: [^\n]*\"cannot_tell\": [^\n]*probably not what is there"));
  EXPECT_EQ(said("explained").find("ended with the verdict"), std::string::npos);
}

TEST(ExtendedArm, UnevenStiffnessIsTheRigsWithAnotherMean) {
  // EI (1 + 0.2) in the plane and EI (1 - 0.2) across it: the rig leaves EI across it, and adds a half in it.
  const TestFolder dir;
  dir.write("arm.yaml", extended({{"plane_stiffness", {{"towards_x", 0.0}, {"diagonal", 0.2}}}}));
  const Outcome outcome =
      softarm_program("simulate " + dir.write("scenario.yaml", kScenario) + " --out " + dir / "trial.bag");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string truth = text_of(dir / "trial.truth.yaml");
  EXPECT_NE(truth.find("plane_stiffness"), std::string::npos);
  EXPECT_NE(truth.find("share: 0.5"), std::string::npos) << truth;
  EXPECT_NE(truth.find("azimuth_deg: 45"), std::string::npos) << truth;
}

TEST(ExtendedArm, CreepOfTheDrivesIsTheRigsWallWithLargerGains) {
  // The rig's drives come late, and do what its laws say in the end; the catalogue's a quarter more.
  const TestFolder dir;
  const std::string scenario = dir.write("scenario.yaml", kScenario);
  const auto truth = [&](double driven) {
    dir.write("arm.yaml", extended({{"creep", {{"share", 0.25}, {"time_s", 4.0}, {"driven", driven}}}}));
    const Outcome o = softarm_program("simulate --force " + scenario + " --out " + dir / "trial.bag");
    EXPECT_EQ(o.status, 0) << o.err;
    return text_of(dir / "trial.truth.yaml");
  };
  for (const auto& [driven, numbers] : std::vector<std::pair<double, std::vector<std::string>>>{
           {0.9,
            {"form: wall", "share: 0.25\n", "moment_gain_nm_per_pa: 7.625e-06",
             "moment_gain_nm_per_pa: 9.75e-06"}},
           {0.1,
            {"form: maxwell", "share: 0.25\n", "moment_gain_nm_per_pa: 6.1e-06",
             "moment_gain_nm_per_pa: 7.8e-06"}}})
    for (const std::string& number : numbers)
      EXPECT_NE(truth(driven).find(number), std::string::npos) << number << " in\n" << truth(driven);
}

TEST(ExtendedArm, ATetherThatIsSlackAndWeighsIsTheRigsHose) {
  const TestFolder dir;
  dir.write("arm.yaml",
            extended({{"tether",
                       {{"stiffness_n_per_m", 2.0},
                        {"mass_kg", 0.01},
                        {"anchor_x_m", 0.03},
                        {"anchor_y_m", 0.04},
                        {"length_m", 0.3}}},
                      {"supply_sag", {{"share", 0.3}, {"time_s", 50.0}, {"refill_pa_per_s", 4000.0}}}}));
  const std::string scenario = dir.write("scenario.yaml", kScenario);
  const std::string simulate = "simulate " + scenario + " --out " + dir / "trial.bag";
  const Outcome outcome = softarm_program(simulate);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string truth = text_of(dir / "trial.truth.yaml");
  for (const char* number : {"form: hose", "hose_kg: 0.02", "anchor_distance_m: 0.05", "slack_m: 0.25",
                             "form: tank", "refill_pa_per_s: 5000", "reference_pa: 150000"})
    EXPECT_NE(truth.find(number), std::string::npos) << number << " in\n" << truth;
  // What pulls at the straight arm, too, and has a length; what comes back; a loss that bends; a wall all
  // along the arm, whose law is another in the rig.
  for (const arm::EffectEntry& entry : std::vector<arm::EffectEntry>{
           {"tether", {{"stiffness_n_per_m", 2.0}, {"anchor_x_m", 0.05}, {"length_m", 0.04}}},
           {"supply_sag", {{"share", 0.3}, {"returned", 0.5}}},
           {"supply_sag", {{"share", 0.3}, {"bends", 2.0}}},
           {"contact", {{"stiffness_n_per_m", 50.0}, {"place_m", 0.12}, {"extent_m", 0.08}}}}) {
    dir.write("arm.yaml", extended({entry}));
    const Outcome refused = softarm_program("simulate --force " + scenario + " --out " + dir / "trial.bag");
    EXPECT_NE(refused.status, 0) << entry.id;
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
  }
}

TEST(ExtendedArm, WhatTheRigDoesNotHaveIsOneLine) {
  const TestFolder dir;
  dir.write("arm.yaml", extended({{"tip_mass", {{"mass_kg", 0.01}}}, {"inertia", {{"mass_share", 0.5}}}}));
  const Outcome outcome =
      softarm_program("simulate " + dir.write("scenario.yaml", kScenario) + " --out " + dir / "trial.bag");
  EXPECT_NE(outcome.status, 0);
  EXPECT_NE(outcome.err.find("key 'effects[1].id': value 'inertia' has no counterpart in the virtual rig"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_EQ(dir.entries(), 2u);
}

TEST(ExtendedArm, RefusedInOneLine) {
  const TestFolder dir;
  ASSERT_EQ(softarm_program("simulate trial_10s --seconds 6 --out " + dir / "trial.bag").status, 0);
  const std::string arm = dir.write("arm.yaml", extended({{"soft_spot", {{"share", 7.0}}}}));
  const std::size_t files = dir.entries();
  for (const std::string& program :
       {std::string("estimate --out ") + dir / "out", "identify --out " + dir / "new.yaml",
        "diagnose --out " + dir / "report"}) {
    const Outcome outcome = softarm_program(program + " --arm " + arm + " " + dir / "trial.bag");
    EXPECT_NE(outcome.status, 0) << program;
    EXPECT_NE(outcome.err.find("arm.yaml:"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(
                  "key 'effects[0].parameters.share': value 7 is outside the allowed range [-1, 0.95]"),
              std::string::npos)
        << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(dir.entries(), files) << program;
  }
}

}  // namespace
}  // namespace softarm
