// A programme as the moves that it consists of: private to the rig.
#pragma once

#include <cstdint>
#include <vector>

#include "scenario.h"

namespace softarm::rig {

/// All inputs of a kind go from one set of values to another between two times.
struct Move {
  double begin_s = 0.0, over_s = 0.0;
  double corner_s = 0.0;  ///< how long the rate takes to rise, and to fall
  std::vector<double> from, to;
};

/// The moves of a drive's programme, in between everything holds.
class Moves {
 public:
  Moves() = default;
  /// @param seed, purpose of the random parts
  Moves(const DriveSpec& drive, int inputs, std::uint64_t seed, std::uint64_t purpose);

  /// Value of an input at a time since the programme's begin.
  double value(std::size_t input, double t_s) const;
  /// Time at which it is at rest again.
  double length_s() const { return length_s_; }

 private:
  /// Rest, or where the last move ended.
  const std::vector<double>& end() const { return moves_.empty() ? rest_ : moves_.back().to; }
  void move(const std::vector<double>& to, double over_s);
  /// Moves with a rate of the input that goes farthest.
  void move_at(const std::vector<double>& to, double rate);
  void hold(double for_s) { length_s_ += for_s; }

  std::vector<double> rest_;
  std::vector<Move> moves_;
  double length_s_ = 0.0;
  bool repeat_ = false;
};

/// Of a move's way: rising and falling rate with continuous acceleration, constant in between.
double rounded_ramp(double t_s, double over_s, double corner_s);

}  // namespace softarm::rig
