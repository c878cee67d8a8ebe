// What effects do to the bodies of trials, as a line in the arm's constants.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "joint_fit.h"
#include "model/effect.h"
#include "model/extended_model.h"
#include "softarm/arm/arm.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {

/// By differences of two predictions of whole trials by the arm's laws, without the effects and with them
/// (memories and inputs included, in means over a tenth of a second); between the means, straight.
class EffectLines {
 public:
  /// @param starts how trials find the effects, by trial, see start(); at rest where nothing is said
  EffectLines(const arm::Arm& arm, std::vector<model::Present> effects,
              const std::vector<trial::Trial>& trials, unsigned jobs,
              std::map<std::size_t, Eigen::VectorXd> starts = {});

  /// Trials as the arm without its effects would have been recorded; frames that cannot be predicted are left
  /// out.
  const std::vector<trial::Trial>& without_effects() const { return without_; }

  /// Numbers of Effect::starts(), of all effects. @return its name; sd what is expected beforehand
  EffectStart start(Eigen::Index number) const;

  /// How that changes with the constants and with how trials found the effects, for frames of
  /// without_effects(); the last constants asked for are kept.
  Line line(const std::vector<FreeConstant>& constants, const std::vector<trial::StaticFrame>& frames);

 private:
  /// One body of one block.
  struct Moved {
    double stamp_s = 0.0;
    std::size_t block = 0;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();     ///< rod's base frame
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< rotation vector
  };
  struct OfTrial {
    model::TrialData data;
    std::vector<model::Predicted> without, with;
    std::vector<std::vector<Moved>> moved;  ///< by body, in order of time
    Eigen::VectorXd start;
    std::vector<Eigen::MatrixXd> by_start;  ///< by block, 6 bodies x numbers
  };
  /// The means before and after a stamp, and the share of the second.
  struct Between {
    const Moved *before = nullptr, *after = nullptr;
    double share = 0.0;
    Eigen::Vector3d mean(Eigen::Vector3d Moved::*what) const {
      return (1.0 - share) * before->*what + share * after->*what;
    }
  };

  std::vector<model::Present> effects_with(const Eigen::VectorXd& start) const;
  void predict(OfTrial& trial) const;
  std::vector<Eigen::MatrixXd> slopes_by_start(const OfTrial& of) const;
  static Between between(const std::vector<Moved>& list, double stamp_s);
  trial::Trial corrected(const OfTrial& of, const trial::Trial& trial) const;
  std::vector<Eigen::MatrixXd> slopes_of_blocks(const OfTrial& of,
                                                const std::vector<FreeConstant>& constants) const;
  Slopes slopes_of_frame(const OfTrial& of, const std::vector<Eigen::MatrixXd>& by_block,
                         const trial::StaticFrame& frame, Eigen::Index constants) const;

  const arm::Arm arm_;
  const std::vector<model::Present> effects_;
  std::vector<EffectStart> numbers_;
  const unsigned jobs_;
  std::vector<OfTrial> trials_;
  std::vector<trial::Trial> without_;
  // Of the last constants asked for, and by trial and block.
  std::vector<std::string> names_;
  std::vector<std::vector<Eigen::MatrixXd>> by_block_;
};

/// identify::identify() of the trials of `lines`, whose slopes belong to the model.
Result identify_with(const arm::Arm& arm, EffectLines& lines, const Options& options,
                     const ProgressCallback& progress);

}  // namespace softarm::identify
