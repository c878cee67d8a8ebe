// The viscoelastic wall: exact for inputs that go straight, forgetting its beginning as its law says, with
// the derivatives of its walk, and refused in one line where it cannot be.
#include <gtest/gtest.h>

#include <cmath>

#include "arm/arm_writer.h"
#include "arm/constant_spec.h"
#include "arm/wall_memory.h"
#include "softarm/arm/arm_file.h"
#include "softarm/arm/constants.h"

namespace softarm {
namespace {

std::string walled_text(const std::string& wall) {
  return R"(format: 1
name: creeping
base: {body: base}
segments:
  - name: segment_1
    length_m: 0.2
    mass_per_length_kg_m: 1.0
    diameter_m: 0.04
    bending_stiffness: {base_nm2: 0.03}
    wall:
)" + wall +
         R"(    chambers:
      - {input: p1, bending_direction_deg: 0, moment_gain_nm_per_pa: 6.0e-6, near_elongation_m_per_pa: 1.0e-7}
      - {input: p2, bending_direction_deg: 90, moment_gain_nm_per_pa: 7.0e-6}
bodies:
  - {name: ring_1, arclength_m: tip}
inputs:
  pressures: [{name: p1, topic: /p1}, {name: p2, topic: /p2}]
)";
}

const std::string kWall =
    "      bending: [{time_s: 0.5, share: 0.3}, {time_s: 8, share: 0.2}]\n"
    "      axial: [{time_s: 3, share: 0.4}]\n"
    "      slows_per_pa: 1.0e-5\n"
    "      shares_grow_per_pa: 2.0e-5\n";

arm::Arm walled(const std::string& wall = kWall) {
  return arm::parse_arm(walled_text(wall), "arm.yaml");
}

/// Bending by the first chamber and length, frame by frame at inputs of so many Pa.
struct Walked {
  std::vector<double> curvature, length;
};

Walked walked(const arm::Arm& arm, const std::vector<double>& t_s, const std::vector<double>& pa) {
  arm::LawMemory memory(arm);
  Walked made;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    auto laws = arm::predict(arm, {pa[i], 0.0});
    memory.follow(t_s[i], {pa[i], 0.0}, *laws);
    made.curvature.push_back(laws->front().actuation_nm().x() / laws->front().bending_stiffness_nm2);
    made.length.push_back(laws->front().length_m);
  }
  return made;
}

TEST(Wall, StepByHand) {
  const arm::Arm arm =
      walled("      bending: [{time_s: 0.5, share: 0.3}]\n      axial: [{time_s: 3, share: 0.4}]\n");
  // The step takes no time: the drive is held from 1e-9 s on.
  const Walked made = walked(arm, {0.0, 1e-9, 0.5, 3.0}, {0.0, 30e3, 30e3, 30e3});
  const double all = 6.0e-6 * 30e3 / 0.03, longer = walked(arm, {0.0}, {30e3}).length[0] - 0.2;
  EXPECT_NEAR(made.curvature[1], 0.7 * all, 1e-6);
  EXPECT_NEAR(made.curvature[2], all * (1.0 - 0.3 * std::exp(-1.0)), 1e-6);
  EXPECT_NEAR(made.curvature[3], all * (1.0 - 0.3 * std::exp(-6.0)), 1e-6);
  EXPECT_NEAR(made.length[3], 0.2 + longer * (1.0 - 0.4 * std::exp(-1.0)), 1e-9);
  EXPECT_GT(longer, 1e-4);
}

TEST(Wall, StraightInputsAreExactWhateverTheFrames) {
  const arm::Arm arm = walled("      bending: [{time_s: 0.5, share: 0.3}, {time_s: 8, share: 0.2}]\n");
  std::vector<double> t{0.0, 2.0}, pa{0.0, 40e3}, fine_t, fine_pa;
  for (int i = 0; i <= 4000; ++i) {
    fine_t.push_back(2.0 * i / 4000.0);
    fine_pa.push_back(40e3 * i / 4000.0);
  }
  const Walked coarse = walked(arm, t, pa), fine = walked(arm, fine_t, fine_pa);
  EXPECT_NEAR(coarse.curvature.back(), fine.curvature.back(), 1e-9);
  EXPECT_GT(6.0e-6 * 40e3 / 0.03 - fine.curvature.back(), 0.1) << "it creeps";
}

TEST(Wall, PressureSlowsIt) {
  const std::string plain = "      bending: [{time_s: 2, share: 0.5}]\n";
  const std::vector<double> t{0.0, 1e-9, 2.0}, pa{0.0, 40e3, 40e3};
  // The mean of both chambers: 20 kPa.
  const Walked made = walked(walled(plain + "      slows_per_pa: 5.0e-5\n"), t, pa);
  EXPECT_NEAR(made.curvature[2], 8.0 * (1.0 - 0.5 * std::exp(-0.5)), 1e-6);
  EXPECT_NEAR(walked(walled(plain), t, pa).curvature[2], 8.0 * (1.0 - 0.5 * std::exp(-1.0)), 1e-6);
}

