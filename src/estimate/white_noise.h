// How much of what bodies are measured with is noise from frame to frame.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "problem.h"
#include "softarm/arm/arm.h"

namespace softarm::estimate {

/// The noise that averages out, of each body, from what its path in the last frames has that no smooth motion
/// has. A stated standard deviation often stands for more, errors of the model that stay while the arm does:
/// a motion capture may repeat itself to 0.01 mm where the file says 1 mm.
class WhiteNoise {
 public:
  explicit WhiteNoise(const arm::Arm& arm);
  void forget();
  void add(double stamp_s, const std::vector<Observation>& observations);

  /// Per coordinate, m^2; at most what is stated, and that until frames have shown it.
  double position_variance(int body) const;
  double tangent_variance(int body) const;  ///< per axis, rad^2

 private:
  struct Sample {
    double stamp_s;
    Eigen::Vector3d value;
  };
  struct Path {
    Path(double sd, double of) : stated(sd * sd), dimensions(of) {}
    double stated;  ///< variance
    double dimensions;
    std::optional<Sample> before_last, last;
    double mean = 0.0;
    int count = 0;
    void add(const Sample& sample);
    double variance() const;
  };
  std::vector<Path> positions_, tangents_;
};

}  // namespace softarm::estimate
