// Faults put into a clean recording, one at a time: each is found, and the clean one is left in peace.
#include "softarm/check/check.h"

#include <gmock/gmock.h>

#include <limits>
#include <utility>

#include "check_fixture.h"

namespace softarm {
namespace {

using namespace testing_check;
using ::testing::HasSubstr;

class Check : public ::testing::Test {
 protected:
  check::CheckReport report() const { return check::check_recording(recording, arm); }
  void expect(const std::string& id, check::Severity severity, const std::string& where = "") const {
    const check::CheckReport r = report();
    const check::CheckFinding* f = find(r, id, where);
    ASSERT_NE(f, nullptr) << id << " is missing; found:\n" << complaints(r);
    EXPECT_EQ(f->severity, severity) << f->what;
    EXPECT_FALSE(f->remedy.empty()) << id;
  }
  void expect_only(const std::string& id, check::Severity severity, const std::string& where = "") const {
    expect(id, severity, where);
    for (const check::CheckFinding& f : report().findings) {
      if (f.severity == check::Severity::kInformation) continue;
      EXPECT_EQ(f.id, id) << f.where << ": " << f.what;
    }
  }

  void move_away(std::size_t body) {
    for (auto& pose : recording.bodies[body]) pose.p_mocap.x() += 12.0;
  }

  arm::Arm arm = hanging_arm();
  trial::CheckRecording recording = clean();
};

TEST_F(Check, LeavesACleanRecordingInPeace) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    recording = clean(seed);
    EXPECT_EQ(complaints(report()), "") << "seed " << seed;
  }
}

TEST_F(Check, NothingAtAllIsSaidNotCrashed) {
  recording.bodies.assign(4, {});
  recording.inputs.assign(2, {});
  recording.payload.clear();
  recording.frames.clear();
  for (trial::RecordedTopic& t : recording.topics) t.found_type.clear();
  EXPECT_EQ(report().worst(), check::Severity::kSerious);
}

TEST_F(Check, MissingTopicIsNamedWithTheNearestOne) {
  recording.topics[2].found_type.clear();
  recording.bodies[2].clear();
  recording.other_topics["/mocap/ring2/pose"] = "geometry_msgs/PoseStamped";
  expect("missing_topic", check::Severity::kWarning, "/mocap/ring_2/pose");
  EXPECT_EQ(find(report(), "missing_topic")->setting, "bodies[ring_2].name: ring2");
}

TEST_F(Check, WhatTheArmFileDoesNotNameIsSaid) {
  recording.topics.push_back({"/pressure/chamber_1", "sensor_msgs/FluidPressure", "chamber_1",
                              "sensor_msgs/FluidPressure", 2000, false, false, false});
  recording.other_topics = {{"/mocap/ring_4/pose", "geometry_msgs/PoseStamped"},
                            {"/pressure/chamber_3", "sensor_msgs/FluidPressure"},
                            {"/another_arm/tip", "geometry_msgs/PoseStamped"},
                            {"/rosout_agg", "rosgraph_msgs/Log"}};
  expect("unused_topic", check::Severity::kInformation, "/mocap/ring_4/pose");
  const check::CheckReport of_all = report();
  std::vector<std::string> where;
  for (const check::CheckFinding& finding : of_all.findings)
    if (finding.id == "unused_topic") where.push_back(finding.where);
  EXPECT_EQ(where, (std::vector<std::string>{"/pressure/chamber_3", "/mocap/ring_4/pose"}));
  EXPECT_EQ(of_all.worst(), check::Severity::kWarning);
}

TEST_F(Check, MissingBaseAndWrongTypeAreSerious) {
  recording.topics[0].found_type = "geometry_msgs/TransformStamped";
  recording.bodies[0].clear();
  expect("wrong_type", check::Severity::kSerious, "/mocap/base/pose");
}

