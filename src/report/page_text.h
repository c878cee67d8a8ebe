// What the pages of this room are made of: files with {{places}} that are filled in.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "softarm/report/report.h"

namespace softarm::report {

/// Text for an element or an attribute.
std::string escaped(std::string text);

/// JSON that stays inside its <script>: these characters occur in JSON's strings only, where \u stands for
/// them too.
std::string inside_script(std::string json);

/// A word that who wrote a name into a bag cannot know: of everything that is in the page (FNV-1a).
std::string nonce_of(const std::string& data);

/// Valid UTF-8, whatever was read.
std::string as_utf8(const std::string& text);

/// A page and the style sheets and scripts that it names, out of a folder; the plotting library only where it
/// is there.
/// @throws std::runtime_error naming the file that cannot be read
PageFiles read_page(const std::filesystem::path& folder, const std::string& page);

/// The page with its {{places}} filled in, from left to right; what is put in is not looked at again. Files
/// go in as they are, all other places by fill_in(place).
/// @throws std::invalid_argument if the page is not among the files, or fill_in returns nothing for a place
std::string filled_page(const PageFiles& files, const std::string& page,
                        const std::function<std::optional<std::string>(const std::string& place)>& fill_in);

}  // namespace softarm::report
