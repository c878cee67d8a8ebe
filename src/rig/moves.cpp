#include "moves.h"

#include <algorithm>
#include <cmath>

#include "random_stream.h"

namespace softarm::rig {
namespace {

constexpr double kCornerS = 0.1;

double longest_way(const std::vector<double>& from, const std::vector<double>& to) {
  double way = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) way = std::max(way, std::abs(to[i] - from[i]));
  return way;
}

}  // namespace

double rounded_ramp(double t_s, double over_s, double corner_s) {
  if (t_s <= 0.0) return 0.0;
  if (t_s >= over_s) return 1.0;
  if (t_s > 0.5 * over_s) return 1.0 - rounded_ramp(over_s - t_s, over_s, corner_s);
  const double rate = 1.0 / (over_s - corner_s);
  if (t_s >= corner_s) return rate * (t_s - 0.5 * corner_s);
  // The rate rises like x^2 (3 - 2 x).
  const double x = t_s / corner_s;
  return rate * corner_s * x * x * x * (1.0 - 0.5 * x);
}

Moves::Moves(const DriveSpec& drive, int inputs, std::uint64_t seed, std::uint64_t purpose)
    : rest_(static_cast<std::size_t>(inputs), drive.rest), repeat_(drive.programme.repeat) {
  RandomStream random(seed, purpose);
  for (const ProgrammePart& part : drive.programme.parts) {
    const auto go = [&](const std::vector<double>& to, std::size_t rate) {
      part.rates.empty() ? move(to, part.over_s.value_or(drive.ramp_s)) : move_at(to, part.rates[rate]);
    };
    const std::vector<double> begin = end();
    switch (part.kind) {
      case ProgrammePart::Kind::kHold:
        hold(part.hold_s);
        break;
      case ProgrammePart::Kind::kRamp:
        go(part.to, 0);
        break;
      case ProgrammePart::Kind::kCycle:
        for (std::size_t rate = 0; rate < std::max<std::size_t>(1, part.rates.size()); ++rate)
          for (int i = 0; i < part.times; ++i)
            for (const std::vector<double>& to : {part.to, begin}) {
              go(to, rate);
              hold(part.hold_s);
            }
        break;
      case ProgrammePart::Kind::kStaircase:
        for (int i = 1; i <= (part.back ? 2 : 1) * part.levels; ++i) {
          const int level = i <= part.levels ? i : 2 * part.levels - i;
          std::vector<double> to = begin;
          for (std::size_t k = 0; k < to.size(); ++k) to[k] += (part.to[k] - begin[k]) * level / part.levels;
          go(to, 0);
          hold(part.hold_s);
        }
        break;
      case ProgrammePart::Kind::kRandomHolds:
        for (int i = 0; i < part.times; ++i) {
          std::vector<double> to = rest_;
          for (std::size_t k = 0; k < to.size(); ++k) {
            const bool off = random.uniform() < part.off_probability;
            const double value = random.uniform(part.min[k], part.max[k]);
            if (!off) to[k] = value;
          }
          go(to, static_cast<std::size_t>(random.uniform() * static_cast<double>(part.rates.size())));
          hold(part.hold_s);
        }
        break;
    }
  }
  if (longest_way(end(), rest_) > 0.0) move(rest_, drive.ramp_s);
}

void Moves::move(const std::vector<double>& to, double over_s) {
  moves_.push_back({length_s_, over_s, std::min(kCornerS, 0.5 * over_s), end(), to});
  length_s_ += over_s;
}

void Moves::move_at(const std::vector<double>& to, double rate) {
  const double even_s = longest_way(end(), to) / rate;
  if (even_s <= 0.0) return;
  const double corner_s = std::min(kCornerS, even_s);
  moves_.push_back({length_s_, even_s + corner_s, corner_s, end(), to});
  length_s_ += even_s + corner_s;
}

double Moves::value(std::size_t input, double t_s) const {
  if (repeat_ && length_s_ > 0.0 && t_s > 0.0) t_s = std::fmod(t_s, length_s_);
  const auto later = std::upper_bound(moves_.begin(), moves_.end(), t_s,
                                      [](double t, const Move& move) { return t < move.begin_s; });
  if (later == moves_.begin()) return rest_[input];
  const Move& move = *std::prev(later);
  const double share = rounded_ramp(t_s - move.begin_s, move.over_s, move.corner_s);
  return move.from[input] + (move.to[input] - move.from[input]) * share;
}

}  // namespace softarm::rig
