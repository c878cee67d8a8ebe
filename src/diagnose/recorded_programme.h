// What was recorded, as experiments vary it: the trial that drives the arm most, and what the arm has borne.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "model/prepared_trial.h"
#include "softarm/arm/arm.h"

namespace softarm::diagnose {

/// Inputs and payload at one time.
struct Driven {
  Eigen::VectorXd inputs;
  double payload_kg = 0.0;
};

/// Makes trials that nobody has recorded out of those that were.
class RecordedProgramme {
 public:
  /// @param trials kept by reference
  /// @param block_s over which frames are averaged
  RecordedProgramme(const arm::Arm& arm, const std::vector<model::TrialData>& trials, double block_s);

  /// Whether there is a trial to vary.
  bool usable() const { return base_ != nullptr; }
  const model::TrialData& base() const { return *base_; }
  const std::vector<model::TrialData>& trials() const { return trials_; }

  const Eigen::VectorXd& low() const { return low_; }    ///< of each input, in all trials
  const Eigen::VectorXd& high() const { return high_; }  ///< the same
  double most_payload_kg() const { return most_payload_kg_; }
  const Eigen::VectorXd& rest() const { return rest_; }  ///< inputs at the base trial's begin
  const Eigen::VectorXd& peak() const { return peak_; }  ///< where they bend the arm most in it
  double peak_s() const { return peak_s_; }
  double payload_kg() const { return payload_kg_; }            ///< at the base trial's end
  const Eigen::Vector3d& gravity() const { return gravity_; }  ///< its direction in it, rod's base frame
  /// Of a body's mean position, the middle one of all trials; 0: the body was never seen.
  const std::vector<double>& white_sd_m() const { return white_sd_m_; }

  /// A trial in which all bodies are seen all the time; positions are left at 0.
  /// @param gravity direction in the rod's base frame
  /// @param drive by the time from its begin, s; inputs are kept within low() and high()
  model::TrialData trial(double seconds, const Eigen::Vector3d& gravity,
                         const std::function<Driven(double)>& drive) const;
  /// The base trial's inputs once more, some 24 s of them.
  model::TrialData repeated(const Eigen::Vector3d& gravity, double speed, double payload_kg) const;

 private:
  void choose_base();
  void find_precision();
  Eigen::VectorXd base_inputs(double t_s) const;

  const arm::Arm& arm_;
  const std::vector<model::TrialData>& trials_;
  const double block_s_;
  Eigen::VectorXd low_, high_;
  double most_payload_kg_ = 0.0;
  const model::TrialData* base_ = nullptr;
  Eigen::VectorXd rest_, peak_;
  double peak_s_ = 0.0, payload_kg_ = 0.0;
  Eigen::Vector3d gravity_ = Eigen::Vector3d::UnitZ();
  std::vector<double> white_sd_m_, white_sd_rad_;
};

}  // namespace softarm::diagnose
