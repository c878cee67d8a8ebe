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

constexpr double kTwelveYears = 12.0 * 365.25 * 86400.0;

template <typename Samples>
void move(Samples& samples, double stamps_by_s, double receipts_by_s) {
  for (auto& sample : samples) {
    sample.stamp_s += stamps_by_s;
    sample.receipt_s += receipts_by_s;
  }
}

/// Of the worst finding, and what it says.
struct Said {
  std::string id, where, severity;
};

/// Stamps, and times of record, that are years apart: serious where the programs, which go by the stamps,
/// find no bodies and inputs that belong together.
class YearsApart : public ::testing::Test {
 protected:
  Said said() const {
    const check::CheckReport report = check::check_recording(recording, arm);
    if (report.findings.empty()) return {};
    const check::CheckFinding& f = report.findings.front();
    return {f.id, f.where, to_string(f.severity)};
  }
  void move_bodies(double stamps_by_s, double receipts_by_s) {
    for (auto& body : recording.bodies) move(body, stamps_by_s, receipts_by_s);
  }
  void move_inputs(double stamps_by_s, double receipts_by_s) {
    for (auto& input : recording.inputs) move(input, stamps_by_s, receipts_by_s);
  }
  void expect_serious(const std::string& id, const std::string& where) const {
    const Said worst = said();
    EXPECT_EQ(worst.severity, "serious") << worst.id;
    EXPECT_EQ(worst.id, id);
    EXPECT_THAT(worst.where, HasSubstr(where));
  }

  arm::Arm arm = hanging_arm();
  trial::CheckRecording recording = clean();
};

TEST_F(YearsApart, BodiesStampedApartFromTheInputs) {
  move_bodies(kTwelveYears, 0.0);
  expect_serious("other_epoch", "mocap");
}

TEST_F(YearsApart, BodiesStampedAndRecordedApartFromTheInputs) {
  move_bodies(kTwelveYears, kTwelveYears);
  expect_serious("stray_times", "chamber_1");
  EXPECT_LT(check::check_recording(recording, arm).duration_s, 30.0);
}

TEST_F(YearsApart, OneBodyStampedApartFromTheOthers) {
  for (const std::size_t body : {0u, 2u}) {
    recording = clean();
    move(recording.bodies[body], kTwelveYears, 0.0);
    expect_serious("other_epoch", body == 0 ? "base" : "ring_2");
    const check::CheckReport report = check::check_recording(recording, arm);
    EXPECT_EQ(std::count_if(report.findings.begin(), report.findings.end(),
                            [](const auto& f) { return f.severity != check::Severity::kInformation; }),
              1)
        << complaints(report);
  }
}

TEST_F(YearsApart, HalfOfTheBodiesStampedApart) {
  for (auto& body : recording.bodies)
    for (std::size_t k = at(12); k < body.size(); ++k) body[k].stamp_s -= 900.0 + kTwelveYears;
  for (auto& body : recording.bodies) move(body, kTwelveYears, kTwelveYears);
  move_inputs(kTwelveYears, kTwelveYears);
  move(recording.payload, kTwelveYears, kTwelveYears);
  expect_serious("stray_times", "base");
}

TEST_F(YearsApart, PlayedBackWithAllOnOneClockIsNotSerious) {
  move_bodies(0.0, kTwelveYears);
  move_inputs(0.0, kTwelveYears);
  move(recording.payload, 0.0, kTwelveYears);
  const check::CheckReport report = check::check_recording(recording, arm);
  EXPECT_EQ(complaints(report), "");
  EXPECT_NE(find(report, "other_epoch", "mocap"), nullptr);
  arm.inputs.scalars[0].type = "std_msgs/Float64";  // without a header: as new as the last body
  const check::CheckReport headerless = check::check_recording(recording, arm);
  ASSERT_NE(find(headerless, "other_epoch"), nullptr);
  EXPECT_EQ(find(headerless, "other_epoch")->severity, check::Severity::kWarning);
}

TEST_F(YearsApart, PayloadOfAnotherClockThatAllFramesHaveIsMerelySaid) {
  move_bodies(0.0, -kTwelveYears);
  move_inputs(0.0, -kTwelveYears);
  recording.payload.push_back(recording.payload.front());
  recording.payload.back().receipt_s -= kTwelveYears;
  recording.payload.front().stamp_s -= kTwelveYears;
  recording.payload.front().receipt_s -= kTwelveYears;
  EXPECT_EQ(complaints(check::check_recording(recording, arm)), "");
}

TEST_F(YearsApart, RecordTimesAloneAreNotSerious) {
  move_inputs(0.0, -kTwelveYears);  // by a converter that knew none
  const check::CheckReport report = check::check_recording(recording, arm);
  EXPECT_EQ(report.worst(), check::Severity::kWarning) << complaints(report);
  for (trial::Frame& frame : recording.frames) frame.inputs.assign(2, std::nullopt);
  expect_serious("stray_times", "chamber_1");
}

TEST_F(YearsApart, PayloadThatIsSaidBeforeTheBodiesOfAnOlderClockIsUnknownToFrames) {
  move_bodies(0.0, kTwelveYears);
  move_inputs(0.0, kTwelveYears);
  move(recording.payload, kTwelveYears, kTwelveYears);
  for (std::size_t i = 0; i < 100; ++i) recording.frames[i].payload_kg.reset();  // of 200
  expect_serious("payload_unknown", "/payload");
  EXPECT_THAT(check::check_recording(recording, arm).findings.front().what, HasSubstr("50 % of the frames"));
  arm.payload.default_kg = 0.0;
  const check::CheckReport assumed = check::check_recording(recording, arm);
  EXPECT_EQ(assumed.worst(), check::Severity::kWarning);
  EXPECT_THAT(find(assumed, "payload_unknown")->what, HasSubstr("0 kg is assumed"));
  arm.payload.default_kg.reset();
  arm.estimator.unknown = arm::Unknown::kPayload;
  EXPECT_EQ(check::check_recording(recording, arm).worst(), check::Severity::kWarning);
}

TEST_F(YearsApart, ABodyWithoutStampsIsOfNoOtherClock) {
  move_bodies(0.0, kTwelveYears);
  move_inputs(0.0, kTwelveYears);
  move(recording.payload, 0.0, kTwelveYears);
  for (trial::RecordedPose& pose : recording.bodies[1]) pose.stamp_s = 0.0;
  const check::CheckReport report = check::check_recording(recording, arm);
  ASSERT_NE(find(report, "zero_stamps"), nullptr);
  ASSERT_NE(find(report, "other_epoch", "mocap"), nullptr);
  EXPECT_EQ(find(report, "other_epoch", "mocap")->severity, check::Severity::kInformation);
}

}  // namespace
}  // namespace softarm::testing_check
