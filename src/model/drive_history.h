// What drove the arm so far, kept small: for effects on inputs that look back.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <vector>

#include "effect.h"
#include "softarm/arm/arm.h"
#include "softarm/trial/trial.h"
#include "trial/input_rhythm.h"

namespace softarm::model {

/// Inputs at the frames, by the stamps of their samples, as prepare() has them for a whole trial, but without
/// looking ahead: a frame between two samples is put right when the second one comes. Points that lie on a
/// line with their neighbours are dropped, so that minutes fit.
class DriveHistory {
 public:
  explicit DriveHistory(const arm::Arm& arm);
  void clear();
  /// @param stamp_s increasing; @param inputs one per Arm::inputs.scalars; @param samples since the frame
  /// before. An input of which no sample ever came is taken for sampled at the frames.
  void add(double stamp_s, const Eigen::VectorXd& inputs, const std::vector<trial::InputSample>& samples);
  /// From the oldest kept instant to the frame that was added last; moment_inputs are the inputs.
  /// @param begin_s stamp at which its time is 0
  Series series(double begin_s, double payload_kg) const;

 private:
  struct Point {
    double stamp_s = 0.0;
    Eigen::VectorXd inputs;
  };
  struct Source {
    std::optional<arm::Between> stated;
    bool has_samples = false;
    trial::InputRhythm rhythm;
    trial::InputSeries recent;  ///< back to the sample before the first open frame
  };
  void add(Source& source, std::int64_t stamp_ns, double value);
  /// Whether a sample that is still to come may change a frame.
  bool is_open(const Point& frame) const;
  void close(Point point);

  Eigen::VectorXd tolerance_;
  std::vector<Source> sources_;
  std::deque<Point> points_;  ///< frames that nothing changes any more
  /// Of lines from the last point but one that pass all frames since within the tolerance; empty: none yet.
  Eigen::ArrayXd least_slope_, most_slope_;
  std::deque<Point> open_;  ///< those after them
};

}  // namespace softarm::model
