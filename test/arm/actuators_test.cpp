// Every kind of actuator in the table is read, written, predicted, differentiated and, where it has a place,
// drawn; and every constant of every shipped arm has the derivative that finite differences show.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>

#include "arm/actuators/actuator.h"
#include "arm/arm_writer.h"
#include "arm_text.h"
#include "softarm/arm/constants.h"
#include "softarm/arm/laws.h"

namespace softarm {
namespace {

/// An arm that has some of every kind; a new kind is added here.
const std::string kOfEveryKind = R"(format: 1
name: every_kind
base: {body: base}
segments:
  - name: lower
    length_m: 0.2
    mass_per_length_kg_m: 1.0
    diameter_m: 0.04
    axial_stiffness_n: 300
    torsional_stiffness_nm2: 0.02
    shear_stiffness_n: 100
    joint_compliance_rad_per_nm: 0.3
    chambers_saturation_per_pa: 3.0e-6
    tendons_saturation_per_n: 0.05
    cables_saturation_per_rad: 0.2
    bending_stiffness:
      base_nm2: 0.03
      per_min_pressure_nm2_per_pa: 2.0e-7
      per_jamming_pressure_nm2_per_pa: 3.0e-7
      per_mean_pressure_nm2_per_pa: 1.0e-7
      per_tension_nm2_per_n: 1.0e-3
      per_angle_nm2_per_rad: 2.0e-3
      per_min_tension_nm2_per_n: 3.0e-3
      per_min_angle_nm2_per_rad: 4.0e-3
      by_pressure:
        - {pressure_pa: 0, bending_stiffness_nm2: 0.03}
        - {pressure_pa: 10000, bending_stiffness_nm2: 0.035}
        - {pressure_pa: 30000, bending_stiffness_nm2: 0.05}
    chambers:
      - {input: p1, bending_direction_deg: 90, moment_gain_nm_per_pa: 6.0e-6, near_elongation_m_per_pa: 1.0e-7,
         saturation_per_pa: 1.0e-5, stiffness_gain_nm2_per_pa: 5.0e-8}
      - {input: p2, bending_direction_deg: 210, moment_gain_nm_per_pa: 7.0e-6}
    jamming_input: v1
    central_chamber: {input: p3, area_m2: 1.0e-4}
    tendons:
      - {input: t1, bending_direction_deg: 20, offset_m: 0.01, saturation_per_n: 0.1}
      - {input: t2, bending_direction_deg: 140, offset_m: 0.012, stiffness_gain_nm2_per_n: 5.0e-3}
    cables:
      - {input: a1, bending_direction_deg: -30, curvature_gain_per_m_rad: 5, saturation_per_rad: 0.4}
      - {input: a2, bending_direction_deg: 60, spool_radius_m: 0.01, lever_m: 0.02,
         stiffness_gain_nm2_per_rad: 6.0e-3}
bodies:
  - {name: ring_1, arclength_m: tip}
inputs:
  pressures:
    - {name: p1, topic: /p1}
    - {name: p2, topic: /p2}
    - {name: p3, topic: /p3}
    - {name: v1, topic: /v1, vacuum: true}
  tensions:
    - {name: t1, topic: /t1}
    - {name: t2, topic: /t2}
  angles:
    - {name: a1, topic: /a1}
    - {name: a2, topic: /a2}
)";

double usual_value(arm::InputKind kind) {
  return kind == arm::InputKind::kTension ? 1.1 : kind == arm::InputKind::kAngle ? 0.3 : 1.7e4;
}

/// All different, between the kinks of the laws.
arm::InputValues usual_inputs(const arm::Arm& arm) {
  arm::InputValues inputs;
  for (const arm::ScalarInput& input : arm.inputs.scalars)
    inputs.emplace_back(usual_value(input.kind) * (1.0 + 0.1 * static_cast<double>(inputs.size())));
  return inputs;
}

std::size_t row_of_input(const arm::Arm& arm, const std::string& name) {
  const auto& all = arm.inputs.scalars;
  const auto at =
      std::find_if(all.begin(), all.end(), [&](const arm::ScalarInput& input) { return input.name == name; });
  return static_cast<std::size_t>(at - all.begin());
}

/// What the laws and the segment hand to the rod.
Eigen::VectorXd numbers_of(const arm::SegmentPrediction& p, double ea = 0.0,
                           const Eigen::Vector2d& rest = Eigen::Vector2d::Zero(), double joint = 0.0) {
  Eigen::VectorXd all(13);
  all << p.moment_nm, p.curvature_per_m, p.bending_stiffness_nm2, p.length_m, p.modulus_ratio,
      p.tendon_shear_stiffness_n, p.tendon_torsional_stiffness_nm2, ea, rest, joint;
  return all;
}

/// At another value of a constant, by the means of the law alone: a length does not carry its mass along.
Eigen::VectorXd numbers_at(const arm::Arm& arm, const arm::ConstantRef& constant, double value,
                           const arm::InputValues& inputs) {
  arm::Segment segment = arm.segments[static_cast<std::size_t>(constant.segment)];
  arm::spec_of(constant.kind).set(segment, constant.index, value);
  const auto p = arm::predict_segment(arm, segment, inputs);
  EXPECT_TRUE(p);
  return numbers_of(p.value_or(arm::SegmentPrediction()), segment.axial_stiffness_n.value_or(0.0),
                    segment.rest_curvature_per_m.head<2>(),
                    segment.joint_compliance_rad_per_nm.value_or(0.0));
}

void expect_derivative(const arm::Arm& arm, const arm::ConstantRef& constant,
                       const arm::InputValues& inputs) {
  SCOPED_TRACE(arm::name_of(arm, constant));
  const arm::ConstantSpec& spec = arm::spec_of(constant.kind);
  const arm::Segment& segment = arm.segments[static_cast<std::size_t>(constant.segment)];
  const arm::InputReader reader(arm, inputs);
  const auto here = arm::respond(segment, reader);
  ASSERT_TRUE(here);
  arm::Change change;
  ASSERT_TRUE(spec.change(segment, constant.index, reader, change));
  const arm::SegmentDerivative by = arm::differentiate(segment, *here, change);
  const double value = spec.value(segment, constant.index);
  const double h =
      1e-4 * (value != 0.0 ? std::abs(value) : 1e-2 * spec.allowed(segment, constant.index).high);
  const Eigen::VectorXd above = numbers_at(arm, constant, value + h, inputs);
  const Eigen::VectorXd below = numbers_at(arm, constant, value - h, inputs);
  const Eigen::VectorXd analytic = numbers_of(by.prediction, by.axial_stiffness_n, by.rest_curvature_per_m,
                                              by.joint_compliance_rad_per_nm);
  for (Eigen::Index k = 0; k < analytic.size(); ++k) {
    const double difference = above[k] - below[k];
    const double rounding = 1e-14 * (std::abs(above[k]) + std::abs(below[k]));
    EXPECT_NEAR(2.0 * h * analytic[k], difference, 1e-6 * std::abs(difference) + rounding) << "number " << k;
  }
  const Eigen::Vector2d actuation =
      (above.head<2>() + above[4] * above.segment<2>(2)) - (below.head<2>() + below[4] * below.segment<2>(2));
  EXPECT_LT((2.0 * h * by.actuation_nm(here->prediction) - actuation).norm(),
            1e-6 * actuation.norm() + 1e-15);
}

std::vector<std::string> names_of_kinds() {
  std::vector<std::string> names;
  for (const arm::ActuatorKind* kind : arm::actuator_kinds()) names.emplace_back(kind->traits().name);
  return names;
}

class EveryKind : public ::testing::TestWithParam<std::string> {
 protected:
  const arm::ActuatorKind& kind() const {
    const std::vector<std::string> names = names_of_kinds();
    const auto at = std::find(names.begin(), names.end(), GetParam()) - names.begin();
    return *arm::actuator_kinds()[static_cast<std::size_t>(at)];
  }
  const arm::Arm arm_ = arm::parse_arm(kOfEveryKind, "every_kind.yaml");
  const arm::Segment& segment_ = arm_.segments.front();
};

TEST_P(EveryKind, IsReadWithTheKindOfInputThatItSays) {
  ASSERT_GT(kind().count(segment_), 0) << "add some to kOfEveryKind";
  EXPECT_EQ(kind().count(arm::Segment()), 0);
  for (int i = 0; i < kind().count(segment_); ++i) {
    const std::size_t row = row_of_input(arm_, kind().input(segment_, i));
    ASSERT_LT(row, arm_.inputs.scalars.size());
    EXPECT_EQ(arm_.inputs.scalars[row].kind, kind().traits().input_kind);
    const std::vector<int> needed = arm::inputs_of(arm_, segment_);
    EXPECT_EQ(std::count(needed.begin(), needed.end(), static_cast<int>(row)), 1);
  }
  const std::string keys = arm::describe_arm_keys();
  for (const arm::yaml::KeySpec& key : kind().segment_keys())
    EXPECT_NE(keys.find("| `" + key.name + "` |"), std::string::npos) << key.name;
  for (const arm::yaml::KeyTable* table : kind().segment_tables())
    EXPECT_NE(keys.find("### `" + table->section + "`"), std::string::npos) << table->section;
}

TEST_P(EveryKind, IsPredictedFromEachOfItsInputs) {
  const arm::InputValues inputs = usual_inputs(arm_);
  const auto here = arm::predict_segment(arm_, segment_, inputs);
  ASSERT_TRUE(here);
  for (int i = 0; i < kind().count(segment_); ++i) {
    const std::string& name = kind().input(segment_, i);
    const std::size_t row = row_of_input(arm_, name);
    arm::InputValues other = inputs;
    *other[row] *= 1.3;
    const auto there = arm::predict_segment(arm_, segment_, other);
    ASSERT_TRUE(there);
    EXPECT_NE(numbers_of(*here), numbers_of(*there)) << name;
    other[row].reset();
    EXPECT_FALSE(arm::predict_segment(arm_, segment_, other)) << name;
    EXPECT_EQ(arm::missing_inputs(arm_, segment_, other), name);
  }
}

TEST_P(EveryKind, IsDifferentiatedByEachOfItsConstants) {
  for (const arm::ConstantSpec& spec : kind().constants()) {
    ASSERT_GT(spec.count(segment_), 0) << spec.name;
    for (int i = 0; i < spec.count(segment_); ++i)
      expect_derivative(arm_, {spec.kind, 0, i}, usual_inputs(arm_));
  }
}

TEST_P(EveryKind, IsWrittenWithEachOfItsConstants) {
  for (const arm::ConstantSpec& spec : kind().constants()) {
    for (int i = 0; i < spec.count(segment_); ++i) {
      const arm::ConstantRef constant{spec.kind, 0, i};
      arm::Arm changed = arm_;
      const double value = 1.03 * arm::value_of(arm_, constant) + 1e-9;
      arm::set_value(changed, constant, value);
      const std::string written = arm::update_arm_text(kOfEveryKind, "every_kind.yaml", changed);
      EXPECT_NE(written, kOfEveryKind) << arm::name_of(arm_, constant);
      EXPECT_NEAR(arm::value_of(arm::parse_arm(written, "written.yaml"), constant), value, 1e-8 * value)
          << arm::name_of(arm_, constant);
    }
  }
}

TEST_P(EveryKind, HasNamesUnitsScalesAndAdviceForItsConstants) {
  struct NothingRecorded : arm::RecordedInputs {
    std::vector<double> values(const std::string&) const override { return {0.0, 0.0}; }
    std::string load_advice() const override { return "loads"; }
  } const recorded;
  const std::vector<arm::ConstantRef> all = arm::constants_of(arm_);
  for (const arm::ConstantSpec& spec : kind().constants()) {
    for (int i = 0; i < spec.count(segment_); ++i) {
      const arm::Range allowed = spec.allowed(segment_, i);
      EXPECT_LE(allowed.low, spec.value(segment_, i));
      EXPECT_GE(allowed.high, spec.value(segment_, i));
      EXPECT_GT(spec.scale(segment_, i, recorded), 0.0);
      EXPECT_FALSE(spec.advice(segment_, i, recorded).empty());
      EXPECT_FALSE(arm::unit_of(spec.kind).empty());
      EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const arm::ConstantRef& c) {
        return c.kind == spec.kind && c.index == i;
      }));
    }
  }
}

