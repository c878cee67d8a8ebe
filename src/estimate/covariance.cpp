#include "covariance.h"

#include <cmath>
#include <tuple>
#include <utility>

#include "math/linear_algebra.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Directions with less than this share of the information come from rounding errors only.
constexpr double kLeastInformation = 1e-14;
// Share of a shape parameter's information that must not be some other shape parameter's.
constexpr double kLeastShapeInformation = 1e-9;

/// Weight of a block's information in the estimating equations, and of its variance.
struct BlockWeight {
  double information;
  double variance;
};

/// @param weight by which the block is multiplied in the fit, @param sd of its true error
BlockWeight block_weight(bool sum_of_distances, double weight, double sd, int dimension) {
  if (!sum_of_distances) return {weight * weight, std::pow(weight * weight * sd, 2)};
  // The gradient of a distance is a unit vector: E[I - r r'] / |r| and E[r r'] of an isotropic normal error.
  const double mean_inverse = dimension == 3 ? std::sqrt(2.0 / M_PI) / sd : std::sqrt(M_PI / 2.0) / sd;
  return {weight * (dimension - 1.0) / dimension * mean_inverse, weight * weight / dimension};
}

/// Whether curvature and length of every segment follow from the bodies, were stiffness and payload known: an
/// arm at rest says nothing of those, and still has a shape.
bool determines_shape(const MatrixXd& information, const std::vector<bool>& free) {
  std::vector<int> columns;
  for (int i = 0; i + 1 < static_cast<int>(free.size()); ++i) {
    if (free[static_cast<std::size_t>(i)] && i % kSegmentParameters != 2) columns.push_back(i);
  }
  const int n = static_cast<int>(columns.size());
  MatrixXd a(n, n);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      const double scale =
          std::sqrt(information(columns[i], columns[i]) * information(columns[k], columns[k]));
      if (!(scale > 0.0)) return false;
      a(i, k) = information(columns[i], columns[k]) / scale;
    }
  }
  return math::SymmetricSolver(a).least_pivot() > kLeastShapeInformation;
}

/// Of the parameters at the last evaluation: what the estimator takes for the information in the
/// measurements, and the variance of its gradient. They are the same where the weights are those of the
/// noise.
struct Sandwich {
  MatrixXd information, variance;
};

Sandwich sandwich(const Problem& problem, const std::vector<bool>& free, bool sum) {
  const int count = problem.NumParameters();
  Sandwich result{MatrixXd::Zero(count, count), MatrixXd::Zero(count, count)};
  MatrixXd &information = result.information, &variance = result.variance;
  // Of the gradient, by errors that all bodies have in common, some with what is believed.
  const Eigen::Index errors = problem.errors();
  MatrixXd by_errors = MatrixXd::Zero(count, errors);
  Eigen::Matrix3Xd j(3, count);
  for (const Observation& o : problem.observations()) {
    if (!o.used) continue;
    problem.position_jacobian(o, j);
    const BlockWeight w = block_weight(sum, problem.position_weight(o), problem.position_sd(o), 3);
    const MatrixXd jj = j.transpose() * j;
    information += w.information * jj;
    variance += w.variance * jj;
    if (errors > 0) by_errors -= w.information * j.transpose() * problem.position_by_errors(o, j);
    if (o.tangent) {
      problem.tangent_jacobian(o, j);
      const MatrixXd tt = j.transpose() * j;
      const BlockWeight a = block_weight(sum, problem.tangent_weight(o), problem.tangent_sd(o), 2);
      information += a.information * tt;
      variance += a.variance * tt;
      if (errors > 0) by_errors -= a.information * j.transpose() * problem.tangent_by_errors(o, j);
    }
  }
  if (!problem.belief()) {
    variance += by_errors * by_errors.transpose();
    return result;
  }
  // What is believed already counts those errors as its own.
  const Belief& belief = *problem.belief();
  MatrixXd by_belief = MatrixXd::Zero(count, errors);
  if (const auto k = belief.by_effects.cols(); k > 0)
    by_belief.leftCols(k) = belief.information * belief.by_effects;
  MatrixXd together = by_errors + by_belief;
  for (int i = 0; i < count; ++i) {
    if (free[static_cast<std::size_t>(i)]) continue;
    by_belief.row(i).setZero();
    together.row(i).setZero();
  }
  variance += together * together.transpose() - by_belief * by_belief.transpose();
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < count; ++k) {
      if (!free[static_cast<std::size_t>(i)] || !free[static_cast<std::size_t>(k)]) continue;
      information(i, k) += problem.belief()->information(i, k);
      variance(i, k) += problem.belief()->information(i, k);
    }
  }
  return result;
}

