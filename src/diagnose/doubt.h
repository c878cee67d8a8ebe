// How sure the effects of the last model are, given all the others in it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "posterior.h"
#include "unseen.h"

namespace softarm::diagnose {

struct Doubt {
  /// Of the fit's unknowns, in their scales, about the fit's values: by the posterior, which knows of the
  /// background and of correlated errors; without enough instants the fit's own, inflated.
  Eigen::MatrixXd covariance;
  std::vector<double> still_there;  ///< for each effect of the fit: its probability given all the others
};

/// What differs from trial to trial the posterior may not know: the unknowns' variances are moderated by how
/// the fit differs between folds (Widening).
struct Between {
  Spreads unknowns;
  std::vector<Spreads> at_shapes;  ///< for each effect: those where its shapes are the fit's
};
Between between_folds(const JointModel& model, const Linearised& at);

/// @param at the last model
/// @param without_rivals the posterior as if what may be mistaken for effects of the model could not be
/// beside them, however small: a class is surer than which of it is there
/// @param between folds, of the unknowns of `at`
/// @param catalogue number of effects that may have been there
/// @param unknown_inertia share of what inertia does that is no finding
Doubt doubt_about(const Linearised& at, const Posterior& posterior, const Posterior& without_rivals,
                  const Between& between, std::size_t catalogue, double unknown_inertia);

}  // namespace softarm::diagnose