TEST_F(Check, PayloadOfAWrongTypeIsSeriousWhereItIsNeeded) {
  recording.topics[4].found_type = "std_msgs/Float32";
  recording.payload.clear();
  for (trial::Frame& frame : recording.frames) frame.payload_kg.reset();
  expect_only("wrong_type", check::Severity::kSerious, "/payload");
  EXPECT_THAT(find(report(), "wrong_type")->remedy, HasSubstr("std_msgs/Float64"));
  EXPECT_EQ(find(report(), "payload_unknown"), nullptr);  // said once
  arm.estimator.unknown = arm::Unknown::kPayload;
  expect_only("wrong_type", check::Severity::kWarning, "/payload");
}

TEST_F(Check, ATypeThatWasDefinedOtherwiseIsNotATopicWithoutMessages) {
  const auto redefine = [&](std::size_t topic) {
    recording.topics[topic].unread = std::exchange(recording.topics[topic].messages, 0);
    recording.topics[topic].unread_md5 = "0123456789abcdef0123456789abcdef";
  };
  redefine(2);
  recording.bodies[2].clear();
  expect("other_definition", check::Severity::kWarning, "/mocap/ring_2/pose");
  const check::CheckReport of_ring = report();
  const check::CheckFinding& finding = *find(of_ring, "other_definition");
  EXPECT_EQ(finding.what,
            "is geometry_msgs/PoseStamped by another definition (MD5 0123456789abcdef0123456789abcdef) than "
            "the one known here, and not read (ring_2)");
  EXPECT_THAT(finding.remedy, HasSubstr("rosbag fix"));
  EXPECT_EQ(finding.setting, "");
  EXPECT_EQ(find(of_ring, "empty_topic"), nullptr);

  recording = clean();
  redefine(0);
  recording.bodies[0].clear();
  expect("other_definition", check::Severity::kSerious, "/mocap/base/pose");

  recording = clean();
  recording.topics[1].messages = 1500;
  recording.topics[1].unread = 500;
  expect_only("other_definition", check::Severity::kWarning, "/mocap/ring_1/pose");
  const check::CheckReport of_some = report();
  EXPECT_THAT(find(of_some, "other_definition")->what, HasSubstr("in 500 of 2000 messages"));
  EXPECT_DOUBLE_EQ(*find(of_some, "other_definition")->figure, 0.25);
}

TEST_F(Check, APayloadThatWasDefinedOtherwiseIsSeriousWhereItIsNeeded) {
  recording.topics[4].unread = std::exchange(recording.topics[4].messages, 0);
  recording.payload.clear();
  for (trial::Frame& frame : recording.frames) frame.payload_kg.reset();
  expect_only("other_definition", check::Severity::kSerious, "/payload");
  EXPECT_EQ(find(report(), "payload_unknown"), nullptr);  // said once
  EXPECT_THAT(find(report(), "other_definition")->remedy, HasSubstr("--payload KG"));
  arm.estimator.unknown = arm::Unknown::kPayload;
  expect_only("other_definition", check::Severity::kWarning, "/payload");
}

TEST_F(Check, MessagesThatCannotBeReadAreSaidWithTheirTimes) {
  recording.topics[1].messages = 1998;
  recording.topics[1].undecodable_s = {kStart + 3.0, kStart + 12.3};
  expect_only("undecodable", check::Severity::kWarning, "/mocap/ring_1/pose");
  const check::CheckReport of_some = report();
  const check::CheckFinding& finding = *find(of_some, "undecodable");
  EXPECT_THAT(finding.what, HasSubstr("2 of 2000 messages cannot be read"));
  EXPECT_DOUBLE_EQ(*finding.figure, 1e-3);
  ASSERT_EQ(finding.spans.size(), 2u);
  EXPECT_NEAR(finding.spans[1].from_s, 12.3, 0.1);

  recording = clean();
  recording.topics[2].messages = 0;
  recording.topics[2].undecodable_s.assign(2000, kStart);
  recording.bodies[2].clear();
  expect("undecodable", check::Severity::kSerious, "/mocap/ring_2/pose");
  EXPECT_EQ(find(report(), "empty_topic"), nullptr);

  recording = clean();
  recording.topics[4].messages = 0;
  recording.topics[4].undecodable_s = {kStart};
  recording.payload.clear();
  for (trial::Frame& frame : recording.frames) frame.payload_kg.reset();
  expect_only("undecodable", check::Severity::kSerious, "/payload");
  EXPECT_EQ(find(report(), "payload_unknown"), nullptr);  // said once
  EXPECT_THAT(find(report(), "undecodable")->remedy, HasSubstr("--payload KG"));
}