/// Pictures are tested in test/ros/messages_test.cpp.
TEST_P(EveryKind, IsPlacedOnTheSideTowardsWhichItBends) {
  for (int i = 0; i < kind().count(segment_); ++i) {
    const auto place_m = kind().place_m(segment_, i);
    if (!place_m) continue;
    EXPECT_GT(place_m->norm(), 0.0);
    EXPECT_LE(place_m->norm(), 0.5 * segment_.diameter_m);
    const auto azimuth_rad = kind().bending_direction_rad(segment_, i);
    ASSERT_TRUE(azimuth_rad);
    EXPECT_LT((place_m->normalized() - arm::towards(*azimuth_rad)).norm(), 1e-12);
  }
}

TEST_P(EveryKind, BendsAndStrainsAsItSays) {
  const auto drive = [&](double factor) {
    arm::InputValues inputs = usual_inputs(arm_);
    for (std::optional<double>& value : inputs) *value *= factor;
    arm::Drive result;
    EXPECT_TRUE(kind().drive(segment_, arm::InputReader(arm_, inputs), result));
    return result;
  };
  const arm::Drive one = drive(1.0), none = drive(0.0);
  const bool bends = !(one.moment_nm.isZero(0.0) && one.curvature_per_m.isZero(0.0));
  EXPECT_EQ(kind().bending_direction_rad(segment_, 0).has_value(), bends);
  EXPECT_EQ(kind().traits().strains, one.axial_force_n != 0.0);
  EXPECT_EQ(kind().traits().drives, bends || one.axial_force_n != 0.0);
  EXPECT_EQ(kind().stiffens(segment_), one.added_stiffness_nm2 != none.added_stiffness_nm2 ||
                                           one.base_stiffness_nm2 != none.base_stiffness_nm2);
}

