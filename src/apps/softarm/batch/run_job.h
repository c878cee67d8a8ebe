// One job from its order to its outcome, on the machine where this runs.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "job_folder.h"

namespace softarm::app::batch {

/// Runs what the folder's job.json orders, and writes outcome.json.
/// @param program the path of `softarm`
/// @param threads that the command may use
/// @param stop once true, the job is given up
/// @return nothing where it was given up: then the folder holds no outcome
/// @throws Failure if the folder has no order or cannot be written
std::optional<Outcome> run_job(const JobFolder& folder, const std::string& program, unsigned threads,
                               const std::function<bool()>& stop);

/// What a command says why it failed, out of its log: one line.
std::string reason_in(const std::string& log);

/// As one line of a terminal and of a table: control characters and what is too long are left out.
std::string as_one_line(std::string text);

}  // namespace softarm::app::batch
