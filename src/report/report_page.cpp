#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "page_data.h"
#include "softarm/report/report.h"

namespace softarm::report {
namespace {

constexpr const char* kPage = "page.html";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

/// Text for an element or an attribute.
std::string escaped(std::string text) {
  for (const auto& [what, by] : {std::pair{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}})
    text = replaced(text, what, by);
  return text;
}

/// JSON that stays inside its <script>: these characters occur in JSON's strings only, where \u stands for
/// them too.
std::string inside_script(std::string json) {
  for (const auto& [what, by] : {std::pair{"<", "\\u003c"},
                                 {">", "\\u003e"},
                                 {"&", "\\u0026"},
                                 {"\xE2\x80\xA8", "\\u2028"},
                                 {"\xE2\x80\xA9", "\\u2029"}})
    json = replaced(json, what, by);
  return json;
}

/// A script's own text must not end its element; in strings and regular expressions a backslash more changes
/// nothing.
std::string inside_script_code(std::string code) {
  return replaced(replaced(std::move(code), "</script", "<\\/script"), "<!--", "<\\!--");
}

/// A word that who wrote a name into a bag cannot know: of everything that is in the page (FNV-1a).
std::string nonce_of(const std::string& data) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : data) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return fmt::format("{:016x}", hash);
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// Valid UTF-8, whatever was read.
std::string as_utf8(const std::string& text) {
  return Json::parse(dump(Json(text), -1)).get<std::string>();
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

PageFiles read_page_files(const std::filesystem::path& folder) {
  PageFiles files;
  files[kPage] = read(folder / kPage);
  filled_in(files[kPage], [&](const std::string& place) {
    if (is_file(place) && (place != kPlotly || std::filesystem::exists(folder / place)))
      files[place] = read(folder / place);
    return "";
  });
  return files;
}

std::string to_html(const diagnose::Diagnosis& diagnosis, const PageFiles& files, const Origin& origin) {
  const auto page = files.find(kPage);
  if (page == files.end()) throw std::invalid_argument("the report's page.html is missing");
  const std::string data = inside_script(dump(page_data(diagnosis, origin), -1));
  const std::string nonce = nonce_of(data);
  return filled_in(page->second, [&](const std::string& place) -> std::string {
    if (place == "title") return escaped(as_utf8(diagnosis.arm));
    if (place == "text") return escaped(as_utf8(describe(diagnosis)));
    if (place == "data") return data;
    if (place == "nonce") return nonce;
    const auto file = files.find(place);
    if (file != files.end()) return ends_with(place, ".js") ? inside_script_code(file->second) : file->second;
    if (place == kPlotly) return "";
    throw std::invalid_argument(fmt::format("page.html: nothing fills in {{{{{}}}}}", place));
  });
}

}  // namespace softarm::report
