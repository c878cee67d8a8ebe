// What the published boundary-value problems share: shooting with MINPACK's hybrid Powell method.
#pragma once

#include <Eigen/Core>
#include <boost/math/constants/constants.hpp>
#include <functional>

namespace softarm::published {

constexpr double kPi = boost::math::constants::pi<double>();

/// The conditions at the far end, at one share of the load: as many as unknowns, both free of units and of
/// order 1.
using Shot = std::function<Eigen::VectorXd(double share, const Eigen::VectorXd& at)>;

/// Follows a root of residual(share, x) from the unloaded problem (share 0, where `x` is near a root) to the
/// loaded one (share 1), so that the equilibrium found is the one that grows out of the unloaded arm.
/// @return false if none was found; x is then of no use
bool follow_root(const Shot& residual, Eigen::VectorXd& x, double tolerance = 1e-10);

}  // namespace softarm::published
