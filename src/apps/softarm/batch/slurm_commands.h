// What is asked of Slurm, by its own commands.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace softarm::app::batch {

/// A job of an array in Slurm's queue.
struct SlurmTask {
  std::string array_name;  ///< the job's name
  std::string array_id;
  std::size_t index = 0;
  std::string state;   ///< "PD", "R", ...
  std::string reason;  ///< why it waits
};

/// @throws Failure where a command is not on PATH, or Slurm does not answer
void require_slurm();

/// The tasks of these arrays that are in the queue, whether they wait, run or are held; nothing where Slurm
/// does not answer, with its reason in `error`.
std::optional<std::vector<SlurmTask>> slurm_queue(const std::vector<std::string>& array_names,
                                                  std::string& error);
/// The lines of squeue. What is no such line is left out.
std::vector<SlurmTask> parse_queue(const std::string& lines);

/// Largest number of tasks in one array.
std::size_t slurm_array_limit();

/// @return the array's id. @throws Failure with what Slurm says
std::string submit_array(const std::vector<std::string>& sbatch_words);

void cancel_arrays(const std::vector<std::string>& ids);

/// What Slurm says became of a task: "TIMEOUT (TimeLimit)"; empty where it has forgotten it.
std::string slurm_end(const std::string& array_id, std::size_t index);
/// The same, of what `scontrol show job` says.
std::string parse_end(const std::string& shown);

}  // namespace softarm::app::batch