INSTANTIATE_TEST_SUITE_P(Actuators, EveryKind, ::testing::ValuesIn(names_of_kinds()),
                         [](const auto& parameter) { return parameter.param; });

/// Arms as they ship, and the ways of composing that none of them has.
std::vector<std::pair<std::string, arm::Arm>> arms_to_differentiate() {
  std::vector<std::pair<std::string, arm::Arm>> arms;
  const std::filesystem::path folder = std::filesystem::path(SOFTARM_SOURCE_DIR) / "config" / "arms";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml")
      arms.emplace_back(entry.path().stem().string(), arm::load_arm_file(entry.path().string()));
  }
  arms.emplace_back("every_kind", arm::parse_arm(kOfEveryKind, "every_kind.yaml"));
  arm::Arm rubber = arms.back().second;
  rubber.segments[0].bending_stiffness.by_pressure.clear();
  rubber.segments[0].material = arm::Material{18800.0, -10000.0};
  arms.emplace_back("every_kind_of_rubber", rubber);
  rubber.segments[0].bending_stiffness.by_pressure = {{0.0, 0.03}, {4e4, 0.05}};
  arms.emplace_back("knots_and_rubber", rubber);
  return arms;
}

TEST(ConstantDerivatives, OfEveryConstantOfEveryShippedArmAgreeWithFiniteDifferences) {
  for (const auto& [name, arm] : arms_to_differentiate()) {
    SCOPED_TRACE(name);
    for (const double share : {0.0, 0.4, 1.0}) {
      arm::InputValues inputs = usual_inputs(arm);
      for (std::optional<double>& value : inputs) *value *= share;
      if (!arm::predict(arm, inputs)) continue;  // beyond the laws
      for (const arm::ConstantRef& constant : arm::constants_of(arm))
        expect_derivative(arm, constant, inputs);
    }
  }
}

