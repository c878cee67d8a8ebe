// What one effect of a fit does to the bodies, and where.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "joint_model.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// By which an effect of the model moves what is seen, to first order: by trial, m, in the order of the rows.
/// Of a force that holds a place it is in proportion alone, block by block: as if the place were held as well
/// without it.
std::vector<Eigen::VectorXd> contribution(JointModel& model, const Linearised& at, std::size_t effect);

/// Its axis, its place, what it goes with and when.
Where where_is(const JointModel& model, const Linearised& at, const model::Present& effect,
               const std::vector<Eigen::VectorXd>& contribution);
/// The same of residuals that no effect explains.
Where where_is(const JointModel& model, const Linearised& at, const std::vector<Eigen::VectorXd>& residual);

/// A vector of the base frame in the section's frame of the body of a block: in the plane in which the arm is
/// bent, across it, along the arm.
Eigen::Vector3d in_section(const model::Predicted& predicted, double s_m, const Eigen::Vector3d& v_base);

}  // namespace softarm::diagnose
