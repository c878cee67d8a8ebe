// The arm files that ship, and the documentation of their keys.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "softarm/arm/arm_yaml.h"
#include "softarm/arm/laws.h"

namespace softarm {
namespace {

const std::filesystem::path kArms = std::filesystem::path(SOFTARM_SOURCE_DIR) / "config" / "arms";

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file.good()) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

Arm shipped(const std::string& name) {
  return parse_arm(read(kArms / (name + ".yaml")), name + ".yaml");
}

TEST(ShippedArms, AllParseAndAreNamedAsTheirFiles) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kArms)) {
    if (entry.path().extension() != ".yaml") continue;
    const std::string name = entry.path().stem().string();
    names.push_back(name);
    try {
      EXPECT_EQ(shipped(name).name, name);
    } catch (const ArmError& error) {
      ADD_FAILURE() << error.what();
    }
  }
  for (const char* const name : {"online_200mm", "semi_physical_200mm", "pouch_arm_one_segment"}) {
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  }
}

TEST(ShippedArms, EveryMethodWorksOnTheOnlineArm) {
  std::string text = read(kArms / "online_200mm.yaml");
  const std::string method = "method: full_points";
  text.replace(text.find(method), method.size(), "method: end_orientation");
  EXPECT_NO_THROW(parse_arm(text, "online"));
}

TEST(ShippedArms, OnlineArmIsThePapers) {
  const Arm arm = shipped("online_200mm");
  EXPECT_DOUBLE_EQ(arm.total_length_m(), 0.2);
  EXPECT_DOUBLE_EQ(arm.segments[0].mass_per_length_kg_m * arm.total_length_m(), 0.2);
  ASSERT_EQ(arm.bodies.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(arm.bodies[i].name, "ring_" + std::to_string(i + 1));
    EXPECT_NEAR(arm.bodies[i].arclength_m, 0.05 * static_cast<double>(i + 1), 1e-12);
  }
  // 2.6 % at 50 kPa in all chambers.
  const auto full = predict_segment(arm, arm.segments[0], {50e3, 50e3, 50e3});
  ASSERT_TRUE(full);
  EXPECT_NEAR(full->length_m / 0.2 - 1.0, 0.026, 1e-4);
  EXPECT_NEAR(full->bending_stiffness_nm2, 0.042, 1e-12);
}

TEST(ShippedArms, SemiPhysicalArmIsTableOne) {
  const Arm arm = shipped("semi_physical_200mm");
  EXPECT_NEAR(arm.segments[0].mass_per_length_kg_m * arm.total_length_m(), 0.176, 1e-12);
  // 50 kPa in all chambers, 60 kPa of vacuum: 0.2 + 0.050 * 2.545, 0.027 + 0.015 + 0.0013 * 110,
  // x: 0.305 - (0.39 + 0.325) / 2, y: (0.39 - 0.325) sqrt(3) / 2.
  const auto full = predict_segment(arm, arm.segments[0], {50e3, 50e3, 50e3, 60e3});
  ASSERT_TRUE(full);
  EXPECT_NEAR(full->length_m, 0.32725, 1e-9);
  EXPECT_NEAR(full->bending_stiffness_nm2, 0.185, 1e-9);
  EXPECT_NEAR(full->moment_nm.x(), -0.0525, 1e-9);
  EXPECT_NEAR(full->moment_nm.y(), 0.065 * std::sqrt(3.0) / 2, 1e-9);
}

/// What the laws make of the highest inputs must be within the arm's own sanity limits.
TEST(ShippedArms, LawsStayWithinTheirLimits) {
  for (const char* const name : {"online_200mm", "semi_physical_200mm", "pouch_arm_one_segment"}) {
    const Arm arm = shipped(name);
    for (const Segment& segment : arm.segments) {
      const auto full = predict_segment(arm, segment, InputValues(arm.inputs.scalars.size(), 50e3));
      ASSERT_TRUE(full) << name;
      EXPECT_GE(full->length_m, segment.length_range_m.low) << name;
      EXPECT_LE(full->length_m, segment.length_range_m.high) << name;
      EXPECT_LE(full->bending_stiffness_nm2, segment.bending_stiffness_range_nm2.high) << name;
    }
  }
}

/// A pose of the recordings (no_load/data_collect_1, first row), typed in: the tip hangs below the base and
/// leans towards the rod's +x, and the measured tangent agrees.
TEST(ShippedArms, PouchArmHangsAndBendsTowardsPhiZero) {
  const Arm arm = shipped("pouch_arm_one_segment");
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  base.translation() = Eigen::Vector3d(0.0059, -0.2092, 0.4738);
  Eigen::Isometry3d tip = Eigen::Isometry3d::Identity();
  tip.translation() = Eigen::Vector3d(0.0020, -0.2081, 0.3543);
  tip.linear() = Eigen::Quaterniond(-0.9990, 0.0012, -0.0444, -0.0008).normalized().toRotationMatrix();
  const Eigen::Isometry3d rod = base * arm.base.rod_in_body;
  const auto check = [&](const Eigen::Isometry3d& tip_body) {
    const Eigen::Isometry3d section = rod.inverse() * tip_body * arm.bodies.at(0).section_in_body;
    EXPECT_NEAR(section.translation().z(), 0.1195, 1e-3);
    EXPECT_GT(section.translation().x(), 0.003);
    const Eigen::Vector3d tangent = section.linear().col(2);
    EXPECT_NEAR(std::atan2(tangent.x(), tangent.z()), 0.089, 2e-3);
  };
  check(tip);
  // The known fault, a frame turned by 180 deg about its z, changes nothing that is used.
  Eigen::Isometry3d flipped = tip;
  flipped.linear() = tip.linear() * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  check(flipped);
}

TEST(ShippedArms, TemplateNamesEveryKey) {
  const std::string file = read(kArms / "online_200mm.yaml");
  std::istringstream table(describe_arm_keys());
  int keys = 0;
  for (std::string line; std::getline(table, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    const std::string key = line.substr(3, line.find('`', 3) - 3);
    EXPECT_NE(file.find(key + ":"), std::string::npos) << "online_200mm.yaml does not mention " << key;
    ++keys;
  }
  EXPECT_GT(keys, 60);
}

TEST(ShippedArms, ReadmeHoldsTheTableOfKeys) {
  EXPECT_NE(read(kArms / "README.md").find(describe_arm_keys()), std::string::npos)
      << "config/arms/README.md must end with:\n"
      << describe_arm_keys();
}

}  // namespace
}  // namespace softarm
