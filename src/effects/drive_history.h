// What drove the arm so far, kept small: for effects on inputs that look back.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/effects/effect.h"

namespace softarm::effects {

/// Samples that were held between frames become straight lines, as held_inputs.h makes them of a whole trial,
/// but without looking ahead; points that lie on a line with their neighbours are dropped, so that minutes
/// fit.
class DriveHistory {
 public:
  explicit DriveHistory(const Arm& arm);
  void clear() { points_.clear(); }
  /// @param t_s increasing; @param inputs one per Arm::inputs.scalars
  void add(double t_s, const Eigen::VectorXd& inputs);
  /// From the oldest kept instant to the frame that was added last; moment_inputs are the inputs.
  Series series(double payload_kg) const;

 private:
  struct Point {
    double t_s = 0.0;
    Eigen::VectorXd inputs;
  };
  void push(const Point& point);

  Eigen::VectorXd tolerance_;
  std::deque<Point> points_;  ///< where inputs changed
  Point last_;                ///< frame
};

}  // namespace softarm::effects
