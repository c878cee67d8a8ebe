// Air that moves about the arm: private to the rig.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "body_spec.h"

namespace softarm::rig {

/// Two horizontal forces of the same kind at right angles, each a sum of waves of frequencies spread as the
/// spectrum of an exponential correlation is. Smooth, as the time integration likes it.
class DraughtForce {
 public:
  /// @param spec absent: still air
  DraughtForce(const std::optional<Draught>& spec, double length_m, std::uint64_t seed);

  /// Per length of arm, in the mocap frame; of a sheltered arm at its tip.
  Eigen::Vector3d at(double t_s) const;

 private:
  struct Wave {
    double rad_per_s, phase;
  };
  double amplitude_ = 0.0;  ///< of a wave, N / m
  std::vector<Wave> waves_[2];
};

}  // namespace softarm::rig
