#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace softarm::app {
namespace {

constexpr auto kRedraw = std::chrono::milliseconds(100);
constexpr auto kTick = std::chrono::seconds(1);
constexpr auto kLine = std::chrono::seconds(10);  // where standard error is no terminal
constexpr int kWidth = 30;

double seconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

}  // namespace

Progress::Progress(std::string unit, double within)
    : unit_(std::move(unit)),
      within_(within),
      terminal_(::isatty(STDERR_FILENO) == 1),
      ticker_([this] { tick(); }) {}

Progress::~Progress() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
    clear();
  }
  end_.notify_all();
  ticker_.join();
}

void Progress::tick() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!end_.wait_for(lock, kTick, [this] { return ended_; })) {
    const Clock::time_point now = Clock::now();
    if (terminal_ ? visible_ && now - drawn_ >= kTick : now - drawn_ >= kLine) draw(now);
  }
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
  left_.reached(share(), seconds(now - start_));
  if (terminal_ && now - drawn_ >= kRedraw) draw(now);
}

void Progress::doing(const std::string& what) {
  const std::lock_guard<std::mutex> lock(mutex_);
  doing_ = what;
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

double Progress::share() const {
  return total_ > 0.0 ? std::clamp(done_ / total_, 0.0, 1.0) : 0.0;
}

std::string Progress::rest(Clock::time_point now) const {
  const double elapsed_s = seconds(now - start_);
  std::string text;
  const auto add = [&](const std::string& part) {
    if (!part.empty()) text += (text.empty() ? "" : "  ") + part;
  };
  const double rate = static_cast<double>(items_) / std::max(elapsed_s, 1e-3);
  if (!unit_.empty() && rate >= 0.5) add(fmt::format("{:.0f} {}/s", rate, unit_));
  add(doing_);
  if (const std::optional<double> left_s = left_.seconds(elapsed_s)) add(time_left_text(*left_s, within_));
  return text;
}

void Progress::draw(Clock::time_point now) {
  drawn_ = now;
  if (!terminal_) {
    fmt::print(stderr, "{:.0f} s: {:.0f} %  {}\n", seconds(now - start_), 100.0 * share(), rest(now));
    return;
  }
  visible_ = true;
  const int filled = static_cast<int>(share() * kWidth);
  fmt::print(stderr, "\r\033[K[{}{}] {:3.0f} %  {}", std::string(filled, '#'),
             std::string(kWidth - filled, '.'), 100.0 * share(), rest(now));
  std::fflush(stderr);
}

void Progress::clear() {
  if (!visible_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  visible_ = false;
}

}  // namespace softarm::app
