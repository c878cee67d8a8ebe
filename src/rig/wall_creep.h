// What the wall of a segment lets through of what drives it: see CreepSpec.
#pragma once

#include <optional>
#include <vector>

#include "laws.h"
#include "scenario.h"

namespace softarm::rig {

class WallCreep {
 public:
  explicit WallCreep(const CreepSpec& spec);
  /// Takes from moment and length what is still to come. To be asked in the order of time; asked for the
  /// first instant again, it begins anew.
  void act(double t_s, Actuation& actuation);

 private:
  struct Part {
    double time_s, share;  ///< without pressure
    bool of_length;
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
  };
  void add(const CreepSpec::Part& part, bool of_length);
  /// What shares are multiplied by at a mean gauge pressure.
  double grown(bool of_length, double pressure_pa) const;

  std::vector<Part> parts_;
  std::optional<double> slows_pa_, grows_pa_;
  double late_moment_ = 0.0, late_length_ = 0.0;             ///< sums of the shares
  Eigen::Vector3d before_, last_ = Eigen::Vector3d::Zero();  ///< moment (x, y), N m; length, m
  double last_pa_ = 0.0;
  std::optional<double> first_s_, last_s_;
};

}  // namespace softarm::rig
