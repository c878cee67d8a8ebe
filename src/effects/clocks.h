// What clocks that are apart make of the inputs: a frame shows what they did at another instant.
#pragma once

#include <Eigen/Core>

namespace softarm::effects {

/// Trials that begin later in the session are taken as if their clocks ran alike: over a day even crystals
/// are apart by seconds, by which no screen that is linear about no rate finds them, and pauses are when
/// clocks are set.
constexpr double kClocksDrift_s = 3600.0;

/// By how much a clock that drifts is ahead, at a time of a trial.
/// @param offset_s ... when the session begins
/// @param session_s when the trial begins
inline double drifted_s(double rate, double offset_s, double session_s, double t_s) {
  return session_s > kClocksDrift_s ? 0.0 : offset_s + rate * (session_s + t_s);
}

/// Rows of values at other instants, straight between those of the series, held beyond its ends.
/// @param t_s one per column of values, increasing
/// @param at_s as many, increasing
inline Eigen::MatrixXd values_at(const Eigen::VectorXd& t_s, const Eigen::MatrixXd& values,
                                 const Eigen::VectorXd& at_s) {
  Eigen::MatrixXd out(values.rows(), values.cols());
  const Eigen::Index n = t_s.size();
  Eigen::Index after = 0;  // first instant later than the wanted one
  for (Eigen::Index i = 0; i < n; ++i) {
    while (after < n && t_s[after] <= at_s[i]) ++after;
    if (after == 0) {
      out.col(i) = values.col(0);
    } else if (after == n) {
      out.col(i) = values.col(n - 1);
    } else {
      const double w = (at_s[i] - t_s[after - 1]) / (t_s[after] - t_s[after - 1]);
      out.col(i) = (1.0 - w) * values.col(after - 1) + w * values.col(after);
    }
  }
  return out;
}

}  // namespace softarm::effects
