#include "diagnose/schedule.h"

#include <gtest/gtest.h>

#include <vector>

namespace softarm::diagnose {
namespace {

TEST(Schedule, TellsTheTimeThatIsLeftInTimesOfTheFirstPart) {
  double now_s = 100.0;
  std::vector<double> shares;
  Schedule schedule([&](double share, const std::string&) { shares.push_back(share); },
                    [&] { return now_s; });
  schedule.first_part(0.0, "");
  now_s += 1.0;
  schedule.first_part(0.05, "");
  now_s += 1.0;
  schedule.end_first_part();
  schedule.left(8.0, "");  // 2 of 2 + 16 s
  now_s += 8.0;
  schedule.left(5.0, "");  // 10 of 20
  now_s += 2.0;
  schedule.left(14.0, "");  // more than was thought: 12 of 40
  now_s += 8.0;
  schedule.left(5.0, "");  // 20 of 30
  schedule.end();
  const std::vector<double> expected{0.0, 0.05, 2.0 / 18.0, 0.5, 0.5, 2.0 / 3.0, 1.0};
  ASSERT_EQ(shares.size(), expected.size());
  for (std::size_t i = 0; i < shares.size(); ++i) EXPECT_DOUBLE_EQ(shares[i], expected[i]) << i;
}

TEST(Schedule, MeasuresTheFirstPartThatWasMadeLast) {
  double now_s = 0.0, told = -1.0;
  Schedule schedule([&](double share, const std::string&) { told = share; }, [&] { return now_s; });
  for (int i = 0; i < 3; ++i) {
    schedule.begin_first_part("");
    now_s += 2.0;
  }
  schedule.end_first_part();
  schedule.left(3.0, "");
  EXPECT_DOUBLE_EQ(told, 2.0 / 8.0);
}

TEST(Schedule, GoesOnWithinAPartOfAll) {
  double now_s = 0.0;
  std::vector<double> shares;
  Schedule schedule([&](double share, const std::string&) { shares.push_back(share); },
                    [&] { return now_s; });
  const auto half_done = [&] {
    schedule.begin_first_part("");
    now_s += 2.0;
    schedule.end_first_part();
    schedule.left(1.0, "");
  };
  schedule.within(0.0, 0.6);
  half_done();
  schedule.within(0.6, 0.8);
  half_done();
  schedule.within(0.8, 1.0);
  half_done();
  schedule.within(0.0, 0.5);  // never back
  half_done();
  schedule.end();
  const std::vector<double> expected{0.0, 0.3, 0.6, 0.7, 0.8, 0.9, 0.9, 0.9, 1.0};
  ASSERT_EQ(shares.size(), expected.size());
  for (std::size_t i = 0; i < shares.size(); ++i) EXPECT_DOUBLE_EQ(shares[i], expected[i]) << i;
}

TEST(Schedule, NeedsNeitherAListenerNorTime) {
  Schedule({}, [] { return 0.0; }).left(1.0, "");
  double told = -1.0;
  Schedule at_once([&](double share, const std::string&) { told = share; }, [] { return 0.0; });
  at_once.end_first_part();
  at_once.left(3.0, "");
  EXPECT_EQ(told, 0.0);
}

}  // namespace
}  // namespace softarm::diagnose
