// Measures the virtual rig's own error: against finer elements, against smaller steps, and, at rest, against
// the statics of rod/; or that of every effect that can be hidden. Writes CSV.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <string>
#include <vector>

#include "rig_accuracy/convergence.h"
#include "rig_accuracy/effects.h"

int main(int argc, char** argv) {
  softarm::rig_accuracy::ConvergenceOptions options;
  options.config = std::string(SOFTARM_SOURCE_DIR) + "/config";
  bool effects = false;
  std::vector<std::string> only;
  CLI::App program{"The virtual rig's own numerical error, as CSV.", "rig_accuracy"};
  program.add_option("--config", options.config, "folder with arms/ and scenarios/");
  program.add_option("--seconds", options.seconds, "of each scenario (default 10)")
      ->check(CLI::Range(1.0, 1e4));
  CLI::Option* poses = program.add_option("--poses", options.poses, "compared with rod/ (default 200)")
                           ->check(CLI::Range(1, 1000000));
  CLI::Option* seed = program.add_option("--seed", options.seed, "of the poses (default 1)");
  program
      .add_flag("--effects", effects,
                "instead: error, size and speed of every effect that can be hidden, in each of its forms")
      ->excludes(poses)
      ->excludes(seed);
  program.add_option("--only", only, "of the effects, only these")->needs("--effects");
  CLI11_PARSE(program, argc, argv);
  try {
    if (effects) return softarm::rig_accuracy::measure_effects({options.config, options.seconds, only});
    return softarm::rig_accuracy::measure_convergence(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "rig_accuracy: {}\n", error.what());
    return 1;
  }
}
