// The order of bodies along the arm, by their distances.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace softarm::arm {

/// An order in which distances of neighbours fit their spacing.
struct BodyOrder {
  std::vector<std::size_t> order;  ///< order[k] is the body that takes the k-th place
  double as_is_m = 0.0;            ///< rms of distances less spacing, in the order that is said
  double least_m = 0.0;            ///< the same in this one
};

/// Weight of distances below the spacing: bending shortens chords.
inline constexpr double kShortChord = 0.5;

/// Where bodies are clearly in another order than is said; nothing where they are not, or are too few or too
/// many to say. The base is at 0.
/// @param p_base, arclength_m of each on the backbone; in the order of arclength
std::optional<BodyOrder> other_order(const std::vector<Eigen::Vector3d>& p_base,
                                     const std::vector<double>& arclength_m);

}  // namespace softarm::arm
