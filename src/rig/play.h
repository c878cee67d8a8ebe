// Rate-independent hysteresis: private to the rig.
#pragma once

#include <algorithm>
#include <array>

namespace softarm::rig {

/// A Prandtl-Ishlinskii operator: the mean of plays of graded radii (M. Brokate, J. Sprekels, "Hysteresis and
/// Phase Transitions", 1996, 2.3). Beyond the plays its slope is 1, and a cycle much wider than `width` is a
/// loop whose branches lie `width` apart.
class PlayHysteresis {
 public:
  PlayHysteresis(double width, double start) {
    for (std::size_t i = 0; i < kPlays; ++i)
      plays_[i] = {width * (static_cast<double>(i) + 0.5) / kPlays, start};
  }

  /// Takes the input to a value, monotonously from the last one, and gives the output.
  double to(double input) {
    double sum = 0.0;
    for (Play& play : plays_) {
      play.output = std::clamp(play.output, input - play.radius, input + play.radius);
      sum += play.output;
    }
    return sum / kPlays;
  }

 private:
  static constexpr std::size_t kPlays = 4;
  struct Play {
    double radius = 0.0, output = 0.0;
  };
  std::array<Play, kPlays> plays_;
};

}  // namespace softarm::rig
