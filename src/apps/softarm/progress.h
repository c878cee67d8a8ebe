// What long work shows on standard error.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "time_left.h"

namespace softarm::app {

/// A bar with fraction, rate and remaining time, redrawn in place on a terminal; a line every ten seconds
/// otherwise. It goes on while nothing is reported, so that long steps do not look dead. Thread-safe.
class Progress {
 public:
  /// @param unit what is counted per second: "frames"; empty: no rate is shown
  /// @param within factor within which the time left is known; more than 1 is shown as a range
  explicit Progress(std::string unit, double within = 1.0);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Adds to the whole work that is to be done, in any unit (messages, rows).
  void add_total(double work);
  /// Work done since the last call, and items (frames) that came of it.
  void advance(double work, std::uint64_t items);
  /// What is being done now, shown beside the bar.
  void doing(const std::string& what);
  /// A line of its own, above the bar.
  void line(const std::string& text);
  /// Takes the bar away, before something is printed elsewhere.
  void hide();

 private:
  using Clock = std::chrono::steady_clock;
  std::string rest(Clock::time_point now) const;  ///< behind the share: rate, what is done, time left
  double share() const;
  void draw(Clock::time_point now);
  void tick();
  void clear();

  const std::string unit_;
  const double within_;
  const bool terminal_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point drawn_ = start_;
  bool visible_ = false;
  double total_ = 0.0, done_ = 0.0;
  TimeLeft left_;
  std::uint64_t items_ = 0;
  std::string doing_;
  std::mutex mutex_;
  std::condition_variable end_;
  bool ended_ = false;
  std::thread ticker_;
};

}  // namespace softarm::app