TEST_F(Check, ZeroStampsDuplicatesAndGaps) {
  for (int k = 0; k < 100; ++k) recording.bodies[1][at(3) + k].stamp_s = 0.0;
  expect("zero_stamps", check::Severity::kSerious, "ring_1");
  recording = clean();
  for (int k = 0; k < 30; ++k)
    recording.bodies[1][at(3) + 2 * k].stamp_s = recording.bodies[1][at(3) + 2 * k - 1].stamp_s;
  expect("duplicates", check::Severity::kWarning, "ring_1");
  recording = clean();
  for (auto& body : recording.bodies) body.erase(body.begin() + at(5), body.begin() + at(5.8));
  expect("gap", check::Severity::kWarning, "mocap");
  EXPECT_NEAR(*find(report(), "gap")->figure, 0.8, 0.02);
}

TEST_F(Check, StepOfTheClock) {
  for (auto& body : recording.bodies) {
    for (std::size_t k = at(12); k < body.size(); ++k) body[k].stamp_s -= 30.0;
  }
  expect("time_jump", check::Severity::kSerious);
  EXPECT_NEAR(*find(report(), "time_jump")->figure, -30.0, 0.02);
}

TEST_F(Check, IrregularStamps) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-0.003, 0.003);
  for (std::size_t k = 0; k < recording.bodies[0].size(); ++k) {
    const double d = jitter(random);
    for (auto& body : recording.bodies) body[k].stamp_s += d;
  }
  expect("irregular_stamps", check::Severity::kWarning, "ring_2");
}

TEST_F(Check, BodiesOfOneFrameStampedApart) {
  for (auto& pose : recording.bodies[3]) pose.stamp_s += 0.0035;
  expect("split_frames", check::Severity::kSerious);
}

TEST_F(Check, StampsAheadOfReceiptAndDrift) {
  for (auto& body : recording.bodies) {
    for (auto& pose : body) pose.stamp_s += 0.02 + 2e-4 * (pose.stamp_s - kStart);
  }
  expect("stamps_ahead", check::Severity::kWarning, "mocap");
  const check::CheckReport r = report();
  ASSERT_NE(find(r, "clock_drift"), nullptr);
  EXPECT_NEAR(*find(r, "clock_drift")->figure, 2e-4, 3e-5);
}

TEST_F(Check, FrozenBody) {
  for (std::size_t k = at(6); k < at(8.5); ++k) {
    recording.bodies[2][k].p_mocap = recording.bodies[2][at(6)].p_mocap;
    recording.bodies[2][k].q_mocap = recording.bodies[2][at(6)].q_mocap;
  }
  expect("frozen_body", check::Severity::kSerious, "ring_2");
  EXPECT_NEAR(*find(report(), "frozen_body")->figure, 2.5, 0.05);
}

TEST_F(Check, LostBody) {
  recording.bodies[3].erase(recording.bodies[3].begin() + at(6), recording.bodies[3].begin() + at(7));
  expect_only("lost_body", check::Severity::kWarning, "ring_3");
}

TEST_F(Check, ExchangedForAWhileAndThroughout) {
  for (std::size_t k = at(6); k < at(9); ++k) {
    std::swap(recording.bodies[1][k].p_mocap, recording.bodies[3][k].p_mocap);
    std::swap(recording.bodies[1][k].q_mocap, recording.bodies[3][k].q_mocap);
  }
  expect("exchanged_bodies", check::Severity::kSerious, "ring_1, ring_3");
  const check::CheckReport r = report();
  const auto& spans = find(r, "exchanged_bodies")->spans;
  ASSERT_EQ(spans.size(), 1u);
  EXPECT_NEAR(spans[0].from_s, 6.0, 0.03);
  EXPECT_NEAR(spans[0].to_s, 9.0, 0.03);

  recording = clean();
  std::swap(recording.bodies[1], recording.bodies[2]);
  expect("body_order", check::Severity::kSerious);
}

