// What is not known of the effects' numbers, in the frame's terms.
#include <algorithm>

#include "extended_frame.h"
#include "math/linear_algebra.h"
#include "policy.h"
#include "softarm/arm/laws.h"

namespace softarm::estimate {
namespace {

using Eigen::VectorXd;

/// Adds the difference of two predictions.
void add_difference(const arm::SegmentPrediction& to, const arm::SegmentPrediction& from,
                    arm::SegmentPrediction& p) {
  p.moment_nm += to.moment_nm - from.moment_nm;
  p.curvature_per_m += to.curvature_per_m - from.curvature_per_m;
  p.bending_stiffness_nm2 += to.bending_stiffness_nm2 - from.bending_stiffness_nm2;
  p.length_m += to.length_m - from.length_m;
  p.modulus_ratio += to.modulus_ratio - from.modulus_ratio;
  p.tendon_shear_stiffness_n += to.tendon_shear_stiffness_n - from.tendon_shear_stiffness_n;
  p.tendon_torsional_stiffness_nm2 += to.tendon_torsional_stiffness_nm2 - from.tendon_torsional_stiffness_nm2;
}

}  // namespace

void ExtendedFrame::set_laws(const std::vector<arm::SegmentPrediction>& laws) {
  if (other_drives_.empty()) return;
  std::optional<std::vector<arm::SegmentPrediction>> here;
  for (int k = 0; k < online_.size_errors(); ++k) {
    std::optional<OtherDrive>& other = other_drives_[static_cast<std::size_t>(k)];
    other.reset();
    bool differs = false;
    const model::OnlineEffects::Driven driven = online_.driven_by_error(k, differs);
    if (!differs) continue;
    other = OtherDrive{laws, driven.payload_kg};
    // The walls' memory, which is in `laws`, keeps as little of a lasting difference as of its cause.
    if (!here) here = model::predict(arm_, frame_.inputs, moment_inputs_);
    const auto there = model::predict(arm_, driven.inputs, driven.moment_inputs);
    for (std::size_t i = 0; here && there && i < laws.size(); ++i)
      add_difference((*there)[i], (*here)[i], other->laws[i]);
  }
}

Eigen::MatrixXd ExtendedFrame::laws_by_errors(const std::vector<arm::SegmentPrediction>& laws,
                                              const std::vector<double>& reference_stiffness) const {
  const VectorXd here = x_by_laws(arm_, laws, reference_stiffness);
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(here.size(), online_.size_errors());
  for (int k = 0; k < online_.size_errors(); ++k) {
    const std::optional<OtherDrive>& other = other_drives_[static_cast<std::size_t>(k)];
    if (other)
      by.col(k) = online_.error_scale(k) * (x_by_laws(arm_, other->laws, reference_stiffness) - here);
  }
  return by;
}

void ExtendedFrame::look_at_errors(const Problem& problem, const VectorXd& x,
                                   const std::vector<arm::SegmentPrediction>& laws) {
  errors_x_ = x;
  for (int k = 0; k < online_.size_errors(); ++k) {
    const std::optional<OtherDrive>& other = other_drives_[static_cast<std::size_t>(k)];
    VectorXd y = x;
    // What is not fitted follows from what drives the arm.
    if (other) {
      const VectorXd by_laws = x_by_laws(arm_, other->laws, problem.reference_stiffnesses());
      for (int i = 0; i < static_cast<int>(laws.size()); ++i) {
        const int c = Problem::column(i, 2);
        if (!problem.free()[static_cast<std::size_t>(c)]) y[c] = by_laws[c];
      }
      const int payload = problem.payload_column();
      if (other->payload_kg && !problem.free()[static_cast<std::size_t>(payload)])
        y[payload] = *other->payload_kg / Problem::kPayloadUnit;
    }
    const auto moved = online_.moved_by_error(k, segments_at(problem, y, other ? other->laws : laws),
                                              Problem::kPayloadUnit * y[problem.payload_column()]);
    // Without an equilibrium there, what it did when the arm last had one is the best that is known.
    if (!moved) continue;
    for (std::size_t b = 0; b < at_.bodies.size(); ++b) {
      at_.bodies[b].p_by_error.col(k) = moved->p.col(static_cast<Eigen::Index>(b));
      at_.bodies[b].tangent_by_error.col(k) = moved->tangent.col(static_cast<Eigen::Index>(b));
    }
    solved_x_.reset();
  }
}

void ExtendedFrame::split_errors(const Problem& problem) {
  // By least squares; a change of x beyond what the line is good for is none.
  const Eigen::Index n = problem.NumParameters();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd weighted = Eigen::MatrixXd::Zero(n, errors());
  Eigen::Matrix3Xd j(3, n);
  const auto with_effects = [&](const Eigen::Matrix3Xd& by_x) {
    for (Eigen::Index k = 0; k < n; ++k) {
      if (problem.free()[static_cast<std::size_t>(k)]) j.col(k) += by_x.col(k);
    }
  };
  const auto& seen = problem.observations();
  const bool tangents =
      std::any_of(seen.begin(), seen.end(), [](const Observation& o) { return o.tangent.has_value(); });
  const auto each = [&](const auto& do_with) {
    for (int b = 0; b < static_cast<int>(at_.bodies.size()); ++b) {
      EffectsAt::OnBody& body = at_.bodies[static_cast<std::size_t>(b)];
      Observation o;
      o.body = b;
      problem.position_jacobian_by_laws(o, j);
      with_effects(body.p_by_x);
      do_with(body.p_by_error, problem.position_sd(o), body.p_beyond_x);
      if (!tangents) continue;
      problem.tangent_jacobian_by_laws(o, j);
      with_effects(body.tangent_by_x);
      do_with(body.tangent_by_error, problem.tangent_sd(o), body.tangent_beyond_x);
    }
  };
  each([&](const Eigen::Matrix3Xd& by_error, double sd, Eigen::Matrix3Xd&) {
    information += j.transpose() * j / (sd * sd);
    weighted += j.transpose() * by_error / (sd * sd);
  });
  information.diagonal() += reach(problem).cwiseAbs2().cwiseInverse();
  at_.errors_as_x = math::SymmetricSolver(information).solve_columns(weighted);
  each([&](const Eigen::Matrix3Xd& by_error, double, Eigen::Matrix3Xd& beyond) {
    beyond = by_error - j * at_.errors_as_x;
  });
}

bool ExtendedFrame::renew_errors(Problem& problem, const VectorXd& x,
                                 const std::vector<arm::SegmentPrediction>& laws) {
  if (errors() == 0) return false;
  const VectorXd y = within_range(problem, x);
  const double way = ((y - errors_x_).array() / reach(problem).array()).matrix().lpNorm<Eigen::Infinity>();
  if (way < kPolicy.effects.errors_hold || !problem.evaluate(y) || !solve(problem, y, laws)) {
    problem.evaluate(x);
    return false;
  }
  look_at_errors(problem, y, laws);
  split_errors(problem);
  return problem.evaluate(x);
}

}  // namespace softarm::estimate
