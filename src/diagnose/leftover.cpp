#include "leftover.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "math/statistics.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

double calm_limit_m(const JointModel& model) {
  std::vector<double> motion;  // as many times as the block has means
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k)
      if (model.uses(t, k))
        motion.insert(motion.end(), static_cast<std::size_t>(model.trials()[t].blocks[k].means),
                      model.motion_sd_m(t, k));
  }
  const double calm_m = kPolicy.motion.calm * noise_m(model.arm());
  if (motion.empty()) return calm_m;
  return std::max(calm_m, math::quantile(std::move(motion), kPolicy.motion.calm_share));
}

/// Squares of a body's residuals in one stretch, and of how many means of the usual length.
struct Squares {
  double sum = 0.0;
  int means = 0;
};

/// The body that shows most beyond the others.
/// @param by_body of each body, its stretches
void add_lone(const std::map<int, std::vector<Squares>>& by_body, Leftover& out) {
  std::map<int, double> mean;
  std::vector<double> all;
  for (const auto& [body, stretches] : by_body) {
    Squares total;
    for (const Squares& of : stretches) total = {total.sum + of.sum, total.means + of.means};
    mean[body] = total.sum / total.means;
    all.push_back(mean[body]);
  }
  if (all.size() < 3) return;
  const double median = math::median(std::move(all));
  for (const auto& [body, square] : mean) {
    const double beyond = square - median;
    if (square < kPolicy.verdict.lone_ratio * median || std::sqrt(beyond) <= out.lone_m) continue;
    out.lone_m = std::sqrt(beyond);
    out.lone_body = body;
  }
  if (out.lone_body < 0) return;
  double sum = 0.0, spread = 0.0;
  for (const Squares& of : by_body.at(out.lone_body)) {
    const double beyond = of.sum - of.means * median;
    sum += beyond;
    spread += beyond * beyond;
  }
  out.lone_z = sum / std::sqrt(spread);
}

}  // namespace

Leftover leftover(const JointModel& model, const Linearised& at, const Unseen& unseen) {
  const double limit_m = calm_limit_m(model);
  double sum = 0.0, spread = 0.0;
  int pairs = 0;  // of means of the usual length
  std::map<int, std::vector<Squares>> by_body;
  std::vector<Eigen::Index> row(model.trials().size(), 0);
  std::vector<std::size_t> block(model.trials().size(), 0);
  for (const TimeStretch& stretch : at.stretches) {
    const std::size_t t = stretch.trial;
    const Eigen::Index end = row[t] + stretch.all_rows;
    double of_stretch = 0.0;
    std::map<int, Squares> squares;
    for (; row[t] < end; ++block[t]) {
      const model::Block& b = model.trials()[t].blocks[block[t]];
      const bool calm = model.motion_sd_m(t, block[t]) <= limit_m;
      const double unknown_m2 = std::pow(model.motion_sd_m(t, block[t]), 2);
      Eigen::Vector3d before = Eigen::Vector3d::Zero();
      for (const model::Seen& seen : b.bodies) {
        Eigen::Vector3d r = Eigen::Vector3d::Zero();
        if (calm && at.root_weight[t][row[t]] > 0.0) {
          r = at.root_weight[t][row[t]] * unseen.residual[t].segment<3>(row[t]);
          squares[seen.body].sum += b.means * r.squaredNorm();
          squares[seen.body].means += b.means;
          if (!before.isZero()) {
            // Bodies also share what of the motion is not known, and that is no surprise.
            of_stretch += b.means * (r.dot(before) - unknown_m2);
            pairs += b.means;
          }
        }
        before = r;
        row[t] += 3;
      }
    }
    for (const auto& [body, of] : squares) by_body[body].push_back(of);
    sum += of_stretch;
    spread += of_stretch * of_stretch;
  }
  Leftover out;
  if (pairs > 0) out.shared_m = std::sqrt(std::max(0.0, sum / pairs));
  if (spread > 0.0) out.shared_z = sum / std::sqrt(spread);
  add_lone(by_body, out);
  return out;
}

}  // namespace softarm::diagnose