TEST_F(Check, JumpsAndQuaternionSpikes) {
  for (int k = 0; k < 10; ++k) recording.bodies[2][at(3) + 80 * k].p_mocap.x() += 0.012;
  expect("jumping_body", check::Severity::kWarning, "ring_2");
  EXPECT_EQ(find(report(), "jumping_body")->spans.size(), 10u);
  recording = clean();
  for (int k = 0; k < 30; ++k) {
    auto& q = recording.bodies[0][at(2) + 50 * k].q_mocap;
    *q = *q * Eigen::AngleAxisd(0.9, Eigen::Vector3d::UnitX());
  }
  expect("quaternion_spikes", check::Severity::kSerious, "base");
}

TEST_F(Check, TurnedOverForAWhile) {
  for (std::size_t k = at(6); k < at(8); ++k) {
    auto& q = recording.bodies[3][k].q_mocap;
    *q = *q * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
  }
  expect("turned_over", check::Severity::kSerious, "ring_3");
  const check::CheckReport r = report();
  EXPECT_THAT(find(r, "turned_over")->what, HasSubstr("x axis"));
  EXPECT_NEAR(find(r, "turned_over")->spans.front().from_s, 6.0, 0.03);
  EXPECT_NEAR(find(r, "turned_over")->spans.front().to_s, 8.0, 0.03);
}

TEST_F(Check, PosesThatAreNoneAreSeriousWhereTheyAreMany) {
  const auto lose = [&](std::size_t every) {
    for (std::size_t i = 0; i < recording.bodies[2].size(); i += every)
      recording.bodies[2][i].p_mocap.setConstant(std::numeric_limits<double>::quiet_NaN());
  };
  lose(50);
  expect("no_pose", check::Severity::kInformation, "ring_2");
  lose(8);
  expect("no_pose", check::Severity::kWarning, "ring_2");
  lose(2);
  expect("no_pose", check::Severity::kSerious, "ring_2");
}

TEST_F(Check, SignOfAQuaternionIsHarmless) {
  for (std::size_t k = 0; k < recording.bodies[3].size(); k += 3)
    recording.bodies[3][k].q_mocap->coeffs() *= -1.0;
  EXPECT_EQ(complaints(report()), "");
  EXPECT_NE(find(report(), "quaternion_sign", "ring_3"), nullptr);
}

TEST_F(Check, TangentBackwardsAndTurnedAboutIt) {
  for (auto& pose : recording.bodies[3])
    *pose.q_mocap = *pose.q_mocap * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY());
  expect("tangent_backwards", check::Severity::kSerious, "ring_3");
  recording = clean();
  for (auto& pose : recording.bodies[3])
    *pose.q_mocap = *pose.q_mocap * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ());
  expect("turned_about_tangent", check::Severity::kWarning, "ring_3");
}

TEST_F(Check, BaseUpsideDown) {
  for (auto& pose : recording.bodies[0])
    *pose.q_mocap = *pose.q_mocap * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY());
  expect("base_upside_down", check::Severity::kSerious, "base");
}

TEST_F(Check, BaseIsBumped) {
  for (std::size_t k = at(9); k < recording.bodies[0].size(); ++k) {
    for (auto& body : recording.bodies) body[k].p_mocap += Eigen::Vector3d(0.002, 0.0, 0.001);
  }
  expect("base_bumped", check::Severity::kWarning, "base");
  EXPECT_NEAR(find(report(), "base_bumped")->spans.front().from_s, 9.0, 0.6);
}

TEST_F(Check, MillimetresAsMetres) {
  for (auto& body : recording.bodies) {
    for (auto& pose : body) pose.p_mocap *= 1000.0;
  }
  expect("length_unit", check::Severity::kSerious);
  EXPECT_EQ(find(report(), "length_unit")->setting, "inputs.bodies.unit: mm");
}

