// How sure the effects of the last model are, given all the others in it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "posterior.h"

namespace softarm::diagnose {

struct Doubt {
  /// Of the fit's unknowns, in their scales, about the fit's values: by the posterior, which knows of the
  /// background and of correlated errors; without enough instants the fit's own, inflated.
  Eigen::MatrixXd covariance;
  std::vector<double> still_there;  ///< for each effect of the fit: its probability given all the others
};

/// @param at the last model
/// @param without_rivals the posterior as if what may be mistaken for effects of the model could not be
/// beside them, however small: a class is surer than which of it is there
/// @param catalogue number of effects that may have been there
/// @param unknown_inertia share of what inertia does that is no finding
Doubt doubt_about(const Linearised& at, const Posterior& posterior, const Posterior& without_rivals,
                  std::size_t catalogue, double unknown_inertia);

}  // namespace softarm::diagnose
