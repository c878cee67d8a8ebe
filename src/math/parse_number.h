// Text to a number.
#pragma once

#include <optional>
#include <string>

namespace softarm::math {

/// The number that the whole text is, decimal or scientific, whatever the locale. "inf" and "nan" are
/// numbers, what is too large for a double is infinite. (std::from_chars for double needs g++ 11.)
std::optional<double> parse_number(const std::string& text);

}  // namespace softarm::math