TEST_F(Check, OneBodyThatIsFarAwayIsNoUnit) {
  move_away(2);
  expect("body_far_away", check::Severity::kSerious, "ring_2");
  const check::CheckReport r = report();
  EXPECT_EQ(find(r, "length_unit"), nullptr) << to_text(r);
  EXPECT_EQ(find(r, "body_far_away", "ring_1"), nullptr);
  EXPECT_EQ(find(r, "body_far_away", "ring_3"), nullptr);
  const check::CheckFinding* f = find(r, "body_far_away");
  EXPECT_EQ(f->setting, "");
  EXPECT_THAT(f->what, HasSubstr("12 m from the base"));
  EXPECT_NEAR(*f->figure, 12.0, 0.1);
}

TEST_F(Check, WhereAllAreFurtherThanTheArmFileSaysNoneIsFarAway) {
  for (auto& body : recording.bodies) {
    for (auto& pose : body) pose.p_mocap *= 2.2;  // beyond the arm's reach is ring_3 alone
  }
  expect("length_unit", check::Severity::kSerious);
  EXPECT_EQ(find(report(), "body_far_away"), nullptr);
}

TEST_F(Check, OrderAndAttitudesAreThoseOfTheBodiesThatAreNotFarAway) {
  for (auto& pose : recording.bodies[0])
    *pose.q_mocap = *pose.q_mocap * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY());
  move_away(2);
  expect("base_upside_down", check::Severity::kSerious, "base");
  recording = clean();
  for (auto& pose : recording.bodies[3])
    *pose.q_mocap = *pose.q_mocap * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY());
  move_away(2);
  expect("tangent_backwards", check::Severity::kSerious, "ring_3");
  recording = clean();
  std::swap(recording.bodies[1], recording.bodies[3]);
  move_away(2);
  expect("body_order", check::Severity::kSerious);
  expect("body_far_away", check::Severity::kSerious, "ring_2");
  EXPECT_THAT(find(report(), "body_order")->what, testing::Not(HasSubstr("ring_2")));
}

TEST_F(Check, SpacingIsThatOfTheBodiesThatAreNotFarAway) {
  move_away(3);
  EXPECT_EQ(find(report(), "stretched"), nullptr);
  for (auto& body : arm.bodies) body.arclength_m *= 0.95;
  expect("stretched", check::Severity::kWarning);
  EXPECT_NEAR(*find(report(), "stretched")->figure, 1.0 / 0.95 - 1.0, 0.003);
}

TEST_F(Check, AnImportedUnitIsTheLayouts) {
  struct Unit {
    std::string layout, right;
    double times;
    std::string setting;
  };
  for (const Unit& unit :
       {Unit{"mm", "m", 1e-3, "mocap.unit: m (of the layout)"},
        Unit{"cm", "m", 1e-2, "mocap.unit: m (of the layout)"},
        Unit{"mm", "cm", 0.1, "mocap.unit: cm (of the layout)"},
        Unit{"cm", "mm", 10.0, "mocap.unit: mm (of the layout)"},
        Unit{"m", "cm", 100.0, "mocap.unit: cm (of the layout)"},
        Unit{"m", "mm", 1000.0, "mocap.unit: mm (of the layout)"}, Unit{"mm", "inch", 1.0 / 25.4, ""}}) {
    SCOPED_TRACE(unit.right + " as " + unit.layout);
    recording = clean();
    recording.import_layout = "time: {column: 1, unit: s}\nmocap:\n  unit: " + unit.layout +
                              "\n  up: z\n  bodies: [{name: base, position: [2, 3, 4]}]\n";
    for (auto& body : recording.bodies) {
      for (auto& pose : body) pose.p_mocap *= unit.times;
    }
    const check::CheckReport r = report();
    const check::CheckFinding* f = find(r, "length_unit");
    ASSERT_NE(f, nullptr) << to_text(r);
    EXPECT_EQ(f->setting, unit.setting) << f->what;
    EXPECT_THAT(f->what, HasSubstr("were in " + unit.right));
  }
  // What the import wrote are metres, whatever the arm file takes them for.
  recording = clean();
  recording.import_layout =
      "time: {column: 1, unit: s}\nmocap: {unit: mm, up: z, bodies: [{name: base, "
      "position: [2, 3, 4]}]}\n";
  for (auto& body : recording.bodies) {
    for (auto& pose : body) pose.p_mocap *= 1e-3;
  }
  arm.inputs.bodies.scale_to_m = 1e-3;
  EXPECT_EQ(find(report(), "length_unit")->setting, "inputs.bodies.unit: m");
}

