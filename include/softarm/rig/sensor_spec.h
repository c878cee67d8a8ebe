// What is hidden in the sensors: motion capture, pressure sensors, clocks. All zero: only MocapSpec's white
// noise.
#pragma once

namespace softarm::rig {

struct SensorSpec {};

}  // namespace softarm::rig
