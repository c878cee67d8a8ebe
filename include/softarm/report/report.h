// A diagnosis as one web page that needs nothing else: no network, no other file.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "softarm/diagnose/diagnose.h"
#include "softarm/export.h"

namespace softarm::report {

/// Where a report comes from; what is not known is empty.
struct Origin {
  std::string command;                                      ///< as a shell would take it
  std::string date;                                         ///< ISO 8601, UTC
  std::vector<std::pair<std::string, std::string>> sha256;  ///< of the arm file and the bags, by their names
};

/// For the terminal: sentences and a short table.
SOFTARM_EXPORT std::string describe(const diagnose::Diagnosis& diagnosis);
/// report.json as doc/diagnose.md has it.
SOFTARM_EXPORT std::string to_json(const diagnose::Diagnosis& diagnosis, const Origin& origin = {});

/// What the page is made of, by file name: page.html, and the style sheets and scripts that it names.
using PageFiles = std::map<std::string, std::string>;

/// Name under which PageFiles holds the plotting library; the page does without it, then it has tables only.
inline constexpr const char* kPlotly = "plotly.min.js";

/// The page's files out of a folder (config/report), where it has it the plotting library too.
/// @throws std::runtime_error naming the file if one that page.html names cannot be read
SOFTARM_EXPORT PageFiles read_page_files(const std::filesystem::path& folder);

/// report.html.
///
/// page.html is copied with its {{places}} filled in: {{name.css}} and {{name.js}} by these files, {{title}}
/// and
/// {{text}} by what describe() says, {{data}} by the diagnosis as JSON, {{nonce}} by a word that marks the
/// page's own scripts, so that the page's policy keeps any other from running. Nothing that comes out of bags
/// and files can end a script or be taken for HTML: it is data, and the scripts show it as text.
/// @throws std::invalid_argument if page.html has a place that nothing fills
SOFTARM_EXPORT std::string to_html(const diagnose::Diagnosis& diagnosis, const PageFiles& files,
                                   const Origin& origin = {});

}  // namespace softarm::report