/// Inverse of an information of unit diagonal without the directions that it does not determine.
struct Inverse {
  MatrixXd inverse;
  VectorXd lost;  ///< share of each parameter that lies in those directions
};

Inverse determined_inverse(const MatrixXd& scaled) {
  const math::Eigensystem eigen = math::eigensystem_of(scaled);
  const Eigen::Index n = scaled.rows();
  VectorXd inverse(n);
  VectorXd lost = VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const bool determined = eigen.values[k] > kLeastInformation * eigen.values[n - 1];
    inverse[k] = determined ? 1.0 / eigen.values[k] : 0.0;
    if (!determined) lost += eigen.vectors.col(k).cwiseAbs2();
  }
  return {eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose(), lost};
}

}  // namespace

Covariance covariance(const Problem& problem, const std::vector<bool>& free,
                      const arm::EstimatorOptions& options) {
  const bool sum = options.objective == arm::Objective::kSumOfDistances;
  const auto [information, variance] = sandwich(problem, free, sum);
  const bool best = !sum && problem.noise_weights() && problem.errors() == 0;
  return covariance_from(information, free, best ? nullptr : &variance);
}

Covariance covariance_from(const MatrixXd& information, const std::vector<bool>& free,
                           const MatrixXd* variance) {
  const auto count = static_cast<int>(information.rows());
  Covariance result;
  result.x = MatrixXd::Zero(count, count);
  result.determined.assign(static_cast<std::size_t>(count), false);
  std::vector<int> columns;
  for (int i = 0; i < count; ++i) {
    if (free[static_cast<std::size_t>(i)] && information(i, i) > 0.0) columns.push_back(i);
  }
  const int n = static_cast<int>(columns.size());
  VectorXd scale(n);
  for (int i = 0; i < n; ++i) scale[i] = 1.0 / std::sqrt(information(columns[i], columns[i]));
  const auto scaled_part = [&](const MatrixXd& of) {
    MatrixXd part(n, n);
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < n; ++k) part(i, k) = scale[i] * scale[k] * of(columns[i], columns[k]);
    }
    return part;
  };
  const auto [inverse, lost] = determined_inverse(scaled_part(information));
  const MatrixXd scaled =
      variance == nullptr ? inverse : MatrixXd(inverse * scaled_part(*variance) * inverse);
  const auto determined = [&](int i) { return result.determined[static_cast<std::size_t>(columns[i])]; };
  for (int i = 0; i < n; ++i) {
    const double sd = scale[i] * std::sqrt(std::max(0.0, scaled(i, i)));
    const double absurd = columns[i] == count - 1
                              ? kPolicy.determined.absurd_payload_sd
                              : kPolicy.determined.absurd_sd[columns[i] % kSegmentParameters];
    determined(i) = lost[i] < kPolicy.determined.lost_share && sd < absurd;
  }
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      if (determined(i) && determined(k))
        result.x(columns[i], columns[k]) = scale[i] * scale[k] * scaled(i, k);
    }
  }
  result.shape_determined = determines_shape(information, free);
  return result;
}

Evidence evidence(const Problem& problem, const VectorXd& x) {
  const int count = problem.NumParameters();
  Evidence result{MatrixXd::Zero(count, count), VectorXd::Zero(count)};
  Eigen::Matrix3Xd j(3, count);
  const auto add = [&](const Eigen::Vector3d& e, double sd) {
    const double weight = problem.bounded_influence(e.norm() / sd) / (sd * sd);
    result.information.noalias() += weight * j.transpose() * j;
    result.weighted.noalias() -= weight * j.transpose() * e;
  };
  for (const Observation& o : problem.observations()) {
    if (!o.used) continue;
    problem.position_jacobian(o, j);
    add(problem.position(o) - o.p, problem.position_sd(o));
    if (!o.tangent) continue;
    problem.tangent_jacobian(o, j);
    add(problem.tangent(o) - *o.tangent, problem.tangent_sd(o));
  }
  result.weighted += result.information * x;
  return result;
}

