// Errors that frames have in common, and that more frames therefore do not average out.
#pragma once

#include <Eigen/Core>

#include "prior.h"

namespace softarm::estimate {

/// Beside z, which all frames of a window share (FrameLaw):
///   e   the laws' passing errors, of the columns FrameLaw::passing of x: the same while the arm keeps its
///       posture;
///   b   what each coordinate of the bodies is off by: where they sit on the arm, for good, and errors of the
///       model within a posture; behind them the errors of the gains (FrameLaw::gains), for good.
/// Frames then say as much of z as these errors leave: with ever more frames the standard deviations go to
/// theirs, not to zero. Vectors and matrices have z (or x) first, then e, then b.
struct CommonErrors {
  Eigen::VectorXd passing;  ///< variances of e
  Eigen::VectorXd posture;  ///< variances of what b has in one posture, beside what it has for good
};

/// What a frame's bodies say of (z, e, b).
/// @param bodies what they say of (x, b)
/// @param repeats how many frames in a row have the same jitter: each of them says as much less
Evidence evidence_on_errors(const FrameLaw& law, const Evidence& bodies, double repeats);

/// What the frames of a posture say of what outlasts it, (z, b), from what they say of (z, e, b).
Evidence beyond_posture(const Evidence& of_posture, const CommonErrors& errors);

/// What is believed of (x - centre, b) of a frame.
/// @param lasting of (z, b): what the laws know and other postures say
/// @param of_posture of (z, e, b): what the other frames of its posture say; nullptr: there are none
Evidence belief_with_offsets(const FrameLaw& law, const CommonErrors& errors, const Evidence& lasting,
                             const Evidence* of_posture);

/// Without its last parameters, whatever they are.
Evidence without_last(Evidence of, Eigen::Index count);

}  // namespace softarm::estimate
