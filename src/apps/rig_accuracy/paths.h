// Where the rings of a simulated arm were, and how far two simulations are apart.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "rig/simulator.h"

namespace softarm::rig_accuracy {

/// Error that the rig may have.
constexpr double kAllowed_mm = 0.02;

/// @return the text of a file. @throws std::runtime_error
std::string read(const std::string& path);

/// Distances of points from where they should be, mm.
struct Errors {
  double worst = 0.0, squares = 0.0;
  std::size_t count = 0;
  void add(const Eigen::Vector3d& p, const Eigen::Vector3d& should_be);
  double rms() const;
};

/// Positions of the rings in the base frame, frame by frame.
using Path = std::vector<std::vector<Eigen::Vector3d>>;

std::vector<Eigen::Vector3d> rings_of(const rig::Sample& sample);

/// Where the rings really were with the scenario's or with other numerics.
Path rings(rig::Scenario scenario, double seconds, int elements, double step_s);

Errors compare(const Path& path, const Path& reference);

/// The step that the simulator takes: frames are whole numbers of steps.
double step_of(const rig::Scenario& scenario);

}  // namespace softarm::rig_accuracy