double by_common_errors(const Problem& problem) {
  const Eigen::Index errors = problem.errors();
  if (errors == 0) return 0.0;
  MatrixXd information = MatrixXd::Identity(errors, errors);
  VectorXd weighted = VectorXd::Zero(errors);
  Eigen::Matrix3Xd j(3, problem.NumParameters());
  const auto add = [&](const Eigen::Matrix3Xd& by, const Eigen::Vector3d& off, double sd) {
    information.noalias() += by.transpose() * by / (sd * sd);
    weighted.noalias() += by.transpose() * off / (sd * sd);
  };
  for (const Observation& o : problem.observations()) {
    if (!o.used) continue;
    problem.position_jacobian(o, j);
    add(problem.position_by_errors(o, j), o.p - problem.position(o), problem.position_sd(o));
    if (!o.tangent) continue;
    problem.tangent_jacobian(o, j);
    add(problem.tangent_by_errors(o, j), *o.tangent - problem.tangent(o), problem.tangent_sd(o));
  }
  return weighted.dot(math::solve_symmetric(information, weighted));
}

double determined_by_bodies(const Problem& problem, const VectorXd& x) {
  const MatrixXd h = evidence(problem, x).information;
  MatrixXd all = h;
  if (problem.belief()) all += problem.belief()->information;
  VectorXd scale(h.rows());
  for (Eigen::Index i = 0; i < h.rows(); ++i) scale[i] = h(i, i) > 0.0 ? 1.0 / std::sqrt(all(i, i)) : 0.0;
  MatrixXd scaled = scale.asDiagonal() * all * scale.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  for (Eigen::Index i = 0; i < h.rows(); ++i) {
    if (scale[i] == 0.0) scaled(i, i) = 1.0;
  }
  return math::SymmetricSolver(scaled).solve_columns(scale.asDiagonal() * h * scale.asDiagonal()).trace();
}

namespace {

/// A segment's parameters in the estimate's terms.
struct Bend {
  double rest_m, reference_nm2;
  double curvature_per_m, cos_phi, sin_phi;
  double flexibility;  ///< c of EI = EI_base / c
};

Bend bend_of(const Problem& problem, int segment, const VectorXd& x) {
  const int ia = Problem::column(segment, 0), ib = ia + 1, ic = ia + 2;
  const double rest = problem.rest_length(segment);
  const double a = x[ia] / rest, b = x[ib] / rest;
  const double bend = std::hypot(a, b);
  return {rest,
          problem.reference_stiffness(segment),
          bend,
          bend > 0.0 ? a / bend : 1.0,
          bend > 0.0 ? b / bend : 0.0,
          x[ic]};
}

/// By how much farther up EI = EI_base / c is than along its tangent, where c is less by a standard
/// deviation. By the tangent alone an EI that comes out too low has too small a standard deviation as well.
/// @param relative_sd of c
double upwards(double relative_sd) {
  return 1.0 / (1.0 - std::min(relative_sd, kPolicy.determined.farthest_softer));
}

/// The relative standard deviation of c at which that of EI is the limit.
double relative_sd_of_flexibility(double limit) {
  return limit / std::min(1.0 + limit, 1.0 / (1.0 - kPolicy.determined.farthest_softer));
}

/// Rows: M0, phi, EI, L; columns: a, b, c, l. With the uncorrected values: the intervals they give cover what
/// they should.
/// @param arcs the method knows neither moment nor stiffness
/// @param relative_sd of c
Eigen::Matrix4d derivatives(const Bend& bend, bool arcs, double relative_sd) {
  Eigen::Matrix4d g = Eigen::Matrix4d::Zero();
  if (!arcs) {
    const double fitted = bend.reference_nm2 / bend.flexibility * upwards(relative_sd);
    g(0, 0) = bend.cos_phi * fitted / bend.rest_m;
    g(0, 1) = bend.sin_phi * fitted / bend.rest_m;
    g(0, 2) = -bend.curvature_per_m * fitted / bend.flexibility;
    g(2, 2) = -fitted / bend.flexibility;
  }
  if (bend.curvature_per_m > 0.0) {
    g(1, 0) = -bend.sin_phi / (bend.curvature_per_m * bend.rest_m);
    g(1, 1) = bend.cos_phi / (bend.curvature_per_m * bend.rest_m);
  }
  g(3, 3) = bend.rest_m;
  return g;
}

/// Stiffness and moment. The fit is nearly linear in the flexibility c, whose errors are therefore normal;
/// those of EI = EI_base / c are not. To second order E[1/c] is too large by var(c) / c^3, and E[k/c] by that
/// and cov(k, c): both are taken out, in a form that stays bounded in the tails.
/// @param c covariance of a, b, c, l
/// @param with_curvature a and b are determined
std::pair<double, double> without_bias(const Bend& bend, const Eigen::Matrix4d& c, bool with_curvature) {
  const double x = bend.flexibility;
  const double variance = std::min(c(2, 2), x * x);
  const double with_bend =
      with_curvature ? (bend.cos_phi * c(0, 2) + bend.sin_phi * c(1, 2)) / bend.rest_m : 0.0;
  const double shrink = x / (x * x + variance);
  return {bend.reference_nm2 * shrink,
          std::max(0.0, bend.reference_nm2 * (bend.curvature_per_m + with_bend / x) * shrink)};
}

/// Rows and columns of what has no standard deviation are zero.
void clear_undetermined(SegmentEstimate& out) {
  const bool has[4] = {out.sd_moment_nm.has_value(), out.sd_direction_rad.has_value(),
                       out.sd_bending_stiffness_nm2.has_value(), out.sd_length_m.has_value()};
  for (int i = 0; i < 4; ++i) {
    if (has[i]) continue;
    out.covariance.row(i).setZero();
    out.covariance.col(i).setZero();
  }
}

}  // namespace

