// What the identified laws still get wrong, as the prior of the estimator.
#pragma once

#include <Eigen/Core>

#include "joint_fit.h"
#include "softarm/arm/arm.h"

namespace softarm::identify {

/// Splits the residuals of all frames, by linearisation, into deviations of each segment's moment, EI and
/// length that last over a trial and such that change from frame to frame (variance components by expectation
/// maximisation, beside the stated noise of the bodies), and adds what the constants' own uncertainty makes
/// of the laws at the frames' inputs to the lasting ones.
/// @param model at the identified constants
/// @param of_constants their covariance, in their units
/// @param given_moduli the same given the moduli that are not identifiable: what EI is off by takes the
/// moment along, and is counted with EI
/// @param frames of fitted and unseen trials
arm::LawPrior law_errors(const arm::Arm& arm, LawModel& model, const std::vector<trial::StaticFrame>& frames,
                         const Eigen::MatrixXd& of_constants, const Eigen::MatrixXd& given_moduli);

}  // namespace softarm::identify
