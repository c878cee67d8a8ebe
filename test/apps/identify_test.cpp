// softarm identify as a user runs it: rig trials to an arm file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "program.h"
#include "softarm/arm/arm_file.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;

/// A hanging arm at rest, its pressure raised, then a weight of 150 g hung on: a rig whose gain is 7e-6 N
/// m/Pa and whose EI is 0.031 N m^2.
std::string scenario(double pressure_pa, int seed) {
  return R"(format: 1
name: trial
seed: )" +
         std::to_string(seed) +
         R"(
duration_s: 11
arm:
  length_m: 0.2
  mass_kg: 0.2
  bending_stiffness: {base_nm2: 0.031}
  torsional_stiffness_nm2: 3.0
  retardation_s: 0.05
  chambers:
    - {bending_direction_deg: 0, moment_gain_nm_per_pa: 7.0e-6, near_elongation_m_per_pa: 5.0e-8}
mount: {attitude: hanging}
pressures:
  settle_s: 0.5
  ramp_s: 1
  rest_pa: 0
  schedule:
    - {t_s: 0, pressures_pa: [0]}
    - {t_s: 1, pressures_pa: [)" +
         std::to_string(pressure_pa) + R"(]}
payload:
  ramp_s: 0.3
  steady_s: 1.2
  schedule:
    - {t_s: 0, kg: 0}
    - {t_s: 5, kg: 0.15}
mocap: {rate_hz: 60}
)";
}

constexpr const char* kArm = R"(format: 1
name: one_chamber
base: {body: base}
segments:
  - name: segment_1
    length_m: 0.2
    mass_per_length_kg_m: 1.0
    diameter_m: 0.04
    bending_stiffness: {base_nm2: 0.025}  # a guess
    chambers:
      - {input: chamber_1, bending_direction_deg: 0, moment_gain_nm_per_pa: 6.0e-6}  # a guess
bodies:
  - {name: ring_1, arclength_m: 0.05}
  - {name: ring_2, arclength_m: 0.1}
  - {name: ring_3, arclength_m: 0.15}
  - {name: ring_4, arclength_m: tip, orientation_usable: true}
inputs:
  pressures:
    - {name: chamber_1, topic: /pressure/chamber_1}
)";

TEST(SoftarmIdentify, RigTrialsGiveAnArmThatEstimateLoads) {
  const TestFolder dir;
  const std::string arm = dir.write("arm.yaml", kArm);
  std::string bags;
  for (int i = 0; i < 4; ++i) {
    const std::string name = "t" + std::to_string(i);
    dir.write(name + ".yaml", scenario(15e3 + 9e3 * i, 1 + i));
    const std::string bag = dir / (name + ".bag");
    ASSERT_EQ(softarm_program("simulate " + dir / (name + ".yaml") + " --out " + bag).status, 0);
    bags += " " + bag;
  }
  const std::string out = dir / "new.yaml", json = dir / "new.json", plot = dir / "plot";
  const std::string call = "identify --arm " + arm + bags + " --out " + out;
  const Outcome o = softarm_program(call + " --json " + json + " --plot " + plot);
  ASSERT_EQ(o.status, 0) << o.err;
  EXPECT_EQ(o.out.rfind("generalises: ", 0), 0u) << o.out;
  EXPECT_THAT(o.out, HasSubstr("segment_1.chamber_1.moment_gain"));
  EXPECT_THAT(o.out, HasSubstr("unseen trials, after"));
  const std::string text = text_of(out);
  EXPECT_THAT(text,
              HasSubstr("# softarm identify: constants and prior identified from the trials t0, t1, t2\n"));
  EXPECT_THAT(text, HasSubstr("# a guess")) << "comments stay";
  const arm::Arm found = arm::parse_arm(text, out);
  EXPECT_NEAR(found.segments[0].chambers[0].moment_gain_nm_per_pa, 7.0e-6, 0.05 * 7.0e-6);
  EXPECT_NEAR(found.segments[0].bending_stiffness.base_nm2, 0.031, 0.05 * 0.031);
  EXPECT_NEAR(found.segments[0].chambers[0].near_elongation_m_per_pa, 5.0e-8, 1.0e-8);
  EXPECT_TRUE(found.estimator.prior.enabled);
  const auto result = nlohmann::json::parse(text_of(json));
  EXPECT_LT(result.at("held_out").at("mean_m"), 0.0015);
  EXPECT_GT(result.at("held_out_before").at("mean_m"), 0.002);
  EXPECT_THAT(text_of(plot + "/shapes.csv"), HasSubstr("\nt3,1,"));
  EXPECT_THAT(text_of(plot + "/constants.csv"), HasSubstr("segment_1.bending_stiffness.base,N m^2,0.025,"));

  ASSERT_EQ(softarm_program(call + " --force").status, 0);
  EXPECT_EQ(text_of(out), text) << "the same trials, the same file";
  EXPECT_EQ(
      softarm_program("estimate --arm " + out + " " + dir / "t0.bag" + " --out " + dir / "estimates").status,
      0);

  const Outcome pull = softarm_program("identify --arm " + arm + bags + " --procedure pull");
  ASSERT_EQ(pull.status, 0) << pull.err;
  EXPECT_THAT(pull.out, HasSubstr("0.000 -> 0.150"));
}

TEST(SoftarmIdentify, RefusesInOneLineAndLeavesNothing) {
  const TestFolder dir;
  const std::string arm = dir.write("arm.yaml", kArm);
  dir.write("t.yaml", scenario(2e4, 1));
  const std::string bag = dir / "t.bag";
  ASSERT_EQ(softarm_program("simulate " + dir / "t.yaml" + " --out " + bag).status, 0);
  const std::size_t before = dir.entries();
  const auto refused = [&](const std::string& arguments, const std::string& words) {
    const Outcome o = softarm_program("identify " + arguments);
    EXPECT_GT(o.status, 0) << arguments;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_THAT(o.err, HasSubstr(words));
    EXPECT_EQ(dir.entries(), before) << arguments;
  };
  const std::string out = " --out " + dir / "new.yaml";
  refused("--arm " + arm + " " + bag, "--out is needed");
  refused("--arm " + arm + " " + dir / "none.bag" + out, "no such bag");
  refused("--arm " + arm + " " + bag + " " + bag + out, "called t too");
  refused("--arm " + arm + " " + bag + out + " --free mometn_gain", "segment_1.chamber_1.moment_gain");
  refused("--arm " + arm + " " + bag + out + " --hold-out x", "no trial");
  refused("--arm " + arm + " " + bag + out + " --hold-out t", "nothing is left");
  refused("--arm " + arm + " " + bag + " --out " + dir / "no/such/folder.yaml", "no/such");
  refused("--arm " + arm + " " + bag + out + " --payload 99", "0 to 5 kg");
  refused("--arm " + arm + " " + bag + out + " --procedure push", "push");
}

}  // namespace
}  // namespace softarm
