// When messages are stamped and received: private to the rig.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "sensors_random.h"
#include "simulator.h"

namespace softarm::rig {

struct Timing {
  double stamp_s = 0.0, receipt_s = 0.0;
};

/// The clock and the line of one sender, whose messages overtake one another in neither.
class MessageClock {
 public:
  /// @param sender numbers those of a stream: each has random numbers of its own
  MessageClock(const Scenario& scenario, MessageStream stream, std::size_t sender);

  /// Asked in the order of time. Receipt is by the clock of the inputs.
  Timing time(double sent_s);

 private:
  struct Line {
    const Latency* spec;
    RandomStream random;
  };
  struct Jitter {
    const StampJitter* spec;
    RandomStream random;
  };

  std::optional<ClockOffset> clock_;
  double session_s_;  ///< when the scenario begins
  std::vector<Line> lines_;
  std::vector<Jitter> jitters_;
  double last_stamp_s_ = -std::numeric_limits<double>::infinity();
  double last_receipt_s_ = -std::numeric_limits<double>::infinity();
};

}  // namespace softarm::rig
