// From what is commanded to what acts in each segment of the true arm.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "protocol.h"
#include "scenario.h"

namespace softarm::rig {

/// What acts in one segment.
struct Acting : Commands {
  Acting() = default;
  /// As commanded: the ideal.
  Acting(const Commands& commands)  // NOLINT: commands act as they are
      : Commands(commands), jamming_pa(commands.vacuum_pa) {}

  double jamming_pa = 0.0;  ///< the vacuum that the stiffness of the granules goes by
  /// How much less or more the tensions are at the segment's end than at its begin, per tendon; empty: not.
  std::vector<double> tension_change_n;
  double gain_scale = 1.0;       ///< of the moments of all actuators
  double stiffness_scale = 1.0;  ///< of all stiffnesses of the material
  double length_scale = 1.0;
  int segment = 0;        ///< its number, from 0
  double bend_rad = 0.0;  ///< the angle by which it is bent, where that matters
  /// By which all segments before it are bent together, towards x and y of the section, where that matters.
  Eigen::Vector2d bent_before_rad = Eigen::Vector2d::Zero();
};

/// How far a segment is bent: integrals along it.
struct Bend {
  double rad = 0.0;                                       ///< of the size of its curvature
  Eigen::Vector2d towards_rad = Eigen::Vector2d::Zero();  ///< of its parts towards x and y of the section
};

/// Regulators, lines, tendons and memory of a scenario (InputPathSpec).
///
/// Pressures pass, in this order: delay of the line, droop and ripple of the supply, regulator, valve, slew
/// limit, lag of the line, leaks, hysteresis. Tensions: hysteresis, then friction from segment to segment.
/// Angles: hysteresis. Where nothing is hidden, what acts is exactly what is commanded.
class InputPath {
 public:
  /// @param start commanded at t = 0, where everything has long settled
  InputPath(const Scenario& scenario, const Commands& start);
  ~InputPath();
  InputPath(InputPath&&) noexcept;
  InputPath& operator=(InputPath&&) noexcept;

  /// Whether what acts depends on how the arm is bent.
  bool feels_bending() const;

  /// What acts at a time in each segment, from what is commanded then. It remembers: to be asked in the order
  /// of time, t >= 0; the same time may be asked again. Between two times a command goes straight.
  /// @param bends of each segment; empty: not bent
  std::vector<Acting> act(const Commands& commanded, double t_s, const std::vector<Bend>& bends = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softarm::rig
