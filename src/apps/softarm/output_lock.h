// One writer in a place at a time.
#pragma once

#include <filesystem>
#include <string>

namespace softarm::app {

/// Locked as long as its process lives: what a killed one left is not locked any more.
class OutputLock {
 public:
  /// @param path a folder that is there, or a file that is made where it is not
  /// @param held what to say where somebody else has it
  /// @throws Failure with that, or if it cannot be opened
  OutputLock(const std::filesystem::path& path, const std::string& held);
  ~OutputLock();
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace softarm::app
