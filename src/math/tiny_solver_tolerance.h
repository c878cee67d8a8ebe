// What differs between the versions of Ceres' TinySolver that are in use: 1.14 (Ubuntu 20.04) and 2.
#pragma once

namespace softarm::math {
namespace detail {

template <typename Options>
auto set_function_tolerance(Options& options, double tolerance, int)
    -> decltype(options.function_tolerance, void()) {
  options.function_tolerance = tolerance;
}
template <typename Options>
void set_function_tolerance(Options&, double, long) {}

}  // namespace detail

/// Ends a solve where the cost falls by no more than this share; 1.14 has no such tolerance and goes on to
/// the others.
template <typename Options>
void set_function_tolerance(Options& options, double tolerance) {
  detail::set_function_tolerance(options, tolerance, 0);
}

/// Whether the last solve ended because it met a tolerance, not because its iterations were used up.
template <typename Solver>
bool met_tolerance(const Solver& solver) {
  return solver.summary.status != Solver::HIT_MAX_ITERATIONS;
}

}  // namespace softarm::math
