// Scenario files: what they say, and one clear line for what they must not say.
#include "rig/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "rig/scenario_text.h"
#include "rig/simulator.h"

namespace softarm::rig {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string read(const std::string& path) {
  std::ifstream file(std::string(SOFTARM_SOURCE_DIR) + "/" + path);
  EXPECT_TRUE(file.good()) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string error_of(const std::string& text) {
  try {
    parse_scenario(text, "case.yaml");
  } catch (const ScenarioError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Scenario, ReadsWhatIsWritten) {
  const Scenario s = parse_scenario(kScenarioText, "case.yaml");
  EXPECT_EQ(s.name, "case");
  EXPECT_EQ(s.seed, 18446744073709551615ULL);
  EXPECT_DOUBLE_EQ(s.arm.segments[0].stiffness_per_min_nm2_per_pa, 3e-7);
  ASSERT_EQ(s.arm.segments[0].chambers.size(), 3u);
  EXPECT_DOUBLE_EQ(s.arm.segments[0].chambers[1].direction_rad, 2.0 * M_PI / 3.0);
  EXPECT_DOUBLE_EQ(s.arm.segments[0].torsional_stiffness_nm2, 0.027);  // default: b1
  EXPECT_TRUE(s.mount.q_mocap_base.isApprox(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0)));
  ASSERT_TRUE(s.pressures.random);
  EXPECT_DOUBLE_EQ(s.pressures.random->max[1], 40000.0);
  ASSERT_EQ(s.payload.schedule.size(), 2u);
  EXPECT_DOUBLE_EQ(s.payload.schedule[1].values[0], 0.2);
  EXPECT_DOUBLE_EQ(s.mocap.ring_noise.position_sd_m, 0.0005);
}

std::string with_rings(const std::string& rings) {
  std::string text = kScenarioText;
  const std::string from = "ring_fractions: [0.5, 1.0]";
  return text.replace(text.find(from), from.size(), "rings: " + rings);
}

TEST(Scenario, RingsMayHaveNamesAndPlacesOfTheirOwn) {
  const MocapSpec spec = parse_scenario(with_rings("[{name: lab/a, fraction: 0.4, position_m: [0, 0.02, 0]}, "
                                                   "{fraction: 0.4}]\n  base: {name: clamp}"),
                                        "case.yaml")
                             .mocap;
  EXPECT_EQ(spec.ring_fractions, (std::vector<double>{0.4, 0.4}));
  EXPECT_EQ(spec.rings[0].name, "lab/a");
  EXPECT_EQ(spec.rings[0].p_section, Eigen::Vector3d(0.0, 0.02, 0.0));
  EXPECT_EQ(spec.rings[1].name, "ring_2");
  EXPECT_EQ(spec.base.name, "clamp");
  EXPECT_THAT(error_of(with_rings("[{name: base, fraction: 1}]")),
              AllOf(HasSubstr("mocap.rings[0].name"), HasSubstr("base")));
  EXPECT_THAT(error_of(with_rings("[{fraction: 1}, {fraction: 0.5}]")), HasSubstr("must not decrease"));
  EXPECT_THAT(error_of(with_rings("[]")), HasSubstr("0 rings, allowed 1 ... 64"));
  EXPECT_THAT(error_of(with_rings("[{fraction: 1}]\n  ring_fractions: [1]")), HasSubstr("one of them"));
}

TEST(Scenario, MountsMayBeTurnedAboutTheArmsAxis) {
  std::string text = kScenarioText;
  const std::string from = "attitude: hanging";
  text.replace(text.find(from), from.size(), "attitude: horizontal\n  rotation_deg: 180");
  const Eigen::Quaterniond q = parse_scenario(text, "case.yaml").mount.q_mocap_base;
  EXPECT_LT((q * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((q * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(Scenario, EveryMistakeIsOneLineNamingSourceKeyValueAndRange) {
  struct Mistake {
    std::string from, to;
    std::vector<std::string> says;
  };
  const std::vector<Mistake> mistakes{
      {"length_m: 0.2", "length_m: -1", {"arm.length_m", "-1", "0.01 ... 10"}},
      {"length_m: 0.2", "length_mm: 200", {"arm.length_m", "missing"}},
      {"mass_kg: 0.2", "mass_kg: .nan", {"arm.mass_kg", ".nan", "allowed"}},
      {"mass_kg: 0.2", "mass_kg: heavy", {"arm.mass_kg", "heavy", "number"}},
      {"name: case", "name: case\ncolour: red", {"key colour", "unknown", "duration_s"}},
      {"name: case", "name: case\nname: again", {"key name", "twice"}},
      {"name: case", "name: a b", {"key name", "letters"}},
      {"name: case", "name: case\n\"two\\nlines\": 1", {"key two lines", "unknown"}},
      {"format: 1", "format: 2", {"format", "2"}},
      {"format: 1\n", "", {"format", "missing"}},
      {"seed: 18446744073709551615", "seed: 1.5", {"seed", "1.5"}},
      {"duration_s: 10", "duration_s: 3", {"duration_s", "3", "from 5"}},
      {"attitude: hanging", "attitude: upside", {"mount.attitude", "upside", "standing"}},
      {"attitude: hanging", "quaternion_xyzw: [0, 0, 0, 0.5]", {"mount.quaternion_xyzw", "0.5", "0.999"}},
      {"attitude: hanging", "quaternion_xyzw: [0, 0, 1]", {"mount.quaternion_xyzw", "3 values", "4"}},
      {"max_pa: 40000", "max_pa: -5", {"pressures.random.max_pa", "-5"}},
      {"t_s: 0, kg: 0.1", "t_s: 1, kg: 0.1", {"payload.schedule[0].t_s", "first"}},
      {"t_s: 5", "t_s: 0.1", {"payload.schedule[1].t_s", "0.1"}},
      {"t_s: 5, kg: 0.2", "t_s: 5, mass: 0.2", {"payload.schedule[1].kg", "missing"}},
      {"ring_fractions: [0.5, 1.0]", "ring_fractions: [1.0, 0.5]", {"mocap.ring_fractions", "increase"}},
      {"ring_fractions: [0.5, 1.0]", "ring_fractions: []", {"mocap.ring_fractions", "0 values"}},
      {"dropout_probability: 0.1", "dropout_probability: 2", {"mocap.dropout_probability", "0 ... 1"}},
      {"  chambers:", "  chamber:", {"arm.chamber", "unknown", "chambers, "}},
  };
  for (const Mistake& mistake : mistakes) {
    std::string text = kScenarioText;
    const std::size_t at = text.find(mistake.from);
    ASSERT_NE(at, std::string::npos) << mistake.from;
    text.replace(at, mistake.from.size(), mistake.to);
    const std::string message = error_of(text);
    EXPECT_THAT(message, HasSubstr("case.yaml: ")) << mistake.to;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const std::string& part : mistake.says) EXPECT_THAT(message, HasSubstr(part)) << mistake.to;
  }
  EXPECT_THAT(error_of("a: [1"), AllOf(HasSubstr("case.yaml"), HasSubstr("line")));
  EXPECT_THAT(error_of(""), HasSubstr("not a scenario"));
  EXPECT_THAT(error_of("- 1"), HasSubstr("not a scenario"));
}

TEST(Scenario, ShippedOnesLoadAndRun) {
  std::size_t count = 0;
  const std::filesystem::path directory = std::string(SOFTARM_SOURCE_DIR) + "/config/scenarios";
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    const std::string name = entry.path().stem();
    const Scenario scenario = parse_scenario(read("config/scenarios/" + name + ".yaml"), name);
    EXPECT_EQ(scenario.name, name);
    Simulator simulator(scenario);
    for (int i = 0; i < 200; ++i) ASSERT_TRUE(simulator.next()) << name;
    ++count;
  }
  EXPECT_GE(count, 9u);
}

TEST(Scenario, DemoHasTheConstantsOfTheArmItIsEstimatedWith) {
  const Scenario demo = parse_scenario(read("config/scenarios/demo.yaml"), "demo.yaml");
  const YAML::Node arm = YAML::Load(read("config/arms/online_200mm.yaml"));
  const YAML::Node segment = arm["segments"][0];
  const SegmentSpec& spec = demo.arm.segments.at(0);
  EXPECT_DOUBLE_EQ(spec.length_m, segment["length_m"].as<double>());
  EXPECT_DOUBLE_EQ(spec.mass_kg, segment["mass_per_length_kg_m"].as<double>() * spec.length_m);
  const YAML::Node law = segment["bending_stiffness"];
  EXPECT_DOUBLE_EQ(spec.stiffness_base_nm2, law["base_nm2"].as<double>());
  EXPECT_DOUBLE_EQ(spec.stiffness_per_min_nm2_per_pa, law["per_min_pressure_nm2_per_pa"].as<double>());
  ASSERT_EQ(segment["chambers"].size(), spec.chambers.size());
  for (std::size_t i = 0; i < spec.chambers.size(); ++i) {
    const YAML::Node chamber = segment["chambers"][i];
    EXPECT_DOUBLE_EQ(spec.chambers[i].direction_rad,
                     chamber["bending_direction_deg"].as<double>() * M_PI / 180.0);
    EXPECT_DOUBLE_EQ(spec.chambers[i].moment_gain_nm_per_pa, chamber["moment_gain_nm_per_pa"].as<double>());
    EXPECT_DOUBLE_EQ(spec.chambers[i].near_elongation_m_per_pa + spec.chambers[i].far_elongation_m_per_pa,
                     chamber["near_elongation_m_per_pa"].as<double>(0.0) +
                         chamber["far_elongation_m_per_pa"].as<double>(0.0));
  }
  EXPECT_DOUBLE_EQ(demo.pressures.ambient_pa, arm["inputs"]["ambient_pressure_pa"].as<double>());
}

}  // namespace
}  // namespace softarm::rig