void fill_segment(const Problem& problem, int segment, const VectorXd& x, const Spread& spread,
                  const std::vector<bool>& free, double believed_information,
                  const arm::EstimatorOptions& options, SegmentEstimate& out) {
  const int ia = Problem::column(segment, 0), ib = ia + 1, ic = ia + 2, il = ia + 3;
  const Covariance& covariance = spread.covariance;
  const auto determined = [&](int i) { return covariance.determined[static_cast<std::size_t>(i)]; };
  const bool arcs = options.method == arm::Method::kCcPoints || options.method == arm::Method::kCcEndpoint;
  const bool flexibility_known = !free[static_cast<std::size_t>(ic)];
  const bool curvature_determined = determined(ia) && determined(ib);
  const Bend bend = bend_of(problem, segment, x);
  const Eigen::Matrix4d c = covariance.x.block<4, 4>(ia, ia);

  out.length_m = x[il] * bend.rest_m;
  out.actuation_curvature_per_m = bend.curvature_per_m;
  out.direction_rad = std::atan2(x[ib] / bend.rest_m, x[ia] / bend.rest_m);
  double ei = bend.reference_nm2 / bend.flexibility;
  double moment = bend.curvature_per_m * ei;
  if (!flexibility_known && determined(ic))
    std::tie(ei, moment) = without_bias(bend, spread.scatter.block<4, 4>(ia, ia), curvature_determined);
  if (!arcs) {
    out.bending_stiffness_nm2 = ei;
    out.moment_nm = moment;
  }

  const double relative_sd = std::sqrt(std::max(0.0, c(2, 2))) / std::abs(bend.flexibility);
  const Eigen::Matrix4d g = derivatives(bend, arcs, relative_sd);
  out.covariance = g * c * g.transpose();
  const auto sd = [&](int i) { return std::sqrt(std::max(0.0, out.covariance(i, i))); };
  if (curvature_determined) {
    const Eigen::Vector2d along(bend.cos_phi, bend.sin_phi);
    out.sd_actuation_curvature_per_m =
        std::sqrt(std::max(0.0, along.dot(c.topLeftCorner<2, 2>() * along))) / bend.rest_m;
    // A direction is not determined by less than a uniform guess would know.
    if (bend.curvature_per_m > 0.0 && sd(1) < M_PI / std::sqrt(3.0)) out.sd_direction_rad = sd(1);
    if (!arcs && (flexibility_known || determined(ic))) out.sd_moment_nm = sd(0);
  }
  if (!arcs && !flexibility_known && determined(ic)) out.sd_bending_stiffness_nm2 = sd(2);
  if (determined(il)) out.sd_length_m = sd(3);
  clear_undetermined(out);
  const double limit = options.identifiable_relative_sd;
  const double limit_of_flexibility = relative_sd_of_flexibility(limit) * bend.flexibility;
  // Relative to what the fit found, before the correction: that never makes a frame identify more.
  out.stiffness_why_not = WhyNot::kNotDetermined;
  if (out.sd_bending_stiffness_nm2 && std::sqrt(c(2, 2)) <= limit_of_flexibility) {
    // What the laws know is not told by the frame: without it the interval must be as narrow.
    const double by_bodies = 1.0 / c(2, 2) - believed_information;
    const double asked = 1.0 / std::pow(limit_of_flexibility, 2);
    out.stiffness_why_not = by_bodies >= asked ? WhyNot::kIdentifiable : WhyNot::kByLawsAlone;
  }
  out.identifiable_stiffness = out.sd_bending_stiffness_nm2 && out.stiffness_why_not == WhyNot::kIdentifiable;
  out.identifiable_moment = out.sd_moment_nm && *out.sd_moment_nm <= limit * moment;
}

}  // namespace softarm::estimate
