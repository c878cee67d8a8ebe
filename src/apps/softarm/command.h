// The subcommands of `softarm`: each adds itself to the program's command line.
#pragma once

#include <CLI/CLI.hpp>
#include <stdexcept>

namespace softarm::app {

/// Anything that ends the program: what() is the one line that the user reads.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

void add_campaign(CLI::App& program);
void add_estimate(CLI::App& program);
void add_identify(CLI::App& program);
void add_import(CLI::App& program);
void add_simulate(CLI::App& program);
void add_validate(CLI::App& program);

}  // namespace softarm::app
