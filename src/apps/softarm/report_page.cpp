#include "report_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <stdexcept>
#include <vector>

#include "command.h"
#include "output_file.h"
#include "shipped.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

}  // namespace

ReportPage find_report_page() {
  ReportPage page;
  const std::vector<std::string> folders = config_folders("report");
  for (const std::string& folder : folders) {
    if (!page.files.empty() || !is_there(fs::path(folder) / "page.html")) continue;
    try {
      page.files = report::read_page_files(folder);
    } catch (const std::runtime_error& error) {
      throw Failure(error.what());
    }
  }
  if (page.files.empty())
    throw Failure(fmt::format("report/page.html: not found in {}; install softarm_estimator again",
                              fmt::join(folders, ", ")));

  // The build's own first; Debian's is the same, only larger.
  std::vector<fs::path> places;
  for (const std::string& folder : folders) places.push_back(fs::path(folder) / report::kPlotly);
  places.emplace_back("/usr/share/python3-plotly/plotly.js");
  for (const fs::path& place : places) {
    if (page.files.count(report::kPlotly) == 0 && is_there(place))
      page.files[report::kPlotly] = read_text(place);
  }
  if (page.files.count(report::kPlotly) == 0)
    page.warning =
        "report.html has no plots, because plotly.js was not found; to have them: apt-get install "
        "python3-plotly";
  return page;
}

}  // namespace softarm::app
