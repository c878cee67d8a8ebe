// How much of what is hidden in recordings a diagnosis could see: the same trials with and without it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "diagnose/joint_model.h"
#include "residuals.h"
#include "softarm/identify/identify.h"

namespace softarm::prove {

/// An effect as the difference of two recordings that are the same but for it: of the residuals that one set
/// of the arm's constants leaves in both, and of those that its own refitted constants leave in each, in
/// standard deviations of means over 0.1 s (white noise, and what the diagnosis allows for swinging), of the
/// means that the diagnosis compares in the trials without anything hidden: each recording is cut into means
/// by its own motion, so residuals are taken at the times of these. What stands out counts as in the
/// diagnosis, by Huber's weights: one instant that is off by a centimetre, as where an arm topples, tells
/// nobody what is there.
struct Signal {
  Eigen::VectorXd there;   ///< by whitened row: 1 where both recordings have it, which alone count; else 0
  Eigen::VectorXd counts;  ///< root of the weight of what is left, by row: 0 where it is not there
  Eigen::VectorXd difference;  ///< with one set of constants: whitened, all trials
  /// With the constants refitted, and orthogonal to their derivatives. Constants bend what they absorb: of an
  /// effect that moves the arm by millimetres the derivatives alone absorb less than a refit does.
  Eigen::VectorXd left;
  double raw_snr = 0.0;        ///< length of the difference
  double leftover_snr = 0.0;   ///< length of what is left
  double per_frame_snr = 0.0;  ///< the same with those constants free in every mean
  double per_frame_sd =
      0.0;                  ///< excess of chi^2 of such fits in its standard deviations: snr^2 / sqrt(2 dof)
  double raw_m = 0.0;       ///< rms distance of a body, with these weights
  double leftover_m = 0.0;  ///< the same of what is left
  Residuals moved;          ///< with one set of constants: see at_whole_seconds(), m
};

/// One effect of the catalogue against a noise-free signal.
struct Ideal {
  std::string effect;
  double explains = 0.0;    ///< share of leftover_snr squared
  double cosine = 0.0;      ///< with the best one's signature
  double own_cosine = 0.0;  ///< with that of what is hidden; 0 where that is not told, or not looked for
};

/// Which others nobody can tell in these trials from the effect that is hidden, by the rule by which the
/// diagnosis calls two effects one class: with all that is left, the two signatures are less than three
/// standard deviations apart. What cannot have the size, or the sign, leaves more of it than that.
/// @param own the one that is hidden
/// @param list see Reference::ideal(), with own
std::vector<std::string> not_told_apart(const std::vector<Ideal>& list, const std::string& own,
                                        double leftover_snr);

/// The trials without anything hidden, and the constants that fit them.
class Reference {
 public:
  /// @param held, tied constants, as `softarm diagnose` takes them
  Reference(const arm::Arm& arm, const std::vector<trial::Trial>& trials, unsigned jobs,
            const std::vector<std::string>& held = {}, const std::vector<std::string>& tied = {});

  Left residuals(const std::vector<trial::Trial>& trials) const { return residuals(arm_, trials); }
  /// Of an arm that differs in what is not fitted.
  /// @throws std::invalid_argument where other constants of it are free
  Left residuals(const arm::Arm& arm, const std::vector<trial::Trial>& trials) const;
  Signal signal(const Left& with, const Left& without) const;
  /// The catalogue, best first, against the signal as if nothing else were in the recording: what an ideal
  /// detector has to go by.
  /// @param own the effect that is hidden; empty: none of the catalogue, or several
  std::vector<Ideal> ideal(const Signal& signal, const std::string& own = {});
  /// Cosine between what two signals leave.
  double cosine(const Signal& a, const Signal& b) const;
  /// Rms distance of a body from what these constants predict, with Huber's weights as of the fit.
  double unexplained_m() const;
  /// Names and values of the constants that fit.
  std::map<std::string, double> constants() const;

 private:
  struct Compared {
    Eigen::VectorXd whitened, there;  ///< see Signal
  };
  /// Of residuals at the times of the means.
  Compared by_rows(const Residuals& residuals) const;
  Compared difference(const Residuals& with, const Residuals& without) const;
  /// Roots of Huber's weights of a difference, by row.
  /// @param with residuals of the recording that would be diagnosed
  Eigen::VectorXd root_weights(const Eigen::VectorXd& difference, const Residuals& with) const;
  /// The fit with rows weighted besides; with 0: without them.
  diagnose::Linearised at_rows(const Eigen::VectorXd& root_weight) const;
  Eigen::VectorXd orthogonal(const diagnose::Linearised& at, const Eigen::VectorXd& difference) const;
  double rms_m(const Eigen::VectorXd& whitened, const Eigen::VectorXd& there) const;

  const arm::Arm arm_;
  const unsigned jobs_;
  const std::vector<std::string> held_, tied_;
  model::Prepared prepared_;
  diagnose::JointModel model_;
  diagnose::Linearised at_;
  Residuals own_;  ///< zeros at the times of the means
};

/// Of trials that were prepared, under these predictions of them.
Residuals residuals_of(const std::vector<model::TrialData>& trials,
                       const std::vector<std::vector<model::Predicted>>& predicted);

/// What is left of a vector of the whitened rows of all trials once the arm's constants are free in each
/// mean, and by how many degrees of freedom.
Eigen::VectorXd per_frame_part(const diagnose::JointModel& model, const diagnose::Linearised& at,
                               const Eigen::VectorXd& rows, double* freedom);

}  // namespace softarm::prove
