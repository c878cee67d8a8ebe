// How an arm swings after a hand let it go.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/extended_model.h"

namespace softarm::diagnose {

/// A swing that no input made: since a hand let go. How an arm moves where a trial begins is as little known,
/// but there nothing says how far it may swing, and beside a model that is off such swings only fit its
/// errors.
struct FreeSwing {
  std::size_t first = 0;
  double reach_m = 0.0;             ///< as far as it may be, of a body
  std::vector<Eigen::MatrixXd> by;  ///< of the blocks from there on, see model::free_swing()
};

/// All of a trial.
/// @param noise_m of a body
std::vector<FreeSwing> free_swings(const model::TrialModes& modes, const model::TrialData& trial,
                                   const std::vector<model::Predicted>& predicted, double noise_m);

/// What bodies and tangents did of a free swing, by block, and how well that is known.
struct KnownSwing {
  std::vector<Eigen::VectorXd> displacement;  ///< 6b
  std::vector<double> sd_m;                   ///< of the body that is known least, per axis
};

/// By least squares upon what was seen, beside an error of the model that goes along straight lines.
/// @param modes of the block in which it begins
KnownSwing known_of(const FreeSwing& swing, const model::Modes& modes, const model::TrialData& trial,
                    const std::vector<model::Predicted>& predicted);

}  // namespace softarm::diagnose
