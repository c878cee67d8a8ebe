// The word a mistyped one was meant to be.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace softarm::arm::yaml {

/// The word with the fewest edits (insertions, deletions, substitutions) from `word`; nothing if none is
/// near, that is if more than half of its letters would have to change.
std::optional<std::string> nearest_word(const std::string& word, const std::vector<std::string>& words);

}  // namespace softarm::arm::yaml
