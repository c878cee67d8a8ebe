// How long a diagnosis waits once there was an alarm.
#pragma once

#include <ros/time.h>

#include <optional>

namespace softarm {

/// Waits for what follows an alarm, in the time of what is recorded: simulated, where there is such. A bag at
/// ten times its speed holds as much of it in a tenth of the time. Where that time stands still (the bag is
/// over, or paused) nothing follows: then the wait ends after as long by the machine's own clock.
class AlarmWait {
 public:
  explicit AlarmWait(double wait_s) : wait_s_(wait_s) {}

  /// Waits from now on, also where it waits already.
  void begin(const ros::Time& now, const ros::SteadyTime& steady);
  bool waits() const { return waiting_.has_value(); }
  /// Whether the wait is over; then it waits no more. To be asked a few times a second. Where time has gone
  /// back it waits anew, as what there was is no longer kept.
  bool over(const ros::Time& now, const ros::SteadyTime& steady);

 private:
  struct Waiting {
    ros::Time since, last;
    ros::SteadyTime moved;  ///< when time last went on
  };
  double wait_s_;
  std::optional<Waiting> waiting_;
};

}  // namespace softarm
