#include "leftover.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace softarm::diagnose {
namespace {

constexpr double kCalm_m = 5e-5;       // of what is not known of the motion, per axis
constexpr std::size_t kCalmShare = 4;  // at least a quarter of the blocks is called calm
constexpr double kLoneRatio = 1.7;     // of a body's mean square over the bodies' median

double calm_limit_m(const JointModel& model) {
  std::vector<double> motion;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k)
      if (model.uses(t, k)) motion.push_back(model.motion_sd_m(t, k));
  }
  if (motion.empty()) return kCalm_m;
  const auto quarter = motion.begin() + static_cast<std::ptrdiff_t>(motion.size() / kCalmShare);
  std::nth_element(motion.begin(), quarter, motion.end());
  return std::max(kCalm_m, *quarter);
}

}  // namespace

Leftover leftover(const JointModel& model, const Linearised& at, const Unseen& unseen) {
  const double limit_m = calm_limit_m(model);
  double sum = 0.0, spread = 0.0;
  int pairs = 0;
  std::map<int, std::pair<double, int>> by_body;
  std::vector<Eigen::Index> row(model.trials().size(), 0);
  std::vector<std::size_t> block(model.trials().size(), 0);
  for (const Chunk& chunk : at.chunks) {
    const std::size_t t = chunk.trial;
    const Eigen::Index end = row[t] + chunk.all_rows;
    double of_stretch = 0.0;
    for (; row[t] < end; ++block[t]) {
      const effects::Block& b = model.trials()[t].blocks[block[t]];
      const bool calm = model.motion_sd_m(t, block[t]) <= limit_m;
      Eigen::Vector3d before = Eigen::Vector3d::Zero();
      for (const effects::Seen& seen : b.bodies) {
        Eigen::Vector3d r = Eigen::Vector3d::Zero();
        if (calm && at.root_weight[t][row[t]] > 0.0) {
          r = at.root_weight[t][row[t]] * unseen.residual[t].segment<3>(row[t]);
          by_body[seen.body].first += r.squaredNorm();
          ++by_body[seen.body].second;
          if (!before.isZero()) {
            of_stretch += r.dot(before);
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
  std::vector<double> squares;
  for (const auto& [body, seen] : by_body) squares.push_back(seen.first / seen.second);
  if (squares.size() < 3) return out;
  std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2),
                   squares.end());
  const double median = squares[squares.size() / 2];
  for (const auto& [body, seen] : by_body) {
    const double beyond = seen.first / seen.second - median;
    if (seen.first / seen.second < kLoneRatio * median || std::sqrt(beyond) <= out.lone_m) continue;
    out.lone_m = std::sqrt(beyond);
    out.lone_body = body;
  }
  return out;
}

}  // namespace softarm::diagnose
