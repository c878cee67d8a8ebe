// Who runs the jobs of a batch.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "job_folder.h"

namespace softarm::app::batch {

/// What is to be run, and what to tell meanwhile.
struct Run {
  std::filesystem::path out;    ///< the batch's folder
  std::string program;          ///< the path of `softarm`
  std::vector<JobFolder> jobs;  ///< with their orders written
  unsigned at_a_time = 0;       ///< local: 0: as many as there are cores; Slurm: 0: as many as it gives
  unsigned threads = 0;         ///< of each job; 0: what is left of the cores
  std::vector<std::string> slurm_options;
  bool wait = true;  ///< Slurm: until all have ended

  /// Called from any thread: a job runs; it has ended; some time has passed.
  std::function<void(std::size_t job)> on_begin;
  std::function<void(std::size_t job, const Outcome&)> on_end;
  std::function<void()> on_tick;
  std::function<void(const std::string& why)> on_waiting;  ///< what jobs wait for
  std::function<void(const std::string& line)> say;
};

/// In processes of this machine. Ends early where a signal was kept.
void run_local(const Run& run);

/// As arrays of Slurm, those of an earlier run that are still in its queue included.
/// @throws Failure if Slurm cannot be asked, or takes no job
void run_slurm(const Run& run);

/// Jobs of this batch that are still in Slurm's queue; 0 also where there is no Slurm here.
std::size_t left_in_slurm(const std::filesystem::path& out);

}  // namespace softarm::app::batch
