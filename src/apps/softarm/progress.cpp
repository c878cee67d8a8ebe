#include "softarm/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace softarm::app {
namespace {

constexpr auto kRedraw = std::chrono::milliseconds(100);
constexpr int kWidth = 30;

double seconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

}  // namespace

Progress::Progress(std::string unit) : unit_(std::move(unit)), terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  clear();
}

void Progress::add_total(double work) {
  const std::lock_guard<std::mutex> lock(mutex_);
  total_ += work;
}

void Progress::advance(double work, std::uint64_t items) {
  const std::lock_guard<std::mutex> lock(mutex_);
  done_ += work;
  items_ += items;
  const Clock::time_point now = Clock::now();
  if (terminal_ && now - drawn_ >= kRedraw) draw(now);
}

void Progress::line(const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  clear();
  fmt::print(stderr, "{}\n", text);
}

void Progress::hide() {
  const std::lock_guard<std::mutex> lock(mutex_);
  clear();
}

void Progress::draw(Clock::time_point now) {
  drawn_ = now;
  visible_ = true;
  const double fraction = total_ > 0.0 ? std::clamp(done_ / total_, 0.0, 1.0) : 0.0;
  const double elapsed_s = seconds(now - start_);
  const int filled = static_cast<int>(fraction * kWidth);
  const std::string eta =
      fraction > 0.0 ? fmt::format("{:.0f} s left", elapsed_s * (1.0 - fraction) / fraction) : "";
  fmt::print(stderr, "\r\033[K[{}{}] {:3.0f} %  {:.0f} {}/s  {}", std::string(filled, '#'),
             std::string(kWidth - filled, '.'), 100.0 * fraction,
             static_cast<double>(items_) / std::max(elapsed_s, 1e-3), unit_, eta);
  std::fflush(stderr);
}

void Progress::clear() {
  if (!visible_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  visible_ = false;
}

}  // namespace softarm::app
