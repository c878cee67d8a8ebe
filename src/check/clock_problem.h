// The motion of the arm as an answer to its inputs: the regression by which their clocks are compared.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "context.h"

namespace softarm::check {

struct ClockProblem {
  std::vector<double> t_s;
  Eigen::MatrixXd y;       ///< places of the outermost body, samples x 3, m, less what is slow
  Eigen::MatrixXd hats;    ///< orthonormal columns: what is slow
  std::vector<int> block;  ///< of a sample: residuals are correlated within
  std::vector<const Signal*> signals;
  double centre_s = 0.0;  ///< about which shifts are counted
  bool with_plays = true, with_cubes = true;
};

/// The body farthest along the arm; null where none is seen often enough.
const Track* outermost(const Context& context);
/// Whether an input changes so much that the arm should answer.
bool drives(const Signal& signal);

/// @param centre_s the bodies' clock is about so much ahead of the inputs'
/// @param step_s between samples
/// @param without_slow leaves out what is slow; else only the mean place and payloads that are hung on
/// @return nothing where no input changes while a body is seen, or for too short
std::optional<ClockProblem> clock_problem(const Context& context, double centre_s, double step_s,
                                          bool without_slow = true);

/// The regressors at a shift from the centre, samples x columns: the arm at t answers to the inputs at
/// t - centre - shift. Hats are projected out.
Eigen::MatrixXd regressors(const ClockProblem& problem, double shift_s);

}  // namespace softarm::check
