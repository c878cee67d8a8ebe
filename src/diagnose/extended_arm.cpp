#include "extended_arm.h"

#include <algorithm>
#include <cmath>

#include "math/linear_algebra.h"
#include "softarm/effects/arm_effects.h"
#include "stated_correlations.h"

namespace softarm::diagnose {
namespace {

constexpr double kSameLag = 0.01;  // relative: what the fit's own steps leave

/// Puts the correlations of the fit's numbers into its effects' entries, which begin at `first`.
void correlate_numbers(const Linearised& fit, const Eigen::MatrixXd& covariance, std::size_t first,
                       std::vector<arm::EffectEntry>& entries) {
  std::vector<Eigen::Index> columns;
  for (std::size_t j = 0; j < fit.columns.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    if (fit.columns[j].kind == JointUnknown::Kind::kEffect && covariance(i, i) > 0.0) columns.push_back(i);
  }
  if (columns.size() < 2) return;
  const Eigen::MatrixXd block = math::block_of(covariance, columns);
  const Eigen::VectorXd over_sd = block.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd stated = stated_correlations(over_sd.asDiagonal() * block * over_sd.asDiagonal());
  const auto at = [&](std::size_t k) -> const JointUnknown& {
    return fit.columns[static_cast<std::size_t>(columns[k])];
  };
  const auto entry_of = [&](const JointUnknown& of) { return first + static_cast<std::size_t>(of.index); };
  // An entry has all parameters of its effect.
  const auto number_of = [&](const JointUnknown& of) -> arm::EffectNumber& {
    return entries[entry_of(of)].numbers[static_cast<std::size_t>(of.parameter)];
  };
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t j = i + 1; j < columns.size(); ++j) {
      const double value = stated(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      if (value != 0.0)
        number_of(at(i)).correlations.push_back({entry_of(at(j)), number_of(at(j)).name, value});
    }
  }
}

}  // namespace

ExtendedArm extended_arm(const JointModel& model, const Linearised& fit, const Eigen::MatrixXd& covariance) {
  ExtendedArm extended;
  extended.arm = model.arm();
  const auto& constants = model.constants();
  // Lengths carry bodies and weight along: as the joint model has them, which keeps those where they are
  // along the arm.
  for (std::size_t j = 0; j < constants.size(); ++j)
    identify::set_value(extended.arm, constants[j], fit.at.constants[static_cast<Eigen::Index>(j)]);
  const double lag_s = fit.at.viscoelastic_lag_s;
  for (arm::Segment& segment : extended.arm.segments) {
    const double given_s = segment.wall.lag_s.value_or(arm::Wall::kUsualLag_s);
    if (segment.wall.lag_s || std::abs(lag_s - given_s) > kSameLag * std::max(lag_s, given_s))
      segment.wall.lag_s = lag_s;
  }
  extended.effects = effects::entries_of(model.known());
  for (std::size_t e = 0; e < fit.at.effects.size(); ++e) {
    const model::Present& present = fit.at.effects[e];
    model::Values sd = model::Values::Zero(present.values.size());
    for (std::size_t j = 0; j < fit.columns.size(); ++j) {
      const JointUnknown& column = fit.columns[j];
      const auto i = static_cast<Eigen::Index>(j);
      if (column.kind == JointUnknown::Kind::kEffect && column.index == static_cast<int>(e))
        sd[column.parameter] = column.scale * std::sqrt(std::max(0.0, covariance(i, i)));
    }
    extended.effects.push_back(effects::entry_of(present, sd));
  }
  correlate_numbers(fit, covariance, model.known().size(), extended.effects);
  return extended;
}

}  // namespace softarm::diagnose
