// Every setting that a finding can propose, followed to the letter: the arm file or the layout takes it.
#include <filesystem>
#include <fstream>
#include <map>

#include "spoilt_recordings.h"

namespace softarm {
namespace {

using namespace testing_check;

TEST(CheckSettings, EverySettingFollowedToTheLetterIsTakenAndRepairsWhatItCan) {
  std::set<std::string> with_setting;
  std::size_t number = 0;
  for (const Spoilt& spoilt : all_spoilt()) {
    for (const bool imported : {false, true}) {
      if (imported && settings_by_layout().count(spoilt.id) == 0) continue;
      SCOPED_TRACE(spoilt.id + ", case " + std::to_string(number++) + (imported ? ", imported" : ""));
      std::string arm_text = kArm;
      if (spoilt.arm_file) spoilt.arm_file(arm_text);
      const arm::Arm arm = arm::parse_arm(arm_text, "arm");
      trial::CheckRecording recording = clean();
      spoilt.spoil(recording);
      if (imported) recording.import_layout = kImportLayout;
      const check::CheckReport report = check::check_recording(recording, arm);
      const check::CheckFinding* expected = find(report, spoilt.id);
      ASSERT_NE(expected, nullptr) << to_text(report);
      for (const check::CheckFinding& finding : report.findings) {
        if (finding.setting.empty()) continue;
        with_setting.insert(finding.id);
        arm::Arm after = arm;
        follow(finding, arm_text, &after);
        const bool of_layout = finding.setting.find("(of the layout)") != std::string::npos;
        if (finding.id != spoilt.id || !spoilt.repairs || of_layout) continue;
        recording.import_layout.clear();
        const check::CheckReport again = check::check_recording(recording, after);
        const check::CheckFinding* left = find(again, finding.id, finding.where);
        EXPECT_TRUE(!left || left->severity == check::Severity::kInformation) << finding.setting << "\n"
                                                                              << left->what;
      }
    }
  }
  // Gravity wants an arm that sags: its setting is followed in test/apps/check_test.cpp. All others are here.
  with_setting.insert("gravity");
  const std::set<std::string> expected{"angle_unit",
                                       "base_attitude",
                                       "base_upside_down",
                                       "body_order",
                                       "clock_offset_or_lag",
                                       "clocks_apart",
                                       "correlated_noise",
                                       "gap",
                                       "gravity",
                                       "length_unit",
                                       "missing_topic",
                                       "no_orientation",
                                       "noise_understated",
                                       "offset_at_rest",
                                       "other_epoch",
                                       "payload_range",
                                       "payload_unknown",
                                       "pressure_unit",
                                       "quaternion_spikes",
                                       "repeated_poses",
                                       "ring_misplaced",
                                       "ring_wanders",
                                       "split_frames",
                                       "stamps_ahead",
                                       "stretched",
                                       "tangent_backwards",
                                       "tangent_off",
                                       "tension_unit",
                                       "turned_about_tangent",
                                       "turned_over",
                                       "wrong_type"};
  EXPECT_EQ(with_setting, expected);
}

/// A new setting wants a case in spoilt_recordings.h.
TEST(CheckSettings, EverySourceWithASettingIsAmongThoseThatAreFollowed) {
  std::map<std::string, int> found;
  static const std::regex kSets(R"((\.setting|->setting)\s*\+?=[^=])");
  for (const auto& file : std::filesystem::directory_iterator(SOFTARM_SOURCE_DIR "/src/check")) {
    std::ifstream in(file.path());
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    const auto count =
        std::distance(std::sregex_iterator(text.begin(), text.end(), kSets), std::sregex_iterator());
    if (count > 0) found[file.path().filename().string()] = static_cast<int>(count);
  }
  const std::map<std::string, int> followed{
      {"attitude.cpp", 3}, {"check.cpp", 1},        {"clocks.cpp", 2},      {"frozen.cpp", 1},
      {"gravity.cpp", 2},  {"input_levels.cpp", 1}, {"input_units.cpp", 3}, {"jumps.cpp", 2},
      {"noise.cpp", 2},    {"numbers.cpp", 1},      {"order.cpp", 1},       {"payload.cpp", 2},
      {"places.cpp", 2},   {"pooled.cpp", 2},       {"receipt.cpp", 2},     {"spacing.cpp", 2},
      {"timing.cpp", 2},   {"together.cpp", 2},     {"topics.cpp", 2},      {"turned_over.cpp", 2},
      {"units.cpp", 2}};
  EXPECT_EQ(found, followed);
}

}  // namespace
}  // namespace softarm
