// Bytes as a file, for readers that want one.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace softarm::fuzz {

/// In the folder for temporary files; removed at the end.
class ScratchFile {
 public:
  ScratchFile(const std::string& name, const char* bytes, std::size_t size)
      : path_(std::filesystem::temp_directory_path() / fmt::format("softarm_fuzz_{}_{}", getpid(), name)) {
    std::ofstream(path_, std::ios::binary).write(bytes, static_cast<std::streamsize>(size));
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile() {
    std::error_code error;
    std::filesystem::remove(path_, error);
  }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace softarm::fuzz
