// What is left in residuals that noise would not leave.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "joint_model.h"
#include "softarm/diagnose/diagnose.h"
#include "unseen.h"

namespace softarm::diagnose {

/// Whiteness in time and along the arm by sign-flipping of stretches, which keeps what is correlated within
/// them; dependence on inputs by correlations of means over stretches.
Structure structure_of(const JointModel& model, const Linearised& at, const Unseen& unseen);

/// By name, how probable such a correlation with the error is where there is none. Several columns may have
/// one name (axes of the attitude, an input's past over two times): chance makes the least of their p smaller
/// than of one column, which counts.
/// @param values a column by name, one row per error
/// @return nothing of few errors; no name of which nothing varies
std::map<std::string, double> p_by_name(const std::vector<std::string>& names, const Eigen::MatrixXd& values,
                                        const Eigen::VectorXd& error);

}  // namespace softarm::diagnose
