// A job on the disk: what was ordered, what became of it, and whether that still holds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "job.h"

namespace softarm::app::batch {

/// A file that a job has read or written.
struct NotedFile {
  std::string path;
  std::uint64_t size = 0;
  std::int64_t changed_ns = 0;  ///< time of its last change
  std::string sha256;           ///< of what was read; empty for what was written
};

/// What became of a job.
struct Outcome {
  bool done = false;   ///< else failed
  std::string reason;  ///< of a failure, in one line
  std::string version, machine;
  std::string order_sha256;  ///< of what was ordered when it was run
  double seconds = 0.0, core_seconds = 0.0, peak_memory_bytes = 0.0;
  std::vector<NotedFile> inputs, results;
};

/// How a job stands in its folder.
enum class Standing {
  kNew,      ///< not run so far, or not to its end
  kChanged,  ///< what it had read has changed since, or its results have, or another version made them
  kFailed,
  kDone,
};

/// The folder of one job:
///   job.json      what was ordered
///   outcome.json  what became of it, written last
///   log.txt       what the command said
///   result/       what it wrote
class JobFolder {
 public:
  explicit JobFolder(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path& path() const { return path_; }
  std::string name() const { return path_.filename().string(); }
  std::filesystem::path log() const { return path_ / "log.txt"; }
  std::filesystem::path result() const { return path_ / "result"; }

  /// @return nothing where there is none, or none that can be read
  std::optional<Job> order() const;
  /// @throws Failure if it cannot be written, as all below
  void write_order(const Job& job) const;
  std::optional<Outcome> outcome() const;
  void write_outcome(const Outcome& outcome) const;
  /// Takes away what became of it.
  void clear() const;

  /// Looks at the files: by size and time of their last change, and by their digest where one of these
  /// differs.
  Standing standing(const Job& job) const;

 private:
  std::filesystem::path path_;
};

/// Of what is ordered.
std::string digest_of(const Job& job);

/// The arm file and the bags as they are now. @throws Failure naming the one that cannot be read
std::vector<NotedFile> note_inputs(const Job& job);

/// A folder for each job: the one that it had, or a new one. Folders of jobs that are no longer listed stay.
///
/// @param folder of all jobs' folders; need not be there
/// @param force whether a folder of the same bags with another arm file or other options may be taken
/// @throws Failure if there is such a folder and it may not
std::vector<JobFolder> find_folders(const std::filesystem::path& folder, const std::vector<Job>& jobs,
                                    bool force);

/// As a name of a folder: letters, digits, and . _ - within.
std::string plain_name(const std::string& name);

}  // namespace softarm::app::batch
