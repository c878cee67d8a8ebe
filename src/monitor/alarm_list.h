// The alarms of a recording, for a summary.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "softarm/monitor/mismatch_monitor.h"

namespace softarm::monitor {

/// Of what the live monitor said, frame after frame.
class AlarmList {
 public:
  struct Alarm {
    double onset_s = 0.0, seen_s = 0.0;  ///< from the first frame: when it began, and was last seen
    std::string description;
  };

  void add(const Mismatch& mismatch);
  /// The monitor was reset: what it says next is no longer about the last alarm.
  void interrupt() { alarmed_ = false; }

  /// The first twenty.
  const std::vector<Alarm>& alarms() const { return alarms_; }
  /// "alarms: 2" and a line each: when (s from the first frame), for how long, what. Ends with a line break.
  std::string text() const;

 private:
  std::optional<double> first_s_;
  std::vector<Alarm> alarms_;
  std::uint64_t more_ = 0;  // than are kept
  bool alarmed_ = false;
};

}  // namespace softarm::monitor
