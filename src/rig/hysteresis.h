// Hysteresis of one input in its form: private to the rig.
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "input_path_spec.h"
#include "play.h"

namespace softarm::rig {

/// Bouc and Wen's hysteresis (Y. K. Wen, "Method for random vibration of hysteretic systems", 1976):
/// output = input - width / 2 * z with dz = (du - |du| z / 2 - du |z| / 2) / knee, exponent 1 and beta =
/// gamma, for which an input that goes straight has a closed solution: towards 0, z goes straight; away from
/// it, it nears 1 exponentially. A cycle much wider than `width` is a loop whose branches lie `width` apart.
class BoucWenHysteresis {
 public:
  BoucWenHysteresis(double width, double start) : width_(width), input_(start) {}

  /// Takes the input to a value, monotonously from the last one, and gives the output.
  double to(double input) {
    const double knee = kKnee * width_;
    if (width_ <= 0.0) return input;
    const double sense = input < input_ ? -1.0 : 1.0;
    double way = std::abs(input - input_) / knee;
    double z = sense * z_;  // as if the input rose
    if (z < 0.0) {
      const double to_zero = std::min(way, -z);
      z += to_zero;
      way -= to_zero;
    }
    z_ = sense * (1.0 - (1.0 - z) * std::exp(-way));
    input_ = input;
    return input - 0.5 * width_ * z_;
  }

 private:
  /// Of the width: above 1 / 2, so that the output never goes against the input.
  static constexpr double kKnee = 0.6;
  double width_, input_;
  double z_ = 0.0;
};

/// The hysteresis of several inputs of one kind.
class Hysteresis {
 public:
  /// @param only the input that has it, from 0; -1: all
  Hysteresis(InputPathSpec::Hysteresis form, double width, const std::vector<double>& start, int only = -1) {
    for (std::size_t i = 0; i < start.size(); ++i) {
      const double own = only < 0 || static_cast<std::size_t>(only) == i ? width : 0.0;
      if (form == InputPathSpec::Hysteresis::kPlay)
        channels_.emplace_back(PlayHysteresis(own, start[i]));
      else
        channels_.emplace_back(BoucWenHysteresis(own, start[i]));
    }
  }

  void act(std::vector<double>& inputs) {
    for (std::size_t i = 0; i < inputs.size(); ++i)
      inputs[i] = std::visit([&](auto& channel) { return channel.to(inputs[i]); }, channels_[i]);
  }

 private:
  std::vector<std::variant<PlayHysteresis, BoucWenHysteresis>> channels_;
};

}  // namespace softarm::rig
