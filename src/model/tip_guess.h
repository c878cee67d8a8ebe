// Where the tip of a block is looked for.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "extended_model.h"

namespace softarm::model {

/// Over the blocks of a trial in turn: as in a prediction nearby, turned by what the last block's tip was
/// turned from there; without one, as in the last block.
class TipGuess {
 public:
  /// @param nearby prediction of the same trial with similar parameters, or nullptr
  explicit TipGuess(const std::vector<Predicted>* nearby) : nearby_(nearby) {}

  /// @param resting the block's equilibrium, where it is the motion beyond it that is looked for; else
  /// nullptr
  /// @return nothing: it may be anywhere
  std::optional<Eigen::Quaterniond> of(std::size_t block, const Predicted* resting);
  /// That of the block asked for last.
  void found(const Eigen::Quaterniond& q_tip);
  /// That block has none.
  void lost();

 private:
  const std::vector<Predicted>* nearby_;
  std::optional<Eigen::Quaterniond> from_, last_;
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
};

}  // namespace softarm::model