TEST_F(Check, RingElsewhereAndStretchedArm) {
  arm.bodies[1].arclength_m += 0.004;
  expect("ring_misplaced", check::Severity::kWarning, "ring_2");
  EXPECT_NEAR(*find(report(), "ring_misplaced")->figure, -0.004, 4e-4);
  arm = hanging_arm();
  arm.segments[0].length_m *= 0.95;
  arm.payload.arclength_m *= 0.95;
  for (auto& body : arm.bodies) body.arclength_m *= 0.95;
  expect("stretched", check::Severity::kWarning);
  EXPECT_NEAR(*find(report(), "stretched")->figure, 1.0 / 0.95 - 1.0, 0.003);
}

TEST_F(Check, AnArmThatItsWeightStretchesAsItsFileSaysIsNotTooLong) {
  // 2 % by half a kilogram, and the arm's own 10 g.
  arm.segments[0].axial_stiffness_n = (0.5 + 0.5 * 0.02) * 9.80665 / 0.02;
  recording.payload[0].value = 0.5;
  arm.segments[0].length_m /= 1.02;
  arm.payload.arclength_m /= 1.02;
  for (auto& body : arm.bodies) body.arclength_m /= 1.02;
  const check::CheckFinding* f = nullptr;
  const check::CheckReport with_weight = report();
  f = find(with_weight, "stretched");
  EXPECT_TRUE(!f || f->severity == check::Severity::kInformation) << to_text(with_weight);
  arm.segments[0].axial_stiffness_n.reset();
  expect("stretched", check::Severity::kWarning);
}

TEST_F(Check, PressureUnits) {
  const auto scale = [&](double factor, double offset) {
    recording = clean();
    for (auto& input : recording.inputs) {
      for (auto& v : input) v.value = (v.value - offset) * factor;
    }
  };
  scale(1e-3, 0.0);
  expect("pressure_unit", check::Severity::kSerious, "chamber_1");
  EXPECT_THAT(find(report(), "pressure_unit")->what, HasSubstr("kPa absolute"));
  scale(1.0, 101325.0);
  EXPECT_EQ(find(report(), "pressure_unit")->setting,
            "inputs.pressures[chamber_1].unit: Pa; inputs.pressures[chamber_1].reference: gauge");
  scale(1.0 / 6894.757, 101325.0);
  EXPECT_THAT(find(report(), "pressure_unit")->what, HasSubstr("psi gauge"));
}

TEST_F(Check, SensorsOffAtRest) {
  for (auto& v : recording.inputs[0]) v.value += 1000.0;
  for (auto& v : recording.inputs[1]) v.value -= 2000.0;
  expect("offset_at_rest", check::Severity::kWarning, "chamber_1");
  expect("offset_at_rest", check::Severity::kWarning, "chamber_2");
  EXPECT_NEAR(*find(report(), "offset_at_rest", "chamber_1")->figure, 1000.0, 1.0);
  EXPECT_THAT(find(report(), "offset_at_rest", "chamber_2")->what, HasSubstr("below ambient"));
}

TEST_F(Check, StuckCoarseNoisyAndStillInputs) {
  for (std::size_t k = at(5) / 2; k < at(6.5) / 2; ++k)
    recording.inputs[0][k].value = recording.inputs[0][at(5) / 2].value;
  expect("stuck_input", check::Severity::kWarning, "chamber_1");
  EXPECT_NEAR(*find(report(), "stuck_input")->figure, 1.5, 0.05);
  recording = clean();
  for (auto& v : recording.inputs[0]) v.value = 101325.0 + 640.0 * std::round((v.value - 101325.0) / 640.0);
  expect("coarse_steps", check::Severity::kWarning, "chamber_1");
  EXPECT_NEAR(*find(report(), "coarse_steps")->figure, 640.0, 1.0);
  recording = clean();
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 500.0);
  for (auto& v : recording.inputs[0]) v.value += noise(random);
  expect("noisy_input", check::Severity::kWarning, "chamber_1");
  EXPECT_NEAR(*find(report(), "noisy_input")->figure, 500.0, 60.0);
  recording = clean();
  for (auto& v : recording.inputs[1]) v.value = 101325.0;
  EXPECT_NE(find(report(), "never_driven", "chamber_2"), nullptr);
}

