// Every effect of the catalogue against what one fit leaves: a score test.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "joint_model.h"

namespace softarm::diagnose {

/// An effect as the screen sees it, with the values of its grid that explain most.
struct Screened {
  const model::Effect* effect = nullptr;
  model::Values values;       ///< sizes as estimated to first order, within their physical range
  Eigen::VectorXd absorbed;   ///< of these sizes, by the fit's unknowns: they go back by so much
  Eigen::VectorXd sizes, sd;  ///< the same before they were put into that range, and their sd
  double gain = 0.0;          ///< by which chi^2 falls
  double unseen_gain = 0.0;   ///< the same on each trial with sizes from the others
  double z = 0.0;             ///< sqrt of the Wald statistic, residuals of a stretch being correlated
  double collinearity = 0.0;  ///< share of the signature that the fitted constants absorb
  double usual_z = 0.0;       ///< that a usual size would have
  double size_m = 0.0;        ///< rms of what it moves the bodies by, constants held
  double leftover_m = 0.0;    ///< the same with the constants fitted anew: what the residuals show of it
  Eigen::VectorXd direction;  ///< orthogonal signature of the estimate, unit, all trials: against rivals
};

/// Signatures at all values of the catalogue's grids that a screen made.
struct KnownSignatures {
  struct Of {
    const model::Effect* effect = nullptr;
    model::Values values;                ///< sizes 0
    std::vector<Eigen::MatrixXd> moves;  ///< by trial: whitened, by usual sizes
  };
  std::vector<Of> list;
};

/// For one fit: signatures of all effects that are not in it, orthogonal to all its unknowns.
/// @param known of a screen of the model before: which values of a grid explain most is found by those, and
/// only their own signatures are made anew. Of no use where the model holds more places since. Becomes those
/// of this screen; nullptr: none are, and none are kept
std::vector<Screened> screen(JointModel& model, Linearised& at, unsigned jobs,
                             const std::function<void(double)>& progress, KnownSignatures* known = nullptr);

/// How much wider than under independent residuals an estimate's spread is: from the sums of stretches.
double inflation(const Linearised& at);

}  // namespace softarm::diagnose