TEST(Wall, PressureMakesMoreOfItLate) {
  const std::string plain = "      bending: [{time_s: 2, share: 0.3}, {time_s: 2, share: 0.2}]\n";
  const std::vector<double> t{0.0, 1e-9, 1.0}, pa{0.0, 40e3, 40e3};
  // The mean of both chambers is 20 kPa: late over at once 1 before, 1.4 now.
  const Walked made = walked(walled(plain + "      shares_grow_per_pa: 2.0e-5\n"), t, pa);
  EXPECT_NEAR(made.curvature[1], 8.0 / 2.4, 1e-6);
  EXPECT_NEAR(made.curvature[2], 8.0 * (1.0 - 1.4 / 2.4 * std::exp(-0.5)), 1e-6);
  // At any pressure something comes at once.
  const Walked high = walked(walled(plain + "      shares_grow_per_pa: 0.001\n"), t, {0.0, 5e6, 5e6});
  EXPECT_GT(high.curvature[1], 0.0);
}

TEST(Wall, BeginsAnewWhereTheClockGoesBackAndForgetsItsBeginning) {
  const arm::Arm arm =
      walled("      bending: [{time_s: 2, share: 0.5}]\n      initial_curvature_sd_per_m: 3\n");
  const Walked made = walked(arm, {10.0, 10.5, 5.0}, {0.0, 30e3, 30e3});
  EXPECT_LT(made.curvature[1], 5.9);
  EXPECT_NEAR(made.curvature[2], 6.0, 1e-12);
  arm::LawMemory memory(arm);
  const auto sd_at = [&](double t_s, double pa) {
    auto laws = arm::predict(arm, {pa, 0.0});
    memory.follow(t_s, {pa, 0.0}, *laws);
    return std::sqrt(memory.variance(0).x());
  };
  EXPECT_NEAR(sd_at(0.0, 30e3), 1.5, 1e-12);
  EXPECT_NEAR(sd_at(2.0, 30e3), 1.5 * std::exp(-1.0), 1e-12);
  EXPECT_NEAR(sd_at(200.0, 30e3), 0.0, 1e-12);
  EXPECT_GT(sd_at(210.0, 0.0), 0.5) << "of a gap it is not known when the input changed";
  EXPECT_NEAR(sd_at(0.0, 0.0), 1.5, 1e-12);
}

TEST(Wall, WithoutElementsLawsAreAsTheyWere) {
  const arm::Arm without = walled("      bending: []\n");
  EXPECT_FALSE(arm::has_wall(without));
  EXPECT_TRUE(arm::LawMemory(without).empty());
  const arm::Arm none = walled("      bending: [{time_s: 2, share: 0}]\n");
  EXPECT_DOUBLE_EQ(walked(none, {0.0, 0.1}, {0.0, 30e3}).curvature[1], 6.0);
}

TEST(Wall, DerivativesOfTheWalk) {
  const arm::Arm arm = walled();
  const std::vector<arm::ConstantRef> refs{
      {arm::ConstantKind::kWallBendingTime, 0, 0},  {arm::ConstantKind::kWallBendingTime, 0, 1},
      {arm::ConstantKind::kWallBendingShare, 0, 1}, {arm::ConstantKind::kWallAxialTime, 0, 0},
      {arm::ConstantKind::kWallAxialShare, 0, 0},   {arm::ConstantKind::kWallSlowing, 0, 0},
      {arm::ConstantKind::kWallShareGrowth, 0, 0}};
  const Eigen::VectorXd start = (Eigen::VectorXd(5) << 0.7, -0.4, 0.2, 0.9, 0.003).finished();
  Eigen::Matrix3Xd by, by_start;
  const auto lag = [&](const arm::Arm& of, const Eigen::VectorXd& from) {
    const arm::Segment& segment = of.segments[0];
    arm::WallMemory memory(segment);
    std::vector<arm::WallChange> changes;
    for (const arm::ConstantRef& ref : refs)
      changes.push_back(arm::spec_of(ref.kind).wall(segment, ref.index));
    for (int i = 0; i <= 20; ++i) {
      arm::WallDrive drive;
      drive.value = Eigen::Vector3d(std::sin(0.4 * i), std::cos(0.3 * i), 0.2 + 0.01 * std::sin(0.2 * i));
      drive.pressure_pa = 1e4 * (1.0 + std::sin(0.5 * i));
      drive.by.setZero(3, static_cast<Eigen::Index>(refs.size()));
      if (i == 0) {
        memory.begin(drive, from);
      } else {
        memory.follow(0.05 * (1.0 + i % 4), drive, changes);
      }
    }
    by = memory.lag_by(changes);
    by_start = memory.lag_by_start();
    return memory.lag();
  };
  lag(arm, start);
  const Eigen::Matrix3Xd found = by, of_start = by_start;
  for (std::size_t j = 0; j < refs.size(); ++j) {
    const double value = arm::value_of(arm, refs[j]), h = 1e-5 * value;
    arm::Arm up = arm, down = arm;
    arm::set_value(up, refs[j], value + h);
    arm::set_value(down, refs[j], value - h);
    const Eigen::Vector3d difference = (lag(up, start) - lag(down, start)) / (2.0 * h);
    EXPECT_LT((difference - found.col(static_cast<Eigen::Index>(j))).norm(), 1e-7 * difference.norm() + 1e-12)
        << arm::name_of(arm, refs[j]);
    EXPECT_GT(difference.norm(), 0.0);
  }
  for (Eigen::Index k = 0; k < start.size(); ++k) {
    const Eigen::VectorXd step = 1e-4 * Eigen::VectorXd::Unit(start.size(), k);
    const Eigen::Vector3d difference = (lag(arm, start + step) - lag(arm, start - step)) / 2e-4;
    EXPECT_LT((difference - of_start.col(k)).norm(), 1e-9);
  }
}

