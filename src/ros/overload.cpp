#include "overload.h"

#include <algorithm>
#include <cmath>

namespace softarm {
namespace {

// A burst after a hiccup is worked off within that; and it ends when the node has kept up for so long.
constexpr double kPatience_s = 0.15, kRelief_s = 1.0;
constexpr double kSmoothing = 0.02;  // of the time of a frame: over fifty of them

}  // namespace

std::size_t Overload::stride(std::size_t frames, double now_s) {
  const double budget_s = 0.5 * latency_s_, needed_s = static_cast<double>(frames) * frame_s_;
  if (budget_s <= 0.0 || frames == 0) return 1;
  const bool behind = needed_s > budget_s;
  if (behind) last_behind_s_ = now_s;
  if (!behind && !lasts_) behind_since_s_.reset();
  if (behind && !behind_since_s_) behind_since_s_ = now_s;
  if (lasts_ && now_s - last_behind_s_ > kRelief_s) {
    lasts_ = false;
    behind_since_s_.reset();
  }
  lasts_ = lasts_ || (behind && now_s - *behind_since_s_ > kPatience_s);
  return lasts_ && behind ? static_cast<std::size_t>(std::ceil(needed_s / budget_s)) : 1;
}

void Overload::took(double seconds) {
  frame_s_ = frame_s_ > 0.0 ? frame_s_ + kSmoothing * (seconds - frame_s_) : seconds;
}

}  // namespace softarm
