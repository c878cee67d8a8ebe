#include "page_text.h"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "json.h"

namespace softarm::report {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

/// A script's own text must not end its element; in strings and regular expressions a backslash more changes
/// nothing.
std::string inside_script_code(std::string code) {
  return replaced(replaced(std::move(code), "</script", "<\\/script"), "<!--", "<\\!--");
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// Calls found(name) for each {{name}} and puts what it returns in its place; once, from left to right: what
/// is put in is not looked at again.
template <class Found>
std::string filled_in(const std::string& page, Found found) {
  std::string text;
  std::size_t done = 0;
  for (std::size_t open = page.find("{{"); open != std::string::npos; open = page.find("{{", done)) {
    const std::size_t close = page.find("}}", open);
    if (close == std::string::npos) break;
    text.append(page, done, open - done);
    text += found(page.substr(open + 2, close - open - 2));
    done = close + 2;
  }
  return text.append(page, done, std::string::npos);
}

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file || text.fail()) throw std::runtime_error(path.string() + ": cannot be read");
  return text.str();
}

bool is_file(const std::string& place) {
  return ends_with(place, ".css") || ends_with(place, ".js");
}

}  // namespace

std::string escaped(std::string text) {
  for (const auto& [what, by] : {std::pair{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}})
    text = replaced(text, what, by);
  return text;
}

std::string inside_script(std::string json) {
  for (const auto& [what, by] : {std::pair{"<", "\\u003c"},
                                 {">", "\\u003e"},
                                 {"&", "\\u0026"},
                                 {"\xE2\x80\xA8", "\\u2028"},
                                 {"\xE2\x80\xA9", "\\u2029"}})
    json = replaced(json, what, by);
  return json;
}

std::string nonce_of(const std::string& data) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : data) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return fmt::format("{:016x}", hash);
}

std::string as_utf8(const std::string& text) {
  return Json::parse(dump(Json(text), -1)).get<std::string>();
}

PageFiles read_page(const std::filesystem::path& folder, const std::string& page) {
  PageFiles files;
  files[page] = read(folder / page);
  filled_in(files[page], [&](const std::string& place) {
    if (is_file(place) && (place != kPlotly || std::filesystem::exists(folder / place)))
      files[place] = read(folder / place);
    return "";
  });
  return files;
}

std::string filled_page(const PageFiles& files, const std::string& page,
                        const std::function<std::optional<std::string>(const std::string& place)>& fill_in) {
  const auto text = files.find(page);
  if (text == files.end()) throw std::invalid_argument(fmt::format("the page {} is missing", page));
  return filled_in(text->second, [&](const std::string& place) -> std::string {
    if (const std::optional<std::string> filling = fill_in(place)) return *filling;
    const auto file = files.find(place);
    if (file != files.end()) return ends_with(place, ".js") ? inside_script_code(file->second) : file->second;
    if (place == kPlotly) return "";
    throw std::invalid_argument(fmt::format("{}: nothing fills in {{{{{}}}}}", page, place));
  });
}

}  // namespace softarm::report
