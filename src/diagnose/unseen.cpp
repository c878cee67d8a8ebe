#include "unseen.h"

#include <Eigen/Dense>
#include <cmath>

#include "math/linear_algebra.h"

namespace softarm::diagnose {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Unseen unseen(const JointModel& model, const Linearised& at) {
  const std::size_t trials = model.trials().size();
  std::vector<MatrixXd> information(trials, at.information);
  std::vector<VectorXd> gradient(trials, at.gradient);
  for (const TimeStretch& stretch : at.stretches) {
    information[stretch.trial] -= stretch.information;
    gradient[stretch.trial] -= stretch.gradient;
  }
  Unseen out;
  std::size_t bodies = 0;
  double all_sum = 0.0, all_weight = 0.0, fitted_sum = 0.0;
  for (std::size_t t = 0; t < trials; ++t) {
    // One trial alone has no others: its own fit is all there is.
    VectorXd step = VectorXd::Zero(at.gradient.size());
    if (trials > 1) step = math::solve_symmetric(information[t], gradient[t]);
    double chi2 = 0.0;
    for (const TimeStretch& stretch : at.stretches) {
      if (stretch.trial == t)
        chi2 += stretch.square - 2.0 * step.dot(stretch.gradient) + step.dot(stretch.information * step);
    }
    out.chi2.push_back(chi2);
    out.total_chi2 += chi2;
    const VectorXd r = at.residual[t] - at.derivative[t] * step;
    VectorXd metres = VectorXd::Zero(r.size());
    double sum = 0.0, weight = 0.0, distances_m = 0.0, most_m = 0.0;
    std::size_t seen_bodies = 0;
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      for (const model::Seen& seen : model.trials()[t].blocks[k].bodies) {
        if (at.root_weight[t][row] > 0.0) {
          const double sd = model.sd_m(t, k, seen), w = 1.0 / (sd * sd);
          const double scale = sd / at.root_weight[t][row];
          metres.segment<3>(row) = scale * r.segment<3>(row);
          const double distance_m = metres.segment<3>(row).norm();
          distances_m += distance_m;
          most_m = std::max(most_m, distance_m);
          ++seen_bodies;
          sum += w * metres.segment<3>(row).squaredNorm();
          fitted_sum += w * scale * scale * at.residual[t].segment<3>(row).squaredNorm();
          weight += w;
        }
        row += 3;
      }
    }
    out.rms_m.push_back(weight > 0.0 ? std::sqrt(sum / weight) : 0.0);
    out.residual.push_back(std::move(metres));
    out.mean_of_m.push_back(seen_bodies > 0 ? distances_m / static_cast<double>(seen_bodies) : 0.0);
    out.max_of_m.push_back(most_m);
    out.mean_m += distances_m;
    out.max_m = std::max(out.max_m, most_m);
    bodies += seen_bodies;
    all_sum += sum;
    all_weight += weight;
  }
  if (bodies > 0) out.mean_m /= static_cast<double>(bodies);
  if (all_weight > 0.0) {
    out.total_rms_m = std::sqrt(all_sum / all_weight);
    out.fitted_rms_m = std::sqrt(fitted_sum / all_weight);
  }
  return out;
}

}  // namespace softarm::diagnose
