// What identify says of noise and zeros of the inputs.
#pragma once

#include <string>
#include <vector>

#include "joint_fit.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {

/// Fills in Result::input_errors and noise_share; constants, covariance and position_rms_m are there already.
/// @param scale of the constants
void report_input_errors(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                         const SensorErrors& errors, const JointProblem& problem,
                         const Eigen::VectorXd& scale, Result& result);

/// The lines of the table; empty where inputs were taken as exact.
std::string describe_input_errors(const Result& result);

}  // namespace softarm::identify
