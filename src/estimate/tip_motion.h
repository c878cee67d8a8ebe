// How far an arm is from rest: what it does not have that is fitted as if it stood still.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

namespace softarm::estimate {

/// The acceleration of the tip, from its path in the last frames.
class TipMotion {
 public:
  /// @param noise_sd_m of the tip's place, for recordings too slow to show it
  explicit TipMotion(double noise_sd_m) : noise_sd_m_(noise_sd_m) {}
  /// Over which frames of this spacing show it.
  static double span_s(double spacing_s);
  void forget();
  void add(double stamp_s, const Eigen::Vector3d& p_tip);

  /// Over the newest quarter of a second, as far as it is more than noise, m/s^2.
  Eigen::Vector3d acceleration() const;
  /// Mean square over the last swing, of each coordinate, m^2/s^4.
  Eigen::Vector3d acceleration_variance() const;

 private:
  struct At {
    double stamp_s;
    Eigen::Vector3d value;
  };
  Eigen::Vector3d newest() const;

  double noise_sd_m_;
  std::deque<At> path_, accelerations_;
};

}  // namespace softarm::estimate
