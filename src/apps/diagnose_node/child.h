// Another program, run to its end.
#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace softarm::app {

/// How a program ended.
struct Ended {
  int exit_status = -1;
  std::string last_line;  ///< of what it printed: of its errors, or else of its output
};

/// Runs a program with its output and errors going to a file, and waits for it. Ends it when `stop` is set.
/// @throws std::runtime_error in one line if it cannot be started
Ended run_program(const std::string& program, const std::vector<std::string>& arguments,
                  const std::string& log, const std::atomic<bool>& stop);

/// Path of a program beside this one, or its bare name where there is none.
std::string beside_this_program(const std::string& name);

}  // namespace softarm::app
