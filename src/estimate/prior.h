// What is believed of a frame's parameters before its bodies are looked at.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "arm/wall_memory.h"
#include "softarm/arm/arm.h"
#include "softarm/arm/laws.h"

namespace softarm::estimate {

/// A Gaussian belief about the parameters x of a Problem; directions without information are free.
struct Belief {
  Eigen::VectorXd mean;
  Eigen::MatrixXd information;  ///< P x P, positive semi-definite
  /// What errors of the effects' numbers, in standard deviations, add to the mean; they are in `information`.
  Eigen::MatrixXd by_effects = {};

  /// Rows S with S^T S = information, for a least-squares fit to S (x - mean).
  Eigen::MatrixXd rows() const;
};

/// How a frame's parameters follow from what all frames of a while share, by the arm's laws at the frame's
/// inputs:
///   x = centre + shared * z + jitter.
/// z has the order of x: per segment the laws' lasting error of the moment (2 components, N m), of the
/// flexibility (relative), of the length (m), and last the payload (in Problem::kPayloadUnit). Without the
/// laws as a prior, moment and length are each frame's own: their jitter is unbounded.
struct FrameLaw {
  Eigen::VectorXd centre;
  Eigen::MatrixXd shared;           ///< P x P
  Eigen::VectorXd jitter_variance;  ///< of x; 0: none; negative: unbounded
  Eigen::VectorXd information;      ///< on z, of the laws themselves (diagonal); 0: nothing is known
  Eigen::VectorXd memory_variance;  ///< of z, for what the walls' memory lacks; it is in `information`
  std::vector<int> passing;         ///< columns of x whose jitter is bounded
  /// What errors of the gains add to x: two per segment, of its moment along it, as all its gains share it,
  /// and across; and one for each actuator's own. A gain that is off errs with the moment: frames of
  /// different moments tell it from a constant error, which z has.
  /// Behind them, with a variance of 1, the errors of the effects' numbers.
  Eigen::MatrixXd gains;
  Eigen::VectorXd gain_variance;  ///< where it is 0 their error is in `information`
  Eigen::Index of_effects = 0;    ///< of the columns

  auto by_effects() const { return gains.rightCols(of_effects); }
};

/// The parameters x that predictions make.
Eigen::VectorXd x_by_laws(const arm::Arm& arm, const std::vector<arm::SegmentPrediction>& predictions,
                          const std::vector<double>& reference_stiffness);

/// @param predictions one per segment where the inputs are known; else those of the laws at no input
/// @param reference_stiffness the flexibility 1 of each segment
/// @param gains_apart gains err by themselves, not as a constant error of this frame's size
/// @param inputs at which the predictions are; empty: actuators do nothing by themselves
FrameLaw frame_law(const arm::Arm& arm, const arm::LawPrior& prior,
                   const std::vector<arm::SegmentPrediction>& predictions,
                   const std::vector<double>& reference_stiffness, bool gains_apart = false,
                   const arm::InputValues& inputs = {});

/// Adds the errors of the effects' numbers. @param by_errors what a standard deviation of each adds to x
void allow_for_effects(const Eigen::MatrixXd& by_errors, FrameLaw& law);

/// Adds what is not known of the memories of walls and effects: of how they were when the recording began,
/// and of gaps. Only where the prior is enabled.
/// @param effects of each segment's curvature, 1/m^2; empty: none
void allow_for_memory(const arm::LawPrior& prior, const arm::LawMemory& memory,
                      const std::vector<Eigen::Vector2d>& effects,
                      const std::vector<arm::SegmentPrediction>& predictions, FrameLaw& law);

/// Adds what is not known of EA to the lasting error of the lengths: at stretches by the loads of so many
/// metres, length_sd_m^2 + (axial_stiffness_sd_rel stretch)^2. Only where the prior is enabled.
///
/// A segment's length under load is k L (1 + N/EA). A payload read off the stretch is the stretch times EA:
/// as uncertain, relatively, as EA is, whatever the stretch. With the variance taken at the solution the
/// linear covariance says just that, as payload and length are correlated in it.
/// @param stretch_m by the loads, of each segment; negative where they compress it
void allow_for_axial_stiffness(const arm::LawPrior& prior, const std::vector<double>& stretch_m,
                               FrameLaw& law);

/// A Gaussian, or what measurements say: information, and information times mean.
struct Evidence {
  Eigen::MatrixXd information;
  Eigen::VectorXd weighted;
};

/// Adds to each parameter an error of zero mean and of this variance, its own; 0: none; negative: unbounded.
void integrate_out(const Eigen::VectorXd& variance, Evidence& of);

/// The belief about x that a belief about z implies under a frame's law.
Belief belief_of_frame(const FrameLaw& law, const Eigen::MatrixXd& z_information,
                       const Eigen::VectorXd& z_weighted);
/// The same from what is believed of x - centre.
Belief belief_about_centre(const FrameLaw& law, const Evidence& of);

/// What a frame's bodies say about z: quadratic form of a measurement with information `h` on x and h times
/// its optimum `hx`, with the jitter integrated out.
/// @param repeats how many frames in a row have the same jitter: each of them says as much less of z
Evidence evidence_on_shared(const FrameLaw& law, const Eigen::MatrixXd& h, const Eigen::VectorXd& hx,
                            double repeats);

}  // namespace softarm::estimate
