// The alarms of a recording, for a summary.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "softarm/monitor/mismatch_monitor.h"

namespace softarm::app {

/// Runs the live monitor over a recording and keeps its alarms.
class AlarmList {
 public:
  explicit AlarmList(const arm::Arm& arm) : monitor_(arm) {}

  void add(const trial::Frame& frame, const estimate::Estimate& estimate);
  void reset();

  /// "alarms: 2" and a line each: when (s from the first frame), for how long, what. Ends with a line break.
  std::string text() const;

 private:
  struct Alarm {
    double onset_s = 0.0, seen_s = 0.0;
    std::string description;
  };
  monitor::MismatchMonitor monitor_;
  std::optional<double> first_s_;
  std::vector<Alarm> alarms_;
  std::uint64_t more_ = 0;  // than are kept
  bool alarmed_ = false;
};

}  // namespace softarm::app
