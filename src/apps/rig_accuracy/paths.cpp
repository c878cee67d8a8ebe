#include "rig_accuracy/paths.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace softarm::rig_accuracy {

std::string read(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) throw std::runtime_error(path + ": cannot be read");
  return text.str();
}

void Errors::add(const Eigen::Vector3d& p, const Eigen::Vector3d& should_be) {
  const double mm = 1e3 * (p - should_be).norm();
  worst = std::max(worst, mm);
  squares += mm * mm;
  ++count;
}

double Errors::rms() const {
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
}

std::vector<Eigen::Vector3d> rings_of(const rig::Sample& sample) {
  std::vector<Eigen::Vector3d> result;
  for (const rig::Pose& ring : sample.truth.rings_base) result.push_back(ring.p);
  return result;
}

Path rings(rig::Scenario scenario, double seconds, int elements, double step_s) {
  scenario.duration_s = seconds;
  scenario.numerics = {elements, step_s};
  rig::Simulator simulator(scenario);
  Path path;
  while (const auto sample = simulator.next()) path.push_back(rings_of(*sample));
  return path;
}

Errors compare(const Path& path, const Path& reference) {
  Errors errors;
  for (std::size_t k = 0; k < path.size(); ++k)
    for (std::size_t i = 0; i < path[k].size(); ++i) errors.add(path[k][i], reference[k][i]);
  return errors;
}

double step_of(const rig::Scenario& scenario) {
  const double frame_s = 1.0 / scenario.mocap.rate_hz;
  return frame_s / std::ceil(frame_s / scenario.numerics.max_step_s - 1e-9);
}

}  // namespace softarm::rig_accuracy
