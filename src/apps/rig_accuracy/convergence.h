// The virtual rig's error of the shipped scenarios: of elements, of the time step, against the statics of
// rod/.
#pragma once

#include <cstdint>
#include <string>

namespace softarm::rig_accuracy {

struct ConvergenceOptions {
  std::string config;  ///< folder with arms/ and scenarios/
  double seconds = 10.0;
  int poses = 200;
  std::uint64_t seed = 1;
};

/// Prints CSV (kind,scenario,value,worst_mm,rms_mm) on standard output and a verdict per scenario on standard
/// error.
/// @return exit status: 0 only where all are within kAllowed_mm. @throws std::exception
int measure_convergence(const ConvergenceOptions& options);

}  // namespace softarm::rig_accuracy
