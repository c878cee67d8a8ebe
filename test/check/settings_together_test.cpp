// Settings of several findings at once: none undoes another.
#include "check/settings.h"
#include "spoilt_recordings.h"

namespace softarm {
namespace {

using namespace testing_check;

/// Whether the one is the other's key, or a map around it.
bool around(const Step& a, const Step& b) {
  return a.of_layout == b.of_layout && b.path.compare(0, a.path.size(), a.path) == 0 &&
         (b.path.size() == a.path.size() || b.path[a.path.size()] == '.' || b.path[a.path.size()] == '[');
}

/// No two settings of a report set one key to different values.
void expect_one_value_each(const check::CheckReport& report) {
  std::vector<Step> all;
  for (const check::CheckFinding& finding : report.findings) {
    const std::vector<Step> steps = steps_of(finding.setting);
    for (const Step& step : steps) {
      for (const Step& other : all) {
        if (around(step, other) || around(other, step)) {
          EXPECT_TRUE(step.path == other.path && step.value == other.value)
              << step.path << ": " << step.value << " against " << other.path << ": " << other.value << "\n"
              << to_text(report);
        }
      }
    }
    all.insert(all.end(), steps.begin(), steps.end());
  }
}

TEST(CheckSettings, TwoThatAreFollowedTogetherDoNotUndoOneAnother) {
  // One of each id that touches what others touch.
  std::vector<Spoilt> some;
  for (Spoilt& one : all_spoilt()) {
    static const std::set<std::string> kTouching{"missing_topic",       "gap",
                                                 "other_epoch",         "stamps_ahead",
                                                 "clock_offset_or_lag", "clocks_apart",
                                                 "body_order",          "quaternion_spikes",
                                                 "length_unit",         "base_upside_down",
                                                 "base_attitude",       "ring_misplaced",
                                                 "stretched",           "ring_wanders",
                                                 "noise_understated",   "correlated_noise"};
    const bool known = std::any_of(some.begin(), some.end(), [&](const Spoilt& s) {
      return s.id == one.id && s.id != "quaternion_spikes";
    });
    if (kTouching.count(one.id) && !known) some.push_back(std::move(one));
  }
  for (std::size_t i = 0; i < some.size(); ++i) {
    for (std::size_t j = i + 1; j < some.size(); ++j) {
      if (some[j].arm_file && some[i].arm_file) continue;  // they rewrite the same lines
      SCOPED_TRACE(some[i].id + " and " + some[j].id);
      std::string arm_text = kArm;
      for (const auto* one : {&some[i], &some[j]}) {
        if (one->arm_file) one->arm_file(arm_text);
      }
      const arm::Arm arm = arm::parse_arm(arm_text, "arm");
      trial::CheckRecording recording = clean();
      some[j].spoil(recording);
      some[i].spoil(recording);
      const check::CheckReport report = check::check_recording(recording, arm);
      expect_one_value_each(report);
      YAML::Node arm_file = YAML::Load(arm_text), layout = YAML::Load(kImportLayout);
      for (const check::CheckFinding& finding : report.findings) follow(finding, arm_file, layout);
      loaded(arm_file, layout, to_text(report), arm);
    }
  }
}

TEST(CheckSettings, OfFiguresThatAnotherFindingSpoilsNoneIsSet) {
  const auto finding = [](const char* id, const char* setting) {
    check::CheckFinding f;
    f.severity = check::Severity::kSerious;
    f.id = id;
    f.setting = setting;
    f.remedy = "repair it";
    return f;
  };
  std::vector<check::CheckFinding> findings{
      finding("gravity", "gravity_m_s2: [0.000, -9.810, 0.000]"),
      finding("base_attitude", "base.rod_in_body: {position_m: [0, 0, 0]}"),
      finding("tangent_off", "bodies[tip].orientation_usable: false"),
      finding("offset_at_rest", "inputs.pressures[c].zero: 3")};
  check::withhold_contradictions(findings);
  EXPECT_EQ(findings[0].setting, "");
  EXPECT_EQ(findings[0].remedy,
            "repair it; the setting depends on base_attitude: repair that first, then check again");
  EXPECT_NE(findings[1].setting, "");
  EXPECT_EQ(findings[2].setting, "");
  EXPECT_NE(findings[3].setting, "");

  findings = {finding("body_far_away", ""), finding("ring_misplaced", "bodies[tip].arclength_m: 0.1900"),
              finding("base_attitude", "base.rod_in_body: {position_m: [0, 0, 0]}")};
  check::withhold_contradictions(findings);
  EXPECT_EQ(findings[1].setting, "");
  EXPECT_NE(findings[2].setting, "");
}

TEST(CheckSettings, InputsThatAreHeldForDifferentTimesHaveOneSetting) {
  trial::CheckRecording recording = clean();
  drop(recording.inputs[0], 6.0, 7.5);
  drop(recording.inputs[1], 10.0, 11.0);
  const check::CheckReport report = check::check_recording(recording, arm::parse_arm(kArm, "arm"));
  const check::CheckFinding *one = find(report, "gap", "chamber_1"), *two = find(report, "gap", "chamber_2");
  ASSERT_TRUE(one && two && one != two) << to_text(report);
  EXPECT_FALSE(one->setting.empty());
  EXPECT_EQ(one->setting, two->setting);
  expect_one_value_each(report);
}

TEST(CheckSettings, WhatInputsAreAheadIsTakenOffOnce) {
  trial::CheckRecording recording = clean(7, 0.25);
  for (auto& input : recording.inputs) {
    for (auto& v : input) v.stamp_s += 0.05;
  }
  arm::Arm arm = arm::parse_arm(kArm, "arm");
  const check::CheckReport report = check::check_recording(recording, arm);
  const check::CheckFinding *ahead = find(report, "stamps_ahead", "chamber_1"),
                            *shift = find(report, "clock_offset_or_lag");
  ASSERT_TRUE(ahead && shift) << to_text(report);
  YAML::Node arm_file = YAML::Load(kArm), layout = YAML::Load(kImportLayout);
  follow(*ahead, arm_file, layout);
  follow(*shift, arm_file, layout);
  EXPECT_NEAR(arm_file["inputs"]["bodies"]["latency_s"].as<double>(), 0.25, 0.01) << to_text(report);
  const arm::Arm after = loaded(arm_file, layout, "both", arm);
  const check::CheckReport again = check::check_recording(recording, after);
  EXPECT_NEAR(*find(again, "clock_offset_or_lag")->figure, 0.0, 0.01) << to_text(again);
}

TEST(CheckSettings, AnotherBodysTopicIsNotTakenForOneThatIsMissing) {
  trial::CheckRecording recording = clean();
  auto& topic = *std::find_if(recording.topics.begin(), recording.topics.end(),
                              [](const trial::RecordedTopic& t) { return t.feeds == "ring_3"; });
  topic.topic = "/mocap/tip/pose";
  topic.found_type.clear();
  recording.bodies[3].clear();
  recording.other_topics["/mocap/base/pose"] = "geometry_msgs/PoseStamped";
  const arm::Arm arm = arm::parse_arm(kArm, "arm");
  const check::CheckReport report = check::check_recording(recording, arm);
  const check::CheckFinding* finding = find(report, "missing_topic");
  ASSERT_NE(finding, nullptr) << to_text(report);
  EXPECT_EQ(finding->setting, "") << to_text(report);
  recording.other_topics["/mocap/tp/pose"] = "geometry_msgs/PoseStamped";
  EXPECT_NE(find(check::check_recording(recording, arm), "missing_topic")->remedy.find("/mocap/tp/pose"),
            std::string::npos);
}

}  // namespace
}  // namespace softarm
