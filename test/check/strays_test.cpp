// Single messages of another time, as damaged recordings and clocks that were not set have them: named, and
// no check takes longer or finds anything else for them.
#include <gmock/gmock.h>

#include "check_fixture.h"

namespace softarm::testing_check {
namespace {

using ::testing::HasSubstr;

/// Beside the one sample that is not there.
std::vector<std::string> others(const check::CheckReport& report) {
  std::vector<std::string> ids;
  for (const check::CheckFinding& f : report.findings)
    if (f.id != "stray_times" && f.id != "lost_body") ids.push_back(f.id + " " + f.where);
  return ids;
}

struct Damage {
  const char* name;
  const char* where;
  const char* says;
  void (*spoil)(trial::CheckRecording&);
};

class Strays : public ::testing::TestWithParam<Damage> {};

TEST_P(Strays, AreNamedAndLeftOut) {
  const arm::Arm arm = hanging_arm();
  trial::CheckRecording recording = clean();
  const check::CheckReport before = check::check_recording(recording, arm);
  GetParam().spoil(recording);
  const check::CheckReport report = check::check_recording(recording, arm);
  const auto found = std::find_if(report.findings.begin(), report.findings.end(),
                                  [](const check::CheckFinding& f) { return f.id == "stray_times"; });
  ASSERT_NE(found, report.findings.end());
  EXPECT_EQ(found->where, GetParam().where);
  EXPECT_THAT(found->what, HasSubstr(GetParam().says));
  EXPECT_EQ(others(report), others(before));
  EXPECT_NEAR(report.duration_s, before.duration_s, 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    EachKind, Strays,
    ::testing::Values(Damage{"stamp_of_1970", "ring_2", "1 message is stamped 1.39 hours before",
                             [](trial::CheckRecording& r) {
                               // The fixture's clock shows some 1000 s: what is left of an hour back is below
                               // 0.
                               for (auto& body : r.bodies)
                                 for (auto& pose : body) pose.stamp_s += 4000.0, pose.receipt_s += 4000.0;
                               for (auto& input : r.inputs)
                                 for (auto& v : input) v.stamp_s += 4000.0, v.receipt_s += 4000.0;
                               for (auto& v : r.payload) v.stamp_s += 4000.0, v.receipt_s += 4000.0;
                               r.bodies[2][700].stamp_s = 1.0;
                             }},
                      Damage{"stamp_beyond_2038", "ring_3", "1 message is stamped 4.97e+04 days after",
                             [](trial::CheckRecording& r) { r.bodies[3][700].stamp_s = 4294967295.0; }},
                      Damage{"recorded_in_2106", "chamber_1", "2 messages are recorded",
                             [](trial::CheckRecording& r) {
                               r.inputs[0][300].receipt_s = 4294967295.0;
                               r.inputs[0][301].receipt_s = 4294967295.0;
                             }}),
    [](const auto& of) { return std::string(of.param.name); });

TEST(StrayStretches, OfTwoThatAreYearsApartTheLongerIsLookedAt) {
  const arm::Arm arm = hanging_arm();
  trial::CheckRecording recording = clean();
  auto& ring = recording.bodies[1];
  for (std::size_t i = 0; i < 50; ++i) ring[i].receipt_s = ring[i].stamp_s = 4e9 + ring[i].stamp_s;
  const check::CheckReport report = check::check_recording(recording, arm);
  EXPECT_LT(report.duration_s, 30.0);
  EXPECT_TRUE(std::any_of(report.findings.begin(), report.findings.end(), [](const check::CheckFinding& f) {
    return f.id == "stray_times" && f.what.rfind("50 messages", 0) == 0;
  }));
}

}  // namespace
}  // namespace softarm::testing_check
