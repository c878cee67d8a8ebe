#include "uncertainty.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "math/linear_algebra.h"

namespace softarm::identify {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kFewestClusters = 6;  // trials from which their spread says something
constexpr std::size_t kClustersOfFewTrials = 8;
constexpr double kLeastInformation = 1e-10;  // an sd of 1e5 scales stands for infinity
constexpr double kIdentifiable = 1.0;        // information from which a direction's sd is below its scale
constexpr double kLeastCorrelation = 0.05;

/// Sums over the blocks of one trial.
struct Cluster {
  MatrixXd information;  ///< J^T W J
  VectorXd gradient;     ///< J^T W r
};

/// Number of consecutive frames that are worth one: 1 + 2 sum of the autocorrelations of the residuals along
/// the trials, up to the first that cannot be distinguished from none.
double autocorrelation_time(const JointProblem& problem, const std::vector<ResidualBlock>& blocks,
                            const std::vector<trial::StaticFrame>& frames) {
  // Series of one body's residual along one trial, by (trial, body, kind).
  std::map<std::pair<std::size_t, int>, std::vector<Vector3d>> series;
  double longest = 1.0, square = 0.0, count = 0.0;
  for (const ResidualBlock& block : blocks) {
    const trial::StaticFrame& frame = frames[block.frame];
    const int body = frame.bodies[static_cast<std::size_t>(block.body)].body;
    auto& list = series[{frame.trial, 2 * body + (block.tangent ? 1 : 0)}];
    const Vector3d r = problem.residual(block);
    list.push_back(std::sqrt(problem.weight(block, r.squaredNorm())) * r);
    square += list.back().squaredNorm();
    count += 1.0;
    longest = std::max(longest, static_cast<double>(list.size()));
  }
  if (!(square > 0.0)) return 1.0;
  double time = 1.0;
  for (std::size_t lag = 1; static_cast<double>(lag) < longest; ++lag) {
    double product = 0.0, pairs = 0.0;
    for (const auto& [key, list] : series) {
      for (std::size_t i = 0; i + lag < list.size(); ++i) {
        product += list[i].dot(list[i + lag]);
        pairs += 1.0;
      }
    }
    const double correlation = product / pairs / (square / count);
    if (!(correlation > std::max(kLeastCorrelation, 2.0 / std::sqrt(3.0 * pairs)))) break;
    // Pairs over frames: trials shorter than the lag have none.
    time += 2.0 * correlation * pairs / count;
  }
  return time;
}

/// For each frame the cluster whose frames may share an error: its trial, or, of few trials, a stretch of
/// one.
std::vector<std::size_t> cluster_frames(const std::vector<trial::StaticFrame>& frames) {
  std::map<std::size_t, std::size_t> counts;
  for (const trial::StaticFrame& frame : frames) ++counts[frame.trial];
  const std::size_t trials = std::max<std::size_t>(1, counts.size());
  const std::size_t pieces = trials < kFewestClusters ? (kClustersOfFewTrials + trials - 1) / trials : 1;
  std::vector<std::size_t> clusters;
  std::map<std::size_t, std::size_t> done;
  for (const trial::StaticFrame& frame : frames)
    clusters.push_back(frame.trial * kClustersOfFewTrials +
                       done[frame.trial]++ * pieces / counts[frame.trial]);
  return clusters;
}

struct Decomposition {
  VectorXd values;  ///< ascending
  MatrixXd directions;
};

/// Constants of which the trials show nothing at all are directions of their own: a solver would give any mix
/// of them.
Decomposition decompose(const MatrixXd& information) {
  const Eigen::Index count = information.rows();
  std::vector<Eigen::Index> order, shown;
  for (Eigen::Index j = 0; j < count; ++j) (information(j, j) > 0.0 ? shown : order).push_back(j);
  const auto silent = static_cast<Eigen::Index>(order.size()), rest = count - silent;
  order.insert(order.end(), shown.begin(), shown.end());
  const auto at = [&](Eigen::Index j) { return order[static_cast<std::size_t>(j)]; };
  MatrixXd part(rest, rest);
  for (Eigen::Index j = 0; j < rest; ++j) {
    for (Eigen::Index k = 0; k < rest; ++k) part(j, k) = information(at(silent + j), at(silent + k));
  }
  Decomposition result{VectorXd::Zero(count), MatrixXd::Zero(count, count)};
  for (Eigen::Index j = 0; j < silent; ++j) result.directions(at(j), j) = 1.0;
  if (rest == 0) return result;
  const math::Eigensystem eigen = math::eigensystem_of(part);
  result.values.tail(rest) = eigen.values;
  for (Eigen::Index j = 0; j < rest; ++j)
    result.directions.row(at(silent + j)).tail(rest) = eigen.vectors.row(j);
  return result;
}

/// Sums over all residuals of a fit.
struct Sums {
  std::map<std::size_t, Cluster> clusters;
  MatrixXd information;
  /// By trial, of the state of its walls at the beginning: their own, and with the constants.
  std::map<std::size_t, MatrixXd> of_start, with_start;
  MatrixXd of_motion;  ///< J^T W of what inertia and lag do, constants x 2; empty: not known
  double chi2 = 0.0, rows = 0.0, square_m2 = 0.0, coordinates = 0.0;
};

/// The state of the walls at the beginning is not known: what a trial says of it, it does not say of the
/// constants.
void give_to_starts(Sums& sums) {
  for (const auto& [trial, own] : sums.of_start) {
    const MatrixXd& shared = sums.with_start.at(trial);
    const MatrixXd with_prior = own + MatrixXd::Identity(own.rows(), own.cols());
    sums.information -= shared * math::SymmetricSolver(with_prior).solve_columns(shared.transpose());
  }
}

Sums sum_up(const JointProblem& problem, const std::vector<ResidualBlock>& blocks,
            const std::vector<std::size_t>& cluster_of, const std::vector<trial::StaticFrame>& frames,
            int constants) {
  Sums sums;
  for (const ResidualBlock& block : blocks) {
    const Vector3d r = problem.residual(block);
    const MatrixXd j = problem.jacobian(block);
    const double weight = problem.weight(block, r.squaredNorm());
    Cluster& cluster = sums.clusters[cluster_of[block.frame]];
    if (cluster.gradient.size() == 0) {
      cluster.information = MatrixXd::Zero(constants, constants);
      cluster.gradient = VectorXd::Zero(constants);
    }
    cluster.information.noalias() += weight * j.transpose() * j;
    cluster.gradient.noalias() += weight * j.transpose() * r;
    if (const MatrixXd m = problem.by_motion(block); m.cols() > 0) {
      if (sums.of_motion.size() == 0) sums.of_motion = MatrixXd::Zero(constants, m.cols());
      sums.of_motion.noalias() += weight * j.transpose() * m;
    }
    if (const MatrixXd k = problem.jacobian_by_start(block); k.cols() > 0) {
      MatrixXd& own = sums.of_start.try_emplace(frames[block.frame].trial, MatrixXd::Zero(k.cols(), k.cols()))
                          .first->second;
      own.noalias() += weight * k.transpose() * k;
      MatrixXd& shared =
          sums.with_start.try_emplace(frames[block.frame].trial, MatrixXd::Zero(constants, k.cols()))
              .first->second;
      shared.noalias() += weight * j.transpose() * k;
    }
    sums.chi2 += weight * r.squaredNorm();
    sums.rows += block.tangent ? 2.0 : 3.0;  // a tangent has no error along itself
    if (!block.tangent) {
      sums.square_m2 += problem.position_error_m(block).squaredNorm();
      sums.coordinates += 3.0;
    }
  }
  sums.information = MatrixXd::Zero(constants, constants);
  for (const auto& [trial, cluster] : sums.clusters) sums.information += cluster.information;
  give_to_starts(sums);
  if (problem.information_of_zeros().size() > 0) sums.information += problem.information_of_zeros();
  return sums;
}

/// Direction by direction the spread of few trials is uncertain: it is mixed with its mean over all.
/// @param outer spread of the trials' gradients; @param inverse of the information
MatrixXd by_spread_of_trials(const Sums& sums, const MatrixXd& outer, const MatrixXd& inverse, double base,
                             double determined) {
  const double trials = static_cast<double>(sums.clusters.size()), prior_trials = determined + 1.0;
  const MatrixXd score = (trials * outer + prior_trials * base * sums.information) / (trials + prior_trials);
  MatrixXd covariance = inverse * score * inverse;
  // Never narrower than noise alone.
  for (Eigen::Index j = 0; j < covariance.rows(); ++j) {
    if (!(covariance(j, j) > 0.0)) continue;
    const double widen = std::max(1.0, std::sqrt(inverse(j, j) / covariance(j, j)));
    covariance.row(j) *= widen;
    covariance.col(j) *= widen;
  }
  return covariance;
}

}  // namespace

