// A program run in a process of its own.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace softarm::app::batch {

/// What became of a process.
struct ChildEnd {
  bool stopped = false;     ///< because it was asked to
  int exit_status = -1;     ///< -1: a signal ended it
  int signal = 0;           ///< which
  double seconds = 0.0;     ///< on the clock
  double core_seconds = 0;  ///< of all cores
  double peak_memory_bytes = 0;
};

/// Runs a program to its end. It is in a process group of its own, so that a terminal's Ctrl-C does not reach
/// it, and is ended with this process, whatever ends that.
/// @param words the program's path and its arguments
/// @param log where what it says goes; made anew
/// @param stop asked some times a second; once true, the child is ended
/// @throws Failure if it cannot be started
ChildEnd run_child(const std::vector<std::string>& words, const std::filesystem::path& log,
                   const std::function<bool()>& stop);

/// What a program says on its standard output. @return whether it ended with 0
bool run_and_read(const std::vector<std::string>& words, std::string& out, std::string& error);

/// Where a program is found on PATH; empty: it is not.
std::string on_path(const std::string& program);

}  // namespace softarm::app::batch
