// What is hidden between a command and what acts in the arm: regulators, lines, tendons, memory.
#pragma once

namespace softarm::rig {

struct InputPathSpec {
  /// Rate-independent hysteresis between an input and what acts in the arm: the width of the loop, in the
  /// input's unit, of a cycle that is wide against it.
  double pressure_play_pa = 0.0, tension_play_n = 0.0, angle_play_rad = 0.0;
};

}  // namespace softarm::rig