TEST(ConstantDerivatives, AtTheKinksAreThoseOfOneSide) {
  arm::Arm arm = arm::parse_arm(kOfEveryKind, "every_kind.yaml");
  arm::InputValues inputs = usual_inputs(arm);
  *inputs[0] = -500.0;                      // a sensor's zero: no chamber stiffens
  *inputs[2] = 10000.0;                     // on a knot
  *inputs[row_of_input(arm, "t1")] = -0.2;  // slack
  *inputs[row_of_input(arm, "a1")] = -0.3;  // the other way
  for (const arm::ConstantRef& constant : arm::constants_of(arm)) expect_derivative(arm, constant, inputs);
}

TEST(ConstantDerivatives, AreMissingWhereAnInputIs) {
  arm::Arm arm = arm::parse_arm(kOfEveryKind, "every_kind.yaml");
  // With b3 at zero the laws do without the vacuum; its derivative does not.
  arm.segments[0].bending_stiffness.per_jamming_pressure_nm2_per_pa = 0.0;
  arm::InputValues inputs = usual_inputs(arm);
  inputs[row_of_input(arm, "v1")].reset();
  EXPECT_TRUE(arm::predict(arm, inputs));
  arm::Change change;
  EXPECT_FALSE(arm::spec_of(arm::ConstantKind::kPerJammingPressure)
                   .change(arm.segments[0], 0, arm::InputReader(arm, inputs), change));
}

}  // namespace
}  // namespace softarm
