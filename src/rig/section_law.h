// What a section of the rod answers to bending beyond linear elasticity: a law, perhaps with a memory.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace softarm::rig {

/// One section over one step of time. Bending vectors are (u_x, u_y) in the section frame: bending towards
/// phi is along (-sin phi, cos phi).
struct SectionStep {
  Eigen::Vector2d curvature = Eigen::Vector2d::Zero(), last_curvature = Eigen::Vector2d::Zero();  ///< 1/m
  double dt_s = 0.0;           ///< 0: statics, come slowly from the straight state and rested for ever
  double stiffness_nm2 = 0.0;  ///< EI of the section, core included
  /// The part of it that a jammed core gives.
  double core_stiffness_nm2 = 0.0, last_core_stiffness_nm2 = 0.0;

  // Of a stretch that answers as a whole (RodPiece::stretch) alone; the curvatures are then its means.
  double length_m = 0.0;
  Eigen::Vector2d driven_per_m = Eigen::Vector2d::Zero();  ///< what its actuation alone bends it to
  Eigen::Vector2d lag_per_m = Eigen::Vector2d::Zero();     ///< retardation times the curvature's rate
  double lag_slope = 0.0;                                  ///< derivative of the lag by the curvature
  /// Likewise by the curvatures of the three instants before, the latest first.
  std::array<double, 3> lag_past{};
};

/// What laws add to the linear moment EI * curvature.
struct SectionResponse {
  Eigen::Vector2d moment_nm = Eigen::Vector2d::Zero();
  Eigen::Matrix2d tangent_nm2 = Eigen::Matrix2d::Zero();  ///< its derivative by the curvature
  double stored_j_per_m = 0.0;                            ///< beyond EI * curvature^2 / 2
};

/// A law, the same along a piece of the rod. Its memory advances once per step, along the straight path from
/// the last curvature to the present one; Newton's method asks many times with the same `before`. Passive:
/// over a closed path it gives back no more energy than it took.
class SectionLaw {
 public:
  virtual ~SectionLaw() = default;
  /// Numbers that a section remembers; they start at 0.
  virtual std::size_t memory_size() const { return 0; }
  /// Adds to a response. @param before what is remembered at the start of the step @param after at its end
  virtual void add(const SectionStep& step, const double* before, double* after,
                   SectionResponse& response) const = 0;
};

}  // namespace softarm::rig
