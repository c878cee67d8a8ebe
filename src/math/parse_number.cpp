#include "parse_number.h"

#include <locale.h>

#include <cstdlib>

namespace softarm::math {

std::optional<double> parse_number(const std::string& text) {
  static const locale_t kPlain = newlocale(LC_ALL_MASK, "C", nullptr);
  // strtod would pass over blanks, and reads hexadecimal numbers, which nobody writes.
  if (text.empty() || text.find_first_of(" \t\r\n\f\vxX") != std::string::npos) return std::nullopt;
  char* end = nullptr;
  const double value = strtod_l(text.c_str(), &end, kPlain);
  if (end != text.c_str() + text.size()) return std::nullopt;
  return value;
}

}  // namespace softarm::math
