// Inputs between their samples.
#pragma once

#include <Eigen/Core>

namespace softarm::effects {

/// Frames hold the newest sample of an input, so that what moves smoothly looks like stairs, late by half a
/// step. Puts straight lines between samples that follow one another in the input's rhythm (the median time
/// between changes); what was held longer stays held.
/// @param t_s stamps of the frames, increasing @param values an input at the frames
void straighten(const Eigen::VectorXd& t_s, Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> values);

}  // namespace softarm::effects
