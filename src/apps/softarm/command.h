// The subcommands of `softarm`: each adds itself to the program's command line.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>

namespace CLI {
class App;
}

namespace softarm::app {

/// Anything that ends the program: what() is the one line that the user reads.
class Failure : public std::runtime_error {
 public:
  explicit Failure(const std::string& what, int exit_status = 1)
      : std::runtime_error(what), status(exit_status) {}
  int status;  ///< exit status
};

/// What the flag --force does, of every command that writes results.
constexpr char kForceMeaning[] =
    "replace results of other runs; those of the very same command are replaced anyway, unless they were "
    "changed";

/// Ends the program with a status when all has been said.
struct Ended : std::exception {
  explicit Ended(int exit_status) : status(exit_status) {}
  int status;
};

/// Comes behind the commands that it runs.
void add_batch(CLI::App& program);
void add_campaign(CLI::App& program);
void add_check(CLI::App& program);
/// Comes last: it completes what the others added.
void add_completion(CLI::App& program);
void add_diagnose(CLI::App& program);
void add_estimate(CLI::App& program);
void add_identify(CLI::App& program);
void add_import(CLI::App& program);
void add_new_arm(CLI::App& program);
void add_simulate(CLI::App& program);
void add_validate(CLI::App& program);

}  // namespace softarm::app
