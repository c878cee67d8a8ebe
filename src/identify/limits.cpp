#include "limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace softarm::identify {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kAtBound = 1e-6;  // share of the scale
// Chi-square, by the misfit that is left, that a stiffness at its limit must gain to stay there.
constexpr double kGainAtLimit = 9.0;
constexpr double kLeastAxial_rel = 0.02, kMostAxial_rel = 1.0;  // sd of EA in the prior

bool is_at_bound(const FreeConstant& c, double value) {
  const double margin = kAtBound * c.scale;
  return value <= c.range.low + margin || value >= c.range.high - margin;
}

bool is_modulus(ConstantKind kind) {
  const ConstantRole role = role_of(kind);
  return role == ConstantRole::kBendingStiffness || role == ConstantRole::kAxialStiffness;
}

std::string why_not(const Constant& c) {
  return c.at_bound ? c.name + " ran into its limit" : "the trials do not determine " + c.name;
}

}  // namespace

Solution solve(JointProblem& problem, const std::vector<FreeConstant>& constants,
               const std::vector<trial::StaticFrame>& frames, double determined_sd,
               const std::function<void(int)>& progress) {
  const auto count = constants.size();
  const auto solve_once = [&](JointProblem& p) {
    Solution s{p.solve(progress), {}, std::vector<std::optional<double>>(count), std::vector<bool>(count)};
    p.predict_motion();
    s.sure = uncertainty(p, frames, static_cast<int>(count));
    for (std::size_t j = 0; j < count; ++j) {
      const double value = s.fit.theta[static_cast<Eigen::Index>(j)];
      if (is_at_bound(constants[j], value)) s.ran_to[j] = value;
    }
    return s;
  };
  Solution best = solve_once(problem);
  // At a limit, or anywhere that noise and the model's errors took it to.
  const auto runs_away = [&](const Solution& s, std::size_t j) {
    const FreeConstant& c = constants[j];
    const auto at = static_cast<Eigen::Index>(j);
    const double sd = c.scale * std::sqrt(s.sure.covariance(at, at));
    return is_modulus(c.ref.kind) && !is_at_bound(c, c.initial) &&
           (s.ran_to[j] || sd > determined_sd * std::abs(s.fit.theta[at]));
  };
  std::vector<bool> tried(count, false);
  while (true) {
    std::size_t j = 0;
    while (j < count && (tried[j] || !runs_away(best, j))) ++j;
    if (j == count) return best;
    tried[j] = true;
    problem.keep(static_cast<int>(j), true);
    Solution other = solve_once(problem);
    const double gain = (other.sure.chi2 - best.sure.chi2) / (best.sure.factor * best.sure.factor);
    // Nor is another constant to run away in its place.
    bool elsewhere = false;
    for (std::size_t k = 0; k < count; ++k) elsewhere = elsewhere || (other.ran_to[k] && !best.ran_to[k]);
    if (gain < kGainAtLimit && !elsewhere) {
      other.kept = best.kept;
      other.kept[j] = true;
      for (std::size_t k = 0; k < count; ++k) {
        if (other.kept[k]) other.ran_to[k] = best.ran_to[k];
      }
      best = std::move(other);
    } else {
      problem.keep(static_cast<int>(j), false);
      const Solution again = solve_once(problem);
      best.fit = again.fit;
      best.sure = again.sure;
    }
  }
}

MatrixXd covariance_given_moduli(const Result& result) {
  MatrixXd c = result.covariance;
  for (std::size_t k = 0; k < result.constants.size(); ++k) {
    const auto j = static_cast<Eigen::Index>(k);
    const Constant& constant = result.constants[k];
    const bool given = constant.at_bound || constant.ref.kind == ConstantKind::kAxialStiffness ||
                       (is_modulus(constant.ref.kind) && !constant.determined);
    if (!given || !(c(j, j) > 0.0)) continue;
    const VectorXd column = c.col(j);
    c -= column * column.transpose() / column[j];
    c.row(j).setZero();
    c.col(j).setZero();
  }
  return c;
}

void prior_of_moduli(const arm::Arm& arm, Result& result) {
  const arm::LawPrior& before = arm.estimator.prior;
  std::optional<double> stretch;  // the worst of the segments
  std::vector<bool> determined(arm.segments.size(), false);
  const auto note = [&](const char* what, double sd_rel, const std::string& why) {
    result.prior_notes.push_back(
        fmt::format("{} {:g} % as in the arm file, because {}", what, 100.0 * sd_rel, why));
  };
  bool stiffness_noted = false, stiffness_fitted = false;
  for (const Constant& c : result.constants) {
    if (c.ref.kind == ConstantKind::kAxialStiffness) {
      if (c.at_bound || c.kept) {
        note("EA", before.axial_stiffness_sd_rel, why_not(c));
        continue;
      }
      determined[static_cast<std::size_t>(c.ref.segment)] = true;
      for (const int other : c.ref.tied) determined[static_cast<std::size_t>(other)] = true;
      const double sd_rel = std::clamp(c.sd / std::abs(c.value), kLeastAxial_rel, kMostAxial_rel);
      stretch = std::max(stretch.value_or(0.0), sd_rel);
      continue;
    }
    stiffness_fitted = stiffness_fitted || arm::role_of(c.ref.kind) == arm::ConstantRole::kBendingStiffness;
    if (is_modulus(c.ref.kind) && (c.at_bound || c.kept) && !stiffness_noted) {
      stiffness_noted = true;
      result.prior.bending_stiffness_sd_rel = before.bending_stiffness_sd_rel;
      note("EI", before.bending_stiffness_sd_rel, why_not(c));
    }
  }
  // Without load only gain over EI shows: that a fit follows the bodies says nothing of an EI that it was
  // given.
  if (!stiffness_fitted && result.prior.bending_stiffness_sd_rel < before.bending_stiffness_sd_rel) {
    result.prior.bending_stiffness_sd_rel = before.bending_stiffness_sd_rel;
    note("EI", before.bending_stiffness_sd_rel, "it was not fitted");
  }
  for (std::size_t i = 0; i < arm.segments.size(); ++i) {
    if (arm.segments[i].axial_stiffness_n && !determined[i])
      stretch = std::max(stretch.value_or(0.0), before.axial_stiffness_sd_rel);
  }
  result.prior.axial_stiffness_sd_rel = stretch.value_or(before.axial_stiffness_sd_rel);
}

}  // namespace softarm::identify
