// What differs between the versions of Ceres that are in use: 1.14 (Ubuntu 20.04) and 2.
#pragma once

#include <ceres/ceres.h>

namespace softarm::math {

/// Has `callback` called before the cost functions are evaluated, as of ceres::EvaluationCallback.
inline void set_evaluation_callback(ceres::EvaluationCallback& callback,
                                    [[maybe_unused]] ceres::Problem::Options& problem,
                                    [[maybe_unused]] ceres::Solver::Options& solver) {
#if CERES_VERSION_MAJOR < 2
  solver.evaluation_callback = &callback;
#else
  problem.evaluation_callback = &callback;
#endif
}

}  // namespace softarm::math
