// What goes to the standard output.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

namespace softarm::app {

/// Prints it. Control characters in it, which a terminal would obey, come from names of files and topics:
/// they are shown, as \x1b; line ends and tabs stay.
void say_text(const std::string& text);

/// As fmt::print().
template <typename Format, typename... Args>
void say(const Format& format, Args&&... args) {
  say_text(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace softarm::app
