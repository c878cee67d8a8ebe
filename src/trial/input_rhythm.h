// Whether the next value of an input is due, learned from its stamps.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "softarm/trial/trial.h"

namespace softarm::trial {

/// @param steps_s at least one
StepPattern pattern_of(std::vector<double> steps_s);

/// The shortest usual step between the stamps of one input.
///
/// Steps much shorter than the median (bursts after a hiccup) or longer (losses, pauses) count for nothing.
/// An input whose steps are all over the place, say one that is published on change, has no rhythm: nothing
/// says whether another value is to come before a frame, and it is never due.
class InputRhythm {
 public:
  void add(double stamp_s);
  /// True if a value with a stamp at or before `stamp_s` may still be on its way. Before the rhythm is known
  /// every stamp later than the last one may have or be preceded by another value.
  bool is_due(double stamp_s) const;
  std::optional<double> newest_s() const { return newest_s_; }
  /// Median step; absent until three values have come, or if there is no rhythm.
  std::optional<double> period_s() const;
  /// Absent until three values have come.
  std::optional<StepPattern> pattern() const;
  void reset() { *this = InputRhythm(); }

 private:
  void learn();

  std::optional<double> newest_s_;
  std::deque<double> steps_s_;
  bool irregular_ = false;
  double median_s_ = 0.0, shortest_s_ = 0.0;
};

}  // namespace softarm::trial
