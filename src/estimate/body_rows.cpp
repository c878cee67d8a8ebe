#include "body_rows.h"

#include <cmath>

namespace softarm::estimate {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Index offsets_of_body(const arm::EstimatorOptions& options) {
  return options.method == arm::Method::kEndOrientation ? 5 : 3;
}

double BodyRows::distance(Index block, const VectorXd& d) const {
  const Index row = 3 * block;
  const Eigen::Vector3d off = model.segment<3>(row) + j.middleRows<3>(row) * d - measured.segment<3>(row);
  return off.norm() * std::sqrt(weight[block]);
}

Evidence BodyRows::evidence(const VectorXd& of_measured, const VectorXd& weights) const {
  // Most probable where J (x, b) = measured - model + J x_0.
  const VectorXd target = of_measured - model + j.leftCols(x.size()) * x;
  const MatrixXd weighted = weights.asDiagonal() * j;
  return {j.transpose() * weighted, weighted.transpose() * target};
}

Evidence BodyRows::evidence() const {
  VectorXd weights(3 * blocks());
  for (Index block = 0; block < blocks(); ++block) weights.segment<3>(3 * block).setConstant(weight[block]);
  return evidence(measured, weights);
}

BodyRows body_rows(const Problem& problem, const VectorXd& x, const WhiteNoise& noise, Index offsets,
                   Index bodies, Index errors) {
  const Index n = problem.NumParameters(), per_body = offsets > 3 ? 2 : 1, blocks = per_body * bodies;
  const Index motion = n + offsets * bodies;
  const EffectsAt* const effects = problem.effects();
  const Index of_effects = effects == nullptr ? 0 : effects->errors.size();
  BodyRows rows{x, VectorXd::Zero(3 * blocks), VectorXd::Zero(3 * blocks),
                MatrixXd::Zero(3 * blocks, n + errors), VectorXd::Zero(blocks)};
  Eigen::Matrix3Xd by_x(3, n);
  for (const Observation& o : problem.observations()) {
    if (!o.used) continue;
    const Eigen::Matrix3d section = problem.solver().station(o.body).q.toRotationMatrix();
    const Index column = n + offsets * o.body, block = per_body * o.body;
    problem.position_jacobian(o, by_x);
    // As the effects are by their file: their errors are in b.
    rows.model.segment<3>(3 * block) = problem.position(o);
    if (of_effects > 0)
      rows.model.segment<3>(3 * block) -=
          effects->bodies[static_cast<std::size_t>(o.body)].p_by_error * effects->errors;
    rows.measured.segment<3>(3 * block) = o.p;
    rows.j.block(3 * block, 0, 3, n) = by_x;
    rows.j.block<3, 3>(3 * block, column) = section;
    rows.j.block<3, kMotions>(3 * block, motion) = problem.position_by_gravity(o);
    rows.weight[block] = 1.0 / noise.position_variance(o.body);
    if (of_effects > 0)
      rows.j.block(3 * block, n + errors - of_effects, 3, of_effects) =
          by_x * effects->errors_as_x + effects->bodies[static_cast<std::size_t>(o.body)].p_beyond_x;
    if (!o.tangent || per_body == 1) continue;
    problem.tangent_jacobian(o, by_x);
    rows.model.segment<3>(3 * block + 3) = problem.tangent(o);
    if (of_effects > 0)
      rows.model.segment<3>(3 * block + 3) -=
          effects->bodies[static_cast<std::size_t>(o.body)].tangent_by_error * effects->errors;
    rows.measured.segment<3>(3 * block + 3) = *o.tangent;
    rows.j.block(3 * block + 3, 0, 3, n) = by_x;
    rows.j.block<3, 1>(3 * block + 3, column + 3) = -section.col(1);
    rows.j.block<3, 1>(3 * block + 3, column + 4) = section.col(0);
    rows.j.block<3, kMotions>(3 * block + 3, motion) = problem.tangent_by_gravity(o);
    rows.weight[block + 1] = 1.0 / noise.tangent_variance(o.body);
    if (of_effects > 0)
      rows.j.block(3 * block + 3, n + errors - of_effects, 3, of_effects) =
          by_x * effects->errors_as_x + effects->bodies[static_cast<std::size_t>(o.body)].tangent_beyond_x;
  }
  return rows;
}

}  // namespace softarm::estimate