Uncertainty uncertainty(const JointProblem& problem, const std::vector<trial::StaticFrame>& frames,
                        int constants) {
  const std::vector<ResidualBlock> blocks = problem.blocks();
  const Sums sums = sum_up(problem, blocks, cluster_frames(frames), frames, constants);
  Uncertainty result;
  const Decomposition eigen = decompose(sums.information);
  // Directions that the trials determine to a scale, and the others: kept apart, lest the rounding of an
  // infinite variance spoils the finite ones.
  const VectorXd lambda = eigen.values.cwiseMax(kLeastInformation);
  const MatrixXd& directions = eigen.directions;
  VectorXd inside = lambda.cwiseInverse(), outside = inside;
  for (int i = 0; i < constants; ++i) (lambda[i] > kIdentifiable ? outside : inside)[i] = 0.0;
  const MatrixXd inverse = directions * inside.asDiagonal() * directions.transpose();
  const MatrixXd undetermined = directions * outside.asDiagonal() * directions.transpose();
  const double determined = (lambda.array() > kIdentifiable).count();
  const double dof = std::max(1.0, sums.rows - determined);
  result.misfit = std::sqrt(sums.chi2 / dof);
  result.chi2 = sums.chi2;
  result.position_rms_m = sums.coordinates > 0.0 ? std::sqrt(sums.square_m2 / sums.coordinates) : 0.0;
  result.autocorrelation = autocorrelation_time(problem, blocks, frames);

  // The gradients of the trials sum to zero at the optimum; their spread shows what frames of a trial share,
  // bodies of a frame included. Without model error its mean is the information, less what the fit took.
  double spread = 1.0, taken = 0.0;
  MatrixXd outer = MatrixXd::Zero(constants, constants);
  for (const auto& [trial, cluster] : sums.clusters) {
    outer += cluster.gradient * cluster.gradient.transpose();
    const MatrixXd share = inverse * cluster.information;
    taken += (share * share).trace();
  }
  const bool by_spread =
      sums.clusters.size() >= kFewestClusters && taken < 0.8 * determined && determined > 0.0;
  if (by_spread) {
    outer *= determined / (determined - taken);
    spread = (inverse * outer).trace() / determined;
  }
  const double base = std::max({1.0, sums.chi2 / dof * result.autocorrelation, spread});
  result.covariance = base * undetermined;
  result.covariance +=
      by_spread ? by_spread_of_trials(sums, outer, inverse, base, determined) : MatrixXd(base * inverse);
  // Statics leave out inertia and lag. They are alike in all frames in motion: more of them do not average
  // them out, and no residual shows what the constants have taken up of them.
  if (sums.of_motion.size() > 0) {
    const MatrixXd taken_up = inverse * sums.of_motion;
    result.covariance += taken_up * taken_up.transpose();
  }
  for (const auto& [trial, own] : sums.of_start) {
    const MatrixXd known = own / base + MatrixXd::Identity(own.rows(), own.cols());
    result.start_sd[trial] = known.inverse().diagonal().cwiseSqrt();
  }
  result.factor = std::sqrt(base);
  result.direction_sd = (base * lambda.cwiseInverse()).cwiseSqrt();  // ascending eigenvalues: largest first
  result.directions = directions;
  return result;
}

}  // namespace softarm::identify
