// What is hidden in the body of the arm: material, boundary, loads. Zero or absent: the arm is ideal.
#pragma once

#include <optional>

namespace softarm::rig {

struct BodySpec {
  /// The base turns under the load, though the measured body `base` does not: bending moment there over this.
  std::optional<double> base_stiffness_nm_per_rad;
};

}  // namespace softarm::rig
