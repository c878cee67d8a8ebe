// The scenarios of the virtual rig against the arm files of the same arms: the same numbers in both, so that
// what an estimator with the arm file finds in the rig's recording should be right.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "rig/scenario.h"
#include "softarm/arm/arm_file.h"

namespace softarm {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(SOFTARM_SOURCE_DIR) / "config";

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Names of a scenario and its arm.
struct Pair {
  std::string scenario, arm;
};

void PrintTo(const Pair& pair, std::ostream* out) {
  *out << pair.scenario << " with " << pair.arm;
}

class ScenarioPairs : public ::testing::TestWithParam<Pair> {
 protected:
  const rig::Scenario scenario_ = rig::parse_scenario(
      text_of(kConfig / "scenarios" / (GetParam().scenario + ".yaml")), GetParam().scenario);
  const arm::Arm arm_ =
      arm::parse_arm(text_of(kConfig / "arms" / (GetParam().arm + ".yaml")), GetParam().arm);

  /// The input's number within its kind, from 0, by its name.
  static int number(const std::string& input, const std::string& kind) {
    EXPECT_EQ(input.rfind(kind + "_", 0), 0u) << input;
    return std::stoi(input.substr(kind.size() + 1)) - 1;
  }
};

/// A stiffness that is rigid in the arm file is absent in the scenario.
void expect_same(const std::optional<double>& of_arm, const std::optional<double>& of_rig) {
  ASSERT_EQ(of_arm.has_value(), of_rig.has_value());
  if (of_arm) {
    EXPECT_DOUBLE_EQ(*of_arm, *of_rig);
  }
}

TEST_P(ScenarioPairs, SameBodiesOfSegments) {
  ASSERT_EQ(arm_.segments.size(), scenario_.arm.segments.size());
  for (std::size_t i = 0; i < arm_.segments.size(); ++i) {
    SCOPED_TRACE(arm_.segments[i].name);
    const arm::Segment& ours = arm_.segments[i];
    const rig::SegmentSpec& rigs = scenario_.arm.segments[i];
    EXPECT_DOUBLE_EQ(ours.length_m, rigs.length_m);
    EXPECT_NEAR(ours.mass_per_length_kg_m * ours.length_m, rigs.mass_kg, 1e-3 * rigs.mass_kg);
    EXPECT_DOUBLE_EQ(ours.diameter_m, rigs.diameter_m);
    const arm::StiffnessLaw& law = ours.bending_stiffness;
    EXPECT_DOUBLE_EQ(law.base_nm2, rigs.stiffness_base_nm2);
    EXPECT_DOUBLE_EQ(law.per_min_pressure_nm2_per_pa, rigs.stiffness_per_min_nm2_per_pa);
    EXPECT_DOUBLE_EQ(law.per_jamming_pressure_nm2_per_pa, rigs.stiffness_per_jamming_nm2_per_pa);
    ASSERT_EQ(law.by_pressure.size(), rigs.stiffness_by_pressure.size());
    for (std::size_t k = 0; k < law.by_pressure.size(); ++k) {
      EXPECT_DOUBLE_EQ(law.by_pressure[k].pressure_pa, rigs.stiffness_by_pressure[k].pressure_pa);
      EXPECT_DOUBLE_EQ(law.by_pressure[k].bending_stiffness_nm2,
                       rigs.stiffness_by_pressure[k].bending_stiffness_nm2);
    }
    // The rig's sections always twist; where ours are rigid its twist must be below what can be measured.
    if (ours.torsional_stiffness_nm2) {
      EXPECT_DOUBLE_EQ(*ours.torsional_stiffness_nm2, rigs.torsional_stiffness_nm2);
    } else {
      EXPECT_GE(rigs.torsional_stiffness_nm2, 30 * law.base_nm2);
    }
    expect_same(ours.axial_stiffness_n, rigs.axial_stiffness_n);
    expect_same(ours.shear_stiffness_n, rigs.shear_stiffness_n);
    ASSERT_EQ(ours.material.has_value(), rigs.material.has_value());
    if (ours.material) {
      EXPECT_DOUBLE_EQ(ours.material->c10_pa, rigs.material->c10_pa);
      EXPECT_DOUBLE_EQ(ours.material->c01_pa, rigs.material->c01_pa);
    }
  }
  EXPECT_DOUBLE_EQ(arm_.tip_mass_kg, scenario_.arm.tip_mass_kg);
}

TEST_P(ScenarioPairs, SameActuation) {
  ASSERT_EQ(arm_.segments.size(), scenario_.arm.segments.size());
  for (std::size_t i = 0; i < arm_.segments.size(); ++i) {
    SCOPED_TRACE(arm_.segments[i].name);
    const arm::Segment& ours = arm_.segments[i];
    const rig::SegmentSpec& rigs = scenario_.arm.segments[i];
    ASSERT_EQ(ours.chambers.size(), rigs.chambers.size());
    for (std::size_t k = 0; k < ours.chambers.size(); ++k) {
      EXPECT_EQ(number(ours.chambers[k].input, "chamber"), rigs.chambers[k].input);
      EXPECT_DOUBLE_EQ(ours.chambers[k].bending_direction_rad, rigs.chambers[k].direction_rad);
      EXPECT_DOUBLE_EQ(ours.chambers[k].moment_gain_nm_per_pa, rigs.chambers[k].moment_gain_nm_per_pa);
      // Only the sum of the two enters the length.
      EXPECT_DOUBLE_EQ(ours.chambers[k].near_elongation_m_per_pa + ours.chambers[k].far_elongation_m_per_pa,
                       rigs.chambers[k].near_elongation_m_per_pa + rigs.chambers[k].far_elongation_m_per_pa);
    }
    ASSERT_EQ(ours.central_chamber.has_value(), rigs.central_chamber.has_value());
    if (ours.central_chamber) {
      EXPECT_EQ(number(ours.central_chamber->input, "chamber"), rigs.central_chamber->input);
      EXPECT_DOUBLE_EQ(ours.central_chamber->area_m2, rigs.central_chamber->area_m2);
    }
    ASSERT_EQ(ours.tendons.size(), rigs.tendons.size());
    for (std::size_t k = 0; k < ours.tendons.size(); ++k) {
      EXPECT_EQ(number(ours.tendons[k].input, "tendon"), rigs.tendons[k].input);
      EXPECT_DOUBLE_EQ(ours.tendons[k].bending_direction_rad, rigs.tendons[k].azimuth_rad);
      EXPECT_DOUBLE_EQ(ours.tendons[k].offset_m, rigs.tendons[k].offset_m);
    }
    ASSERT_EQ(ours.cables.size(), rigs.cables.size());
    for (std::size_t k = 0; k < ours.cables.size(); ++k) {
      EXPECT_EQ(number(ours.cables[k].input, "servo"), rigs.cables[k].input);
      EXPECT_DOUBLE_EQ(ours.cables[k].bending_direction_rad, rigs.cables[k].azimuth_rad);
      EXPECT_NEAR(ours.cables[k].curvature_gain_per_m_rad,
                  rigs.cables[k].spool_radius_m / (rigs.length_m * rigs.cables[k].lever_m), 1e-9);
    }
  }
}

/// The topics that the rig publishes on are those that the arm file listens to.
TEST_P(ScenarioPairs, SameTopics) {
  const auto has = [this](const std::string& topic, arm::InputKind kind) {
    for (const arm::ScalarInput& input : arm_.inputs.scalars) {
      if (input.topic == topic && input.kind == kind && input.scale_to_si == 1.0 && input.zero_si == 0.0)
        return true;
    }
    return false;
  };
  for (int i = 1; i <= scenario_.arm.chambers; ++i) {
    EXPECT_TRUE(has("/pressure/chamber_" + std::to_string(i), arm::InputKind::kPressure)) << i;
  }
  for (int i = 1; i <= scenario_.arm.tendons; ++i) {
    EXPECT_TRUE(has("/tendon/" + std::to_string(i) + "/tension", arm::InputKind::kTension)) << i;
  }
  for (int i = 1; i <= scenario_.arm.servos; ++i) {
    EXPECT_TRUE(has("/servo/" + std::to_string(i) + "/angle", arm::InputKind::kAngle)) << i;
  }
  const bool jammed = !scenario_.vacuum.schedule.empty();
  if (jammed) {
    EXPECT_TRUE(has("/pressure/vacuum", arm::InputKind::kVacuum));
  }
  const int driven = scenario_.arm.chambers + scenario_.arm.tendons + scenario_.arm.servos + (jammed ? 1 : 0);
  EXPECT_EQ(arm_.inputs.scalars.size(), static_cast<std::size_t>(driven));
  EXPECT_DOUBLE_EQ(arm_.inputs.ambient_pressure_pa, scenario_.pressures.ambient_pa);
}

TEST_P(ScenarioPairs, SameRingsAndPayload) {
  const std::vector<double>& fractions = scenario_.mocap.ring_fractions;
  ASSERT_EQ(arm_.bodies.size(), fractions.size());
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    EXPECT_EQ(arm_.bodies[i].name, "ring_" + std::to_string(i + 1));
    EXPECT_NEAR(arm_.bodies[i].arclength_m, fractions[i] * arm_.total_length_m(), 1e-6);
  }
  EXPECT_NEAR(arm_.payload.arclength_m, scenario_.payload.fraction * arm_.total_length_m(), 1e-6);
  EXPECT_DOUBLE_EQ(-arm_.gravity_m_s2.z(), scenario_.gravity_m_s2);
  EXPECT_EQ(arm_.base.body, "base");
  EXPECT_TRUE(scenario_.mocap.base_measured);
}

INSTANTIATE_TEST_SUITE_P(
    Shipped, ScenarioPairs,
    ::testing::Values(Pair{"demo", "online_200mm"}, Pair{"standing", "online_200mm"},
                      Pair{"trial_10s", "online_200mm"}, Pair{"trial_both", "online_200mm"},
                      Pair{"semi_physical_200mm", "semi_physical_200mm"},
                      Pair{"single_chamber_85mm", "single_chamber_85mm"}, Pair{"hybrid_85mm", "hybrid_85mm"},
                      Pair{"cable_235mm", "cable_235mm"}, Pair{"two_segment", "two_segment"}),
    [](const auto& parameter) { return parameter.param.scenario; });

/// A scenario of an arm's name is of that arm: it must be among the pairs.
TEST(ScenarioNames, EveryArmsScenarioIsCompared) {
  int same = 0;
  for (const auto& entry : fs::directory_iterator(kConfig / "scenarios")) {
    if (fs::exists(kConfig / "arms" / entry.path().filename())) ++same;
  }
  EXPECT_EQ(same, 5) << "add the new one to the pairs above";
}

}  // namespace
}  // namespace softarm
