#include "leftover.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "math/statistics.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

/// Up to which a block is calm: a share of the time is.
double calm_limit_m(const JointModel& model) {
  std::vector<std::pair<double, std::size_t>> motion;  // of a block, and its frames
  std::size_t frames = 0;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      if (!model.uses(t, k)) continue;
      const model::Block& block = model.trials()[t].blocks[k];
      motion.emplace_back(model.motion_sd_m(t, k), block.last - block.first);
      frames += motion.back().second;
    }
  }
  std::sort(motion.begin(), motion.end());
  double calm_m = kPolicy.motion.calm * noise_m(model.arm());
  auto left = static_cast<double>(frames) * kPolicy.motion.calm_share;
  for (const auto& [sd_m, count] : motion) {
    if (left <= 0.0) break;
    calm_m = std::max(calm_m, sd_m);
    left -= static_cast<double>(count);
  }
  return calm_m;
}

}  // namespace

Leftover leftover(const JointModel& model, const Linearised& at, const Unseen& unseen) {
  const double limit_m = calm_limit_m(model);
  double sum = 0.0, spread = 0.0, unknown_sum_m2 = 0.0;
  int pairs = 0, calm_blocks = 0;
  std::map<int, std::pair<double, int>> by_body;
  std::vector<Eigen::Index> row(model.trials().size(), 0);
  std::vector<std::size_t> block(model.trials().size(), 0);
  for (const TimeStretch& stretch : at.stretches) {
    const std::size_t t = stretch.trial;
    const Eigen::Index end = row[t] + stretch.all_rows;
    double of_stretch = 0.0;
    for (; row[t] < end; ++block[t]) {
      const model::Block& b = model.trials()[t].blocks[block[t]];
      const bool calm = model.motion_sd_m(t, block[t]) <= limit_m;
      const double unknown_m2 = std::pow(model.motion_sd_m(t, block[t]), 2);
      if (calm) {
        unknown_sum_m2 += 3.0 * unknown_m2;
        ++calm_blocks;
      }
      Eigen::Vector3d before = Eigen::Vector3d::Zero();
      for (const model::Seen& seen : b.bodies) {
        Eigen::Vector3d r = Eigen::Vector3d::Zero();
        if (calm && at.root_weight[t][row[t]] > 0.0) {
          r = at.root_weight[t][row[t]] * unseen.residual[t].segment<3>(row[t]);
          by_body[seen.body].first += r.squaredNorm();
          ++by_body[seen.body].second;
          if (!before.isZero()) {
            // Bodies also share what of the motion is not known, and that is no surprise.
            of_stretch += r.dot(before) - unknown_m2;
            ++pairs;
          }
        }
        before = r;
        row[t] += 3;
      }
    }
    sum += of_stretch;
    spread += of_stretch * of_stretch;
  }
  Leftover out;
  if (pairs > 0) out.shared_m = std::sqrt(std::max(0.0, sum / pairs));
  if (spread > 0.0) out.shared_z = sum / std::sqrt(spread);
  if (by_body.size() < 3) return out;
  std::vector<double> squares;
  for (const auto& [body, seen] : by_body) squares.push_back(seen.first / seen.second);
  std::sort(squares.begin(), squares.end());
  const double most = squares.back();
  // The one that shows most, beyond all others: errors that grow along the arm are no body's own. The tip
  // moves most: what of the motion is not known may be its own, too.
  const double next = squares[squares.size() - 2];
  const double unknown_m2 = calm_blocks > 0 ? unknown_sum_m2 / calm_blocks : 0.0;
  if (most < kPolicy.verdict.lone_ratio * next) return out;
  for (const auto& [body, seen] : by_body)
    if (seen.first / seen.second == most) out.lone_body = body;
  out.lone_m = std::sqrt(std::max(0.0, most - next - unknown_m2));
  return out;
}

}  // namespace softarm::diagnose
