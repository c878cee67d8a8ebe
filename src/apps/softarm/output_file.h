// Files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "removed_on_signal.h"

namespace softarm::app {

/// Which results of other runs an output may take the place of.
struct Replacing {
  bool all = true;
  std::string
      command;  ///< what this run is; otherwise its own results alone, if nobody has changed them since

  /// For a command with the flag --force: the very same command may be run again.
  static Replacing of_this_run(bool force);
};

/// A file written under a temporary name beside its place and renamed when it is complete. A link is
/// followed: it stays, and the file that it names is written.
///
/// Destroyed before commit(), it leaves nothing behind: an error half way never leaves half an output, nor
/// does SIGINT, SIGTERM or SIGHUP that ends the program. What a process that was killed left beside the place
/// is removed.
///
/// A device, a pipe and what a process has open (/dev/stdout) is written straight to: it must not be
/// replaced.
class OutputFile {
 public:
  /// @throws Failure if the folder is missing, the path is a folder or a file that may not be replaced
  explicit OutputFile(std::filesystem::path path, Replacing replacing = {});
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Where to write until commit().
  const std::filesystem::path& temporary() const { return temporary_; }
  const std::filesystem::path& path() const { return path_; }

  /// The whole text. @throws Failure if it cannot be written: "...: cannot be written: No space left on
  /// device"
  void write(const std::string& text);
  /// @throws Failure if it cannot be renamed
  void commit();

 private:
  std::filesystem::path path_;   // as told
  std::filesystem::path place_;  // what it names; empty where that is written straight to
  std::filesystem::path temporary_;
  std::optional<RemovedOnSignal> unfinished_;
  Replacing replacing_;
  bool committed_ = false;
};

/// @throws Failure if the file is there and may not be replaced: what OutputFile does, before it is time to
/// write
void refuse_to_replace(const std::filesystem::path& path, const Replacing& replacing);

/// A folder that is removed again, with those above it that were made, if nothing comes to stand in it; where
/// a signal ends the program, too.
class ResultsFolder {
 public:
  /// @throws Failure if it cannot be made
  explicit ResultsFolder(const std::filesystem::path& path);
  ~ResultsFolder();
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  // the deepest first
  std::list<RemovedOnSignal> empty_;         // the deepest last
};

/// Closes what was written to a file. @throws Failure with the reason where not all of it was
void finish(std::ofstream& stream, const std::filesystem::path& path);
void write_text(const std::filesystem::path& path, const std::string& text);

/// Whole text of a file. @throws Failure if it cannot be read
std::string read_text(const std::filesystem::path& path);

/// Lower-case hexadecimal SHA-256 of a file. @throws Failure if it cannot be read
std::string sha256_of_file(const std::filesystem::path& path);
std::string sha256_of_text(const std::string& text);

}  // namespace softarm::app
