#include "payload_changes.h"

#include <algorithm>
#include <cmath>

#include "policy.h"

namespace softarm::estimate {
namespace {

constexpr auto& kPayload = kPolicy.payload;

}  // namespace

void PayloadChanges::forget() {
  *this = PayloadChanges(arm_kg_, follows_swings_);
}

void PayloadChanges::tell(double stamp_s, std::optional<double> kg) {
  const double passed_s = last_s_ ? stamp_s - *last_s_ : 0.0;
  // Frames further apart are of states of rest, each by itself.
  if (passed_s < 0.0 || passed_s > kPayload.settles_s) forget();
  last_s_ = stamp_s;
  if (!follows_swings_)
    variance_kg2_ *= std::exp(-2.0 * passed_s / kPayload.fades_s);
  else if (stamp_s >= hand_until_s_)
    variance_kg2_ = 0.0;
  if (passed_s > 0.0 && kg && told_kg_ && *kg != *told_kg_) change(*told_kg_, *kg);
  told_kg_ = kg;
}

void PayloadChanges::change(double from_kg, double to_kg) {
  const double by_kg = to_kg - from_kg;
  variance_kg2_ += by_kg * by_kg;
  hand_until_s_ = *last_s_ + kPayload.hand_s;
  if (std::abs(by_kg) > kPayload.trifle * (arm_kg_ + std::max(from_kg, to_kg)))
    settles_until_s_ = *last_s_ + kPayload.settles_s;
}

void PayloadChanges::see(double kg, double variance_kg2, bool alone) {
  if (!last_s_ || !(variance_kg2 > 0.0)) return;
  const double now_s = *last_s_;
  seen_.push_back({now_s, kg, variance_kg2});
  while (seen_.front().stamp_s < now_s - kPayload.compared_s) seen_.pop_front();
  // The newest frames against those before: means weighted by what each says.
  struct Mean {
    double weight = 0.0, sum = 0.0;
    int count = 0;
    void add(const Seen& s) {
      weight += 1.0 / s.variance_kg2;
      sum += s.kg / s.variance_kg2;
      ++count;
    }
    double variance_kg2(bool each_alone) const { return (each_alone ? 1.0 : count) / weight; }
  } newest, before;
  for (const Seen& s : seen_) (s.stamp_s > now_s - kPayload.newest_s ? newest : before).add(s);
  if (before.count == 0) return;
  const double from_kg = before.sum / before.weight, to_kg = newest.sum / newest.weight;
  const double by_kg = to_kg - from_kg;
  const double by_chance_kg2 = newest.variance_kg2(alone) + before.variance_kg2(alone);
  if (by_kg * by_kg < kPayload.seen_sd * kPayload.seen_sd * by_chance_kg2) return;
  // The same change, frame after frame, is one. A window follows it by itself.
  const double known_kg2 = variance_kg2_, known_until_s = hand_until_s_;
  variance_kg2_ = 0.0;
  change(from_kg, to_kg);
  if (!alone) variance_kg2_ = 0.0;
  if (known_kg2 > 0.0) hand_until_s_ = known_until_s;
  variance_kg2_ = std::max(variance_kg2_, known_kg2);
}

}  // namespace softarm::estimate
