#include "say.h"

#include <cstdio>
#include <iterator>

namespace softarm::app {

void say_text(const std::string& text) {
  std::string shown;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool obeyed = (byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7f;
    if (obeyed)
      fmt::format_to(std::back_inserter(shown), "\\x{:02x}", byte);
    else
      shown += c;
  }
  fmt::print("{}", shown);
}

}  // namespace softarm::app