TEST(Wall, IsWrittenBackAndItsConstantsAreFreeByDefault) {
  arm::Arm arm = walled();
  std::string free;
  for (const arm::ConstantRef& one : arm::default_free(arm)) free += arm::name_of(arm, one) + " ";
  for (const char* name : {"wall.bending_1.time", "wall.bending_2.share", "wall.axial_1.time",
                           "wall.axial_1.share", "wall.slowing", "wall.share_growth"})
    EXPECT_NE(free.find(name), std::string::npos) << name << " of " << free;
  arm.segments[0].wall.bending[1] = {9.5, 0.25};
  arm.segments[0].wall.axial[0].time_s = 4.0;
  arm.segments[0].wall.slows_per_pa = 2e-5;
  arm.segments[0].wall.shares_grow_per_pa = 3e-5;
  const arm::Arm again =
      arm::parse_arm(arm::update_arm_text(walled_text(kWall), "arm.yaml", arm, {}), "arm.yaml");
  EXPECT_DOUBLE_EQ(again.segments[0].wall.bending[1].time_s, 9.5);
  EXPECT_DOUBLE_EQ(again.segments[0].wall.bending[1].share, 0.25);
  EXPECT_DOUBLE_EQ(again.segments[0].wall.axial[0].time_s, 4.0);
  EXPECT_DOUBLE_EQ(*again.segments[0].wall.slows_per_pa, 2e-5);
  EXPECT_DOUBLE_EQ(*again.segments[0].wall.shares_grow_per_pa, 3e-5);
}

TEST(Wall, SharesNeverTakeAllHoweverTheyAreFitted) {
  arm::Arm arm = walled();
  for (int k = 0; k < 2; ++k) {
    const arm::ConstantRef share{arm::ConstantKind::kWallBendingShare, 0, k};
    EXPECT_GT(arm::allowed_range(walled(), share).high, arm::value_of(arm, share));
    arm::set_value(arm, share, arm::allowed_range(walled(), share).high);
  }
  EXPECT_LE(arm.segments[0].wall.bending[0].share + arm.segments[0].wall.bending[1].share,
            arm::kMostWallShare + 1e-12);
}

TEST(Wall, BadValuesGiveOneLine) {
  const auto refusal = [](const std::string& wall) -> std::string {
    try {
      walled(wall);
    } catch (const arm::ArmError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("      bending: [{time_s: 0.001, share: 0.3}]\n"),
            "arm.yaml:11: key 'segments[0].wall.bending[0].time_s': value 0.001 is outside the allowed range "
            "[0.01, 3600] s");
  EXPECT_EQ(refusal("      axial: [{time_s: 1, share: 0.6}, {time_s: 9, share: 0.5}]\n"),
            "arm.yaml:11: key 'segments[0].wall.axial[1].share': value 0.5 makes 1.1 of all shares of axial "
            "together; at most 0.98 comes late");
  EXPECT_NE(refusal("      bending: [{time_s: 1, share: 0.1}, {time_s: 2, share: 0.1}, {time_s: 3, share: "
                    "0.1}, {time_s: 4, share: 0.1}]\n")
                .find("has 4 entries; allowed: list of up to 3 sections"),
            std::string::npos);
  EXPECT_NE(refusal("      slows_per_pa: -1\n").find("outside the allowed range"), std::string::npos);
}

}  // namespace
}  // namespace softarm
