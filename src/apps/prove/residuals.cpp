#include "residuals.h"

#include <cmath>
#include <iterator>
#include <set>

namespace softarm::prove {

Residuals at_times_of(const Residuals& others, const Residuals& residuals) {
  constexpr double kNear_s = 0.7;  // means at rest are up to 0.6 s long
  Residuals aligned(others.size());
  for (std::size_t t = 0; t < others.size(); ++t) {
    std::map<int, std::map<std::int64_t, Eigen::Vector3d>> by_body;
    for (const auto& [key, residual] : residuals[t]) by_body[key.second][key.first] = residual;
    for (const auto& [key, ignored] : others[t]) {
      const auto& own = by_body[key.second];
      const auto after = own.lower_bound(key.first);
      if (after == own.end()) continue;
      if (after->first == key.first) {
        aligned[t][key] = after->second;
        continue;
      }
      if (after == own.begin()) continue;
      const auto before = std::prev(after);
      const auto gap = static_cast<double>(after->first - before->first);
      if (gap * kTick_s > kNear_s) continue;
      const double share = static_cast<double>(key.first - before->first) / gap;
      aligned[t][key] = (1.0 - share) * before->second + share * after->second;
    }
  }
  return aligned;
}

Residuals differences(const Residuals& with, const Residuals& without) {
  Residuals all(with.size());
  for (std::size_t t = 0; t < with.size(); ++t) {
    for (const auto& [key, residual] : with[t]) {
      const auto other = without[t].find(key);
      if (other != without[t].end()) all[t][key] = residual - other->second;
    }
  }
  return all;
}

Residuals at_whole_seconds(const Residuals& residuals) {
  const auto second = std::llround(1.0 / kTick_s), every = kDisplacementEvery_s * second;  // in ticks
  // By trial, every so often and by body: what is still looked for.
  std::vector<std::set<std::pair<std::int64_t, int>>> open(residuals.size());
  for (std::size_t t = 0; t < residuals.size(); ++t)
    for (const auto& [key, ignored] : residuals[t])
      if (key.second >= 0) open[t].insert({(key.first + every - 1) / every * every, key.second});
  Residuals found(residuals.size());
  for (std::int64_t earlier = 0; earlier < every; earlier += second) {
    Residuals wanted(residuals.size());
    for (std::size_t t = 0; t < open.size(); ++t)
      for (const auto& [last, body] : open[t]) wanted[t][{last - earlier, body}].setZero();
    const Residuals there = at_times_of(wanted, residuals);
    for (std::size_t t = 0; t < there.size(); ++t) {
      for (const auto& [key, residual] : there[t]) {
        found[t][key] = residual;
        open[t].erase({key.first + earlier, key.second});
      }
    }
  }
  return found;
}

}  // namespace softarm::prove
