#include "free_swing.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "math/linear_algebra.h"
#include "math/statistics.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using model::Predicted;
using model::Seen;
using model::TrialData;

double distance_m(const Predicted& a, const Predicted& b) {
  return (a.rest.stations.back() - b.rest.stations.back()).norm();
}

/// How far bodies are from where the model has them while a swing lasts, per axis.
struct Misfit {
  double all_m = 0.0;           ///< 0: nothing was seen
  double beside_lines_m = 0.0;  ///< without what goes along a straight line over time, of each body
};

Misfit misfit_of(const FreeSwing& swing, Index bodies, const TrialData& trial,
                 const std::vector<Predicted>& predicted) {
  std::vector<double> all, beside_lines;
  for (Index body = 0; body < bodies; ++body) {
    std::vector<Vector3d> off;
    std::vector<double> t_s;
    for (std::size_t k = swing.first; k < swing.first + swing.by.size(); ++k) {
      const std::vector<Seen>& seen = trial.blocks[k].bodies;
      for (std::size_t j = 0; j < seen.size() && predicted[k].solved; ++j) {
        if (seen[j].body != body) continue;
        off.push_back(seen[j].p_base - predicted[k].p.col(static_cast<Index>(j)));
        t_s.push_back(predicted[k].rest.t_s - predicted[swing.first].rest.t_s);
      }
    }
    const auto n = static_cast<Index>(off.size());
    MatrixXd line(n, 2), left(n, 3);
    for (Index i = 0; i < n; ++i) {
      line.row(i) << 1.0, t_s[static_cast<std::size_t>(i)];
      left.row(i) = off[static_cast<std::size_t>(i)].transpose();
      all.push_back(left.row(i).norm());
    }
    double taken = 1.0;  // by the line, of the noise
    if (n > 2) {
      left -= line * line.colPivHouseholderQr().solve(left);
      taken = std::sqrt(static_cast<double>(n) / static_cast<double>(n - 2));
    }
    for (Index i = 0; i < n; ++i) beside_lines.push_back(taken * left.row(i).norm());
  }
  if (all.empty()) return {};
  return {math::median(std::move(all)) / math::kMedianOfChi3,
          math::median(std::move(beside_lines)) / math::kMedianOfChi3};
}

}  // namespace

std::vector<FreeSwing> free_swings(const model::TrialModes& modes, const TrialData& trial,
                                   const std::vector<Predicted>& predicted, double noise_m) {
  std::vector<model::Rest> rest;
  for (const Predicted& block : predicted) rest.push_back(block.solved ? block.rest : model::Rest());
  std::vector<FreeSwing> list;
  const Predicted* before_hand = nullptr;
  double hand_m = 0.0;  // how far the equilibria went under it
  bool held = false;
  for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
    if (trial.blocks[k].begins) {
      before_hand = nullptr;
      hand_m = 0.0;
      held = false;
    }
    if (!predicted[k].solved) continue;
    if (trial.blocks[k].set_aside) {
      if (before_hand != nullptr) hand_m = std::max(hand_m, distance_m(predicted[k], *before_hand));
      held = true;
      continue;
    }
    before_hand = &predicted[k];
    if (!held || modes[k] == nullptr) continue;
    list.push_back({k, noise_m + hand_m, model::free_swing(modes, trial, rest, predicted[k].sluggish, k)});
    hand_m = 0.0;
    held = false;
  }
  return list;
}

KnownSwing known_of(const FreeSwing& swing, const model::Modes& modes, const TrialData& trial,
                    const std::vector<Predicted>& predicted) {
  const Index r = swing.by.front().cols() / 2, bodies = swing.by.front().rows() / 6;
  const Index unknowns = 2 * r + 6 * bodies;
  KnownSwing known;
  const Misfit misfit = misfit_of(swing, bodies, trial, predicted);
  if (!(misfit.all_m > 0.0)) return known;
  MatrixXd information = MatrixXd::Zero(unknowns, unknowns);
  VectorXd gradient = VectorXd::Zero(unknowns);
  const double begin_s = predicted[swing.first].rest.t_s,
               span_s = std::max(1.0, predicted[swing.first + swing.by.size() - 1].rest.t_s - begin_s),
               step_s = span_s / static_cast<double>(swing.by.size());
  for (std::size_t i = 0; i < swing.by.size(); ++i) {
    const std::size_t k = swing.first + i;
    if (!predicted[k].solved) continue;
    for (std::size_t j = 0; j < trial.blocks[k].bodies.size(); ++j) {
      const Seen& seen = trial.blocks[k].bodies[j];
      const double white = seen.white_sd_m * seen.white_sd_m;
      // Noise is white; what the model misses beside it stays for a stretch, and counts once there. What it
      // misses all the time no swing does.
      const double stays = std::max(0.0, misfit.beside_lines_m * misfit.beside_lines_m - white);
      const double variance = white + stays * std::max(1.0, kPolicy.fit.stretch_s / step_s);
      MatrixXd row = MatrixXd::Zero(3, unknowns);
      row.leftCols(2 * r) = swing.by[i].middleRows<3>(3 * seen.body);
      row.middleCols<3>(2 * r + 6 * seen.body).setIdentity();
      row.middleCols<3>(2 * r + 6 * seen.body + 3) =
          (predicted[k].rest.t_s - begin_s) / span_s * Eigen::Matrix3d::Identity();
      const Vector3d off = seen.p_base - predicted[k].p.col(static_cast<Index>(j));
      information.noalias() += row.transpose() * row / variance;
      gradient.noalias() += row.transpose() * off / variance;
    }
  }
  for (Index m = 0; m < r; ++m) {
    const double sd = swing.reach_m / modes.bodies.topRows(3 * bodies).col(m).cwiseAbs().maxCoeff();
    information(m, m) += 1.0 / (sd * sd);
    information(r + m, r + m) += 1.0 / (sd * sd * modes.stiffness[m]);
  }
  information.diagonal().tail(6 * bodies).array() += 1.0 / (misfit.all_m * misfit.all_m + 1e-12);
  const MatrixXd covariance = math::inverse_of_symmetric(information);
  const VectorXd state = (covariance * gradient).head(2 * r);
  const MatrixXd sure = covariance.topLeftCorner(2 * r, 2 * r);
  for (const MatrixXd& by : swing.by) {
    known.displacement.push_back(by * state);
    const MatrixXd places = by.topRows(3 * bodies);
    known.sd_m.push_back(std::sqrt((places * sure).cwiseProduct(places).rowwise().sum().maxCoeff()));
  }
  return known;
}

}  // namespace softarm::diagnose
