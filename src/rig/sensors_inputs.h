// The sensors of pressures, tensions and angles, and their messages: private to the rig.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "protocol.h"
#include "sensors_clocks.h"
#include "sensors_random.h"
#include "simulator.h"

namespace softarm::rig {

/// Messages of the inputs: what is commanded, through the errors of the sensors.
class InputSensors {
 public:
  InputSensors(const Scenario& scenario, const Protocol& protocol);

  /// Messages sent after the last call up to this time, in the order of receipt.
  std::vector<InputSample> messages_until(double until_s);

 private:
  /// One sender: all inputs of a drive, in one rate.
  struct Sender {
    const DriveSpec* drive;
    MessageClock clock;
    std::size_t sent = 0;
  };
  struct Sensor {
    double gain = 1.0, offset = 0.0, clock_s = 0.0;
    std::vector<double> steps;
    std::vector<std::pair<double, RandomStream>> noises;  ///< sd
    std::vector<FaultTimes> stuck, dead;
    std::optional<double> last;
  };

  template <typename Add>
  void send(Sender& sender, double until_s, const Add& add);
  /// What the sensor of an input makes of its value; nothing: it is silent.
  std::optional<double> measure(InputKind kind, int number, double t_s, double value);
  Sensor& sensor(InputKind kind, int number);
  bool is_in_gap(double t_s) const;

  const Scenario& scenario_;
  const Protocol& protocol_;
  Sender pressures_, tensions_, angles_;
  std::map<std::pair<InputKind, int>, Sensor> sensors_;
};

}  // namespace softarm::rig
