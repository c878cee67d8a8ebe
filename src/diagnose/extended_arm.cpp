#include "extended_arm.h"

#include <algorithm>
#include <cmath>

#include "softarm/effects/arm_effects.h"

namespace softarm::diagnose {
namespace {

constexpr double kSameLag = 0.01;  // relative: what the fit's own steps leave

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
  for (const model::Present& present : model.known()) extended.effects.push_back(effects::entry_of(present));
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
  return extended;
}

}  // namespace softarm::diagnose
