// How long work will still take, by what is done of it.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace softarm::app {

/// What is left goes by the rate so far, and is counted down while nothing is reported: long steps are
/// reported at their beginning only.
class TimeLeft {
 public:
  /// @param share done, 0 to 1 @param now_s since the beginning
  void reached(double share, double now_s) {
    if (share == share_) return;
    share_ = share;
    since_s_ = now_s;
    left_s_ =
        share > 0.0 && share < 1.0 ? std::optional<double>(now_s * (1.0 - share) / share) : std::nullopt;
  }

  /// Nothing before the first share and after the last.
  std::optional<double> seconds(double now_s) const {
    if (!left_s_) return std::nullopt;
    return std::max(*left_s_ - (now_s - since_s_), kLeast * *left_s_);
  }

 private:
  static constexpr double kLeast = 0.1;  // a step that takes longer than it should is still not the last

  double share_ = 0.0, since_s_ = 0.0;
  std::optional<double> left_s_;
};

/// "12 s left"; "8 to 19 s left" where that is known within a factor only.
inline std::string time_left_text(double left_s, double within) {
  const double most_s = std::round(left_s * within), least_s = std::round(left_s / within);
  return least_s < most_s ? fmt::format("{:.0f} to {:.0f} s left", least_s, most_s)
                          : fmt::format("{:.0f} s left", most_s);
}

}  // namespace softarm::app
