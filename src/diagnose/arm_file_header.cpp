#include "arm_file_header.h"

#include <fmt/format.h>

#include <algorithm>

namespace softarm::diagnose {

std::vector<std::string> arm_file_header(const Diagnosis& diagnosis,
                                         const std::vector<trial::Trial>& trials) {
  std::string names;
  for (const trial::Trial& trial : trials) names += (names.empty() ? "" : ", ") + trial.name;
  std::vector<std::string> lines{"constants and effects fitted together to the trials " + names};
  lines.push_back(fmt::format("verdict: {}; mean error on unseen trials {:.3g} mm, before {:.3g} mm",
                              to_string(diagnosis.verdict), 1e3 * diagnosis.extended.held_out_mean_m,
                              1e3 * diagnosis.baseline.held_out_mean_m));
  for (const NamedEffect& effect : diagnosis.effects)
    lines.push_back(
        fmt::format("{} ({:.0f} %): {}", effect.id, 100.0 * effect.probability, effect.description));
  if (diagnosis.discovered_law) lines.push_back("learned_moment: " + diagnosis.discovered_law->sentence);
  // Names of files may hold anything; a comment ends with its line.
  for (std::string& line : lines)
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return lines;
}

}  // namespace softarm::diagnose
