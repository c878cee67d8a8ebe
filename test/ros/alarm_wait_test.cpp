// When a diagnosis begins after an alarm.
#include "ros/alarm_wait.h"

#include <gtest/gtest.h>

namespace softarm {
namespace {

/// A wait of 10 s, asked every tenth of a second by the machine's clock.
struct AlarmWaiter {
  AlarmWait wait{10.0};
  double time_s = 1000.0, steady_s = 50.0;

  void begin() { wait.begin(ros::Time(time_s), ros::SteadyTime(steady_s)); }
  /// @param rate of time, against the machine's clock
  /// @return seconds by the machine's clock until the wait was over; -1: it was not within a thousand
  double ends_after_s(double rate) {
    for (int i = 1; i <= 10000; ++i) {
      pass(0.1, rate);
      if (wait.over(ros::Time(time_s), ros::SteadyTime(steady_s))) return 0.1 * i;
    }
    return -1.0;
  }
  void pass(double seconds, double rate) {
    steady_s += seconds;
    time_s += rate * seconds;
  }
  bool over() { return wait.over(ros::Time(time_s), ros::SteadyTime(steady_s)); }
};

TEST(AlarmWait, IsAsLongAsWhatIsRecorded) {
  for (const double rate : {0.1, 1.0, 10.0}) {
    AlarmWaiter waiter;
    waiter.begin();
    EXPECT_TRUE(waiter.wait.waits());
    EXPECT_NEAR(waiter.ends_after_s(rate), 10.0 / rate, 0.25) << rate;
    EXPECT_FALSE(waiter.wait.waits());
    EXPECT_FALSE(waiter.over()) << "once";
  }
}

TEST(AlarmWait, EndsWhereTimeStandsStill) {
  AlarmWaiter waiter;
  waiter.begin();
  waiter.pass(4.0, 1.0);
  EXPECT_FALSE(waiter.over());
  EXPECT_NEAR(waiter.ends_after_s(0.0), 10.0, 0.25) << "from when it last went on";
}

TEST(AlarmWait, IsAnewWhereTimeGoesBack) {
  AlarmWaiter waiter;
  waiter.begin();
  waiter.pass(8.0, 1.0);
  EXPECT_FALSE(waiter.over());
  waiter.time_s = 900.0;
  EXPECT_FALSE(waiter.over());
  EXPECT_NEAR(waiter.ends_after_s(1.0), 10.0, 0.25);
}

TEST(AlarmWait, LivesWithAClockThatLeaps) {
  AlarmWaiter waiter;
  waiter.time_s = 0.0;
  waiter.begin();
  waiter.time_s = 4e9;
  EXPECT_TRUE(waiter.over());
}

TEST(AlarmWait, WithoutAnAlarmThereIsNone) {
  AlarmWaiter waiter;
  EXPECT_FALSE(waiter.wait.waits());
  EXPECT_EQ(waiter.ends_after_s(1.0), -1.0);
}

}  // namespace
}  // namespace softarm
