// The arm's laws and rod with effects in them, over a trial.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "effect.h"
#include "prepared_trial.h"
#include "vibration.h"

namespace softarm::model {

/// What moves with the arm beside its statics, known well enough to be no effect: inertia of its known
/// masses, and its viscoelastic lag.
struct Dynamics {
  bool inertia = true;
  double viscoelastic_lag_s = 0.0;  ///< moment of the wall = EI (u + lag du/dt)
  /// In which the arm swings; nullptr: it follows its equilibria, and inertia counts to first order.
  const TrialModes* modes = nullptr;
};

/// Derivatives of one block by the rod, FineRod::parameters(), with forces that hold places as they answer to
/// where those are then. Most of a diagnosis's memory: seven digits will do.
struct ByRod {
  Eigen::MatrixXf seen;  ///< of Predicted::p and, below, of the tangents, stacked
  /// Of the equilibrium in the modes of this block and of the next one; r x parameters.
  Eigen::MatrixXf modes_now, modes_next;
  /// What held places add to what is seen of a displacement in the modes of this block, by that; rows as of
  /// `seen`, r columns. Empty: no modes, or no such places.
  Eigen::MatrixXf held_back;
};

/// Prediction of one block.
struct Predicted {
  bool solved = false;
  Eigen::Matrix3Xd p;                          ///< one column per entry of Block::bodies, m, rod's base frame
  Eigen::Matrix3Xd tangents;                   ///< one per entry of Block::tangents
  std::vector<Eigen::Quaterniond> q_tangents;  ///< of the sections there
  Eigen::VectorXd values;                      ///< of the rod, FineRod::values
  /// By those, from differentiate(); nullptr: not made. Predictions nearby may share them.
  std::shared_ptr<const ByRod> by_rod;
  Shape shape;
  Instant instant;
  Eigen::Quaterniond q_tip = Eigen::Quaterniond::Identity();
  double inertial_m = 0.0;                  ///< by which inertia and lag moved the body that they moved most
  Rest rest;                                ///< the equilibrium without them
  std::shared_ptr<const Shape> rest_shape;  ///< and all of its shape
  Sluggishness sluggish;                    ///< in the motion of `shape`
};

/// Over one trial after the other; keeps its scratch memory. Not thread-safe.
class ExtendedModel {
 public:
  explicit ExtendedModel(const arm::Arm& arm);
  ~ExtendedModel();
  ExtendedModel(ExtendedModel&&) noexcept;

  const FineRod& rod() const;

  /// @param arm the one given to the constructor, perhaps with other constants of its laws
  /// @param start predictions of the same trial with similar parameters: where to begin; or nullptr
  /// @param only_where_solved where `start` has no equilibrium none is looked for: without one nearby that
  /// takes a hundred times as long
  void predict(const arm::Arm& arm, const std::vector<Present>& effects, const Dynamics& dynamics,
               const TrialData& trial, const std::vector<Predicted>* start, std::vector<Predicted>& out,
               bool only_where_solved = false);

  /// Rod values and places of bodies as other constants and effects would make them while shapes, and what
  /// follows from those, stay as they are in `baseline`. With `reference` what vary() gives for the
  /// parameters of the baseline, by_rod times the difference of `values`, plus that of `seen`, is what the
  /// change does to the bodies, to first order, but for what Effect::needs_whole_derivatives() says.
  /// @param driven_alike whether the inputs and the payload are those of the baseline, and so are the walls
  struct Varied {
    Eigen::MatrixXd values;  ///< one column per block; FineRod::values
    /// 3 x all bodies of all blocks, in order: by which effects move what is seen, from where the baseline's
    /// do; 0 where none of these effects does, so that the baseline's must be among them.
    Eigen::MatrixXd seen;
    /// The arm was made to swing as these parameters let it: `values` hold its inertia, too.
    bool swings = false;
  };
  Varied vary(const arm::Arm& arm, const std::vector<Present>& effects, const Dynamics& dynamics,
              const TrialData& trial, const std::vector<Predicted>& baseline, bool driven_alike);

  /// The modes of a trial at what predict() gave for the same arguments.
  TrialModes modes(const arm::Arm& arm, const std::vector<Present>& effects, const Dynamics& dynamics,
                   const TrialData& trial, const std::vector<Predicted>& predicted);

  /// Fills Predicted::by_rod of what predict() gave for the same arguments.
  /// @param wanted by which of FineRod::parameters(); the other columns are 0, but for forces on stations
  /// next to held places
  void differentiate(const arm::Arm& arm, const std::vector<Present>& effects, const Dynamics& dynamics,
                     const TrialData& trial, const std::vector<bool>& wanted,
                     std::vector<Predicted>& predicted);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softarm::model
