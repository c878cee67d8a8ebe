// How far a work is of which nobody knows beforehand how much there will be.
#pragma once

#include <functional>
#include <string>

#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// Tells progress by the time that was spent and what is probably left, as multiples of a first part's time:
/// of a longer recording, on a slower machine, all of it takes so much longer.
class Schedule {
 public:
  /// @param progress may be empty
  /// @param now_s a clock
  Schedule(Progress progress, std::function<double()> now_s);

  /// What follows goes from one share of all to another.
  void within(double from, double to);
  /// Within the first part. @param share of all, as it usually is
  void first_part(double share, const std::string& what);
  /// From here on another first part is made in its place.
  void begin_first_part(const std::string& what);
  void end_first_part();
  /// @param parts left, each as long as the first
  void left(double parts, const std::string& what);
  void end();

 private:
  void tell(double share, const std::string& what);

  const Progress progress_;
  const std::function<double()> now_s_;
  double begin_s_, part_s_ = 0.0, share_ = 0.0;
  double from_ = 0.0, to_ = 1.0;
};

}  // namespace softarm::diagnose
