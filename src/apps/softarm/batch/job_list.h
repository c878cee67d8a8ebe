// What a user names (bags, folders, patterns, lists) to the jobs of a batch.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "job.h"

namespace softarm::app::batch {

struct JobListRequest {
  std::string work;                       ///< estimate, diagnose or check
  std::string arm;                        ///< for jobs whose list names none; may be empty
  std::vector<Word> options;              ///< of all jobs; a list may say otherwise
  std::vector<std::string> inputs;        ///< as typed
  std::map<std::string, bool> has_value;  ///< the options that the command has: whether a value follows
  /// An arm as it was named, and the folder that the name is relative to, to its file; throws Failure.
  std::function<std::string(const std::string& arm, const std::string& folder)> find_arm;
};

/// A job for each bag or, for diagnose, for each folder and each entry of a list; each once, in their order.
/// @throws Failure naming what cannot be
std::vector<Job> list_jobs(const JobListRequest& request);

/// Splits a line as a shell would, without running or filling in anything. A # begins a comment.
/// @throws Failure on an open quote; `place` begins the message
std::vector<std::string> shell_words(const std::string& line, const std::string& place);

/// Words that are options of the command, with their values; what is none goes to `others`.
/// @throws Failure if the command has no such option, or its value is missing
std::vector<Word> take_options(const std::vector<std::string>& words,
                               const std::map<std::string, bool>& has_value, const std::string& place,
                               std::vector<std::string>& others);

}  // namespace softarm::app::batch
