#include "find_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace softarm::report {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw std::runtime_error(path.string() + ": cannot be read");
  return text.str();
}

}  // namespace

FoundPage find_page(const std::vector<std::string>& folders) {
  FoundPage page;
  for (const std::string& folder : folders) {
    if (page.files.empty() && is_there(fs::path(folder) / "page.html")) page.files = read_page_files(folder);
  }
  if (page.files.empty())
    throw std::runtime_error(fmt::format("report/page.html: not found in {}; install softarm_estimator again",
                                         fmt::join(folders, ", ")));

  // The build's own first; Debian's is the same, only larger.
  std::vector<fs::path> places;
  for (const std::string& folder : folders) places.push_back(fs::path(folder) / kPlotly);
  places.emplace_back("/usr/share/python3-plotly/plotly.js");
  for (const fs::path& place : places) {
    if (page.files.count(kPlotly) == 0 && is_there(place)) page.files[kPlotly] = text_of(place);
  }
  if (page.files.count(kPlotly) == 0)
    page.warning =
        "report.html has no plots, because plotly.js was not found; to have them: apt-get install "
        "python3-plotly";
  return page;
}

}  // namespace softarm::report