TEST_F(Check, StepsOfSeveralInputsAreOneFinding) {
  const double steps_pa[] = {640.0, 700.0};
  for (std::size_t i = 0; i < 2; ++i) {
    for (auto& v : recording.inputs[i])
      v.value = 101325.0 + steps_pa[i] * std::round((v.value - 101325.0) / steps_pa[i]);
  }
  const check::CheckReport r = report();
  EXPECT_EQ(std::count_if(r.findings.begin(), r.findings.end(),
                          [](const check::CheckFinding& f) { return f.id == "coarse_steps"; }),
            1)
      << to_text(r);
  const check::CheckFinding* f = find(r, "coarse_steps");
  ASSERT_NE(f, nullptr);
  EXPECT_EQ(f->where, "chamber_1, chamber_2");
  EXPECT_THAT(f->what, HasSubstr("move in steps of 640 to 700 Pa ("));
}

TEST_F(Check, TrialThatDoesNotRest) {
  const auto cut = [](auto& samples) {
    using Sample = typename std::decay_t<decltype(samples)>::value_type;
    samples.erase(
        std::remove_if(samples.begin(), samples.end(),
                       [](const Sample& s) { return s.stamp_s < kStart + 4.0 || s.stamp_s > kStart + 15.0; }),
        samples.end());
  };
  for (auto& body : recording.bodies) cut(body);
  for (auto& input : recording.inputs) cut(input);
  expect("no_rest_at_start", check::Severity::kWarning);
  expect("no_rest_at_end", check::Severity::kWarning);
}

TEST_F(Check, NoiseBeyondTheArmFiles) {
  for (auto& body : arm.bodies) body.position_sd_m = 0.5 * kNoiseM;
  expect("noise_understated", check::Severity::kWarning);
  EXPECT_NEAR(*find(report(), "noise_understated")->figure, kNoiseM, 0.2 * kNoiseM);
}

TEST_F(Check, ClocksAgainstEachOtherWithTheirInterval) {
  for (const double lag_s : {-0.12, 0.0, 0.03, 0.2}) {
    recording = clean(7, lag_s);
    const check::CheckReport r = report();
    const check::CheckFinding* f = find(r, "clock_offset_or_lag");
    ASSERT_NE(f, nullptr) << lag_s << "\n" << to_text(r);
    EXPECT_NEAR(*f->figure, lag_s, 0.004);
    EXPECT_LT(*f->figure_sd, 0.01);
    EXPECT_EQ(f->severity != check::Severity::kInformation, lag_s < -0.03 || lag_s > 0.09) << f->what;
  }
  recording = clean(7, 0.2);
  arm.inputs.body_latency_s = 0.2;  // what it proposes repairs it
  EXPECT_EQ(complaints(report()), "");
}

TEST_F(Check, ClocksCannotBeToldWithoutMotion) {
  for (auto& input : recording.inputs) {
    for (auto& v : input) v.value = 101325.0;
  }
  EXPECT_NE(find(report(), "clock_cannot_tell"), nullptr);
}

TEST_F(Check, PayloadInGrams) {
  recording.payload.push_back({kStart + 5.0, kStart + 5.0, 200.0});
  expect("payload_range", check::Severity::kSerious, "/payload");
  recording.payload.clear();
  EXPECT_NE(find(report(), "payload_unknown"), nullptr);
}

TEST_F(Check, SaysItInWordsAndInJson) {
  std::swap(recording.bodies[1], recording.bodies[2]);
  const check::CheckReport r = report();
  EXPECT_THAT(to_text(r), HasSubstr("remedy: "));
  EXPECT_THAT(to_text(r, false), ::testing::Not(HasSubstr("information")));
  const std::string json = check::to_json({r}, arm.name);
  EXPECT_THAT(json, HasSubstr("\"body_order\""));
  EXPECT_THAT(json, ::testing::Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace softarm
