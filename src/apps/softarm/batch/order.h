// A batch as a whole: which jobs, where to, by which engine.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "job.h"

namespace softarm::app::batch {

/// Of the batch as a whole, as they are typed.
struct OrderOptions {
  std::string engine = "local", out = "batch";
  unsigned jobs = 0, threads = 0;
  bool retry_failed = false, force = false, no_wait = false;
  std::string slurm_options;
};

/// What a batch as a whole is asked for.
struct Order {
  std::string work;
  OrderOptions options;
  std::vector<Job> jobs;
  std::filesystem::path out;
  std::string program;
};

/// Runs what is to be done of it, and gathers the results of all of it.
/// @throws Failure where it cannot begin; Ended with the exit status where jobs failed
void run(Order order);

}  // namespace softarm::app::batch
