// One line of a batch: a command over the bags of one arm.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace softarm::app::batch {

/// An option of the command, as it is typed.
struct Word {
  std::string name;                  ///< "--payload"
  std::optional<std::string> value;  ///< absent: a flag
};

/// What is to be run; all paths absolute, so that it means the same on every machine.
struct Job {
  std::string work;  ///< estimate, diagnose or check
  std::string arm;
  std::vector<std::string> bags;
  std::vector<Word> options;
  std::string wanted_name;  ///< what its folder would be called
};

inline bool same_options(const Job& a, const Job& b) {
  if (a.options.size() != b.options.size()) return false;
  for (std::size_t i = 0; i < a.options.size(); ++i)
    if (a.options[i].name != b.options[i].name || a.options[i].value != b.options[i].value) return false;
  return true;
}

inline bool same_command(const Job& a, const Job& b) {
  return a.work == b.work && a.arm == b.arm && same_options(a, b);
}

inline bool operator==(const Job& a, const Job& b) {
  return same_command(a, b) && a.bags == b.bags;
}

}  // namespace softarm::app::batch
