// Findings as text and as JSON.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "context.h"
#include "softarm/check/check.h"

namespace softarm::check {
namespace {

using nlohmann::ordered_json;

/// Breaks a sentence into lines with an indent.
std::string wrapped(const std::string& text, std::size_t indent) {
  constexpr std::size_t kWidth = 110;
  std::string out, line(indent, ' ');
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t space = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, space - at);
    if (line.size() > indent && line.size() + 1 + word.size() > kWidth) {
      out += line + "\n";
      line.assign(indent, ' ');
    }
    if (line.size() > indent) line += ' ';
    line += word;
    at = space + 1;
  }
  return out + line + "\n";
}

ordered_json json_of(const CheckFinding& f) {
  ordered_json j;
  j["severity"] = to_string(f.severity);
  j["id"] = f.id;
  j["where"] = f.where;
  j["what"] = f.what;
  j["spans_s"] = ordered_json::array();
  for (const CheckSpan& s : f.spans) j["spans_s"].push_back({s.from_s, s.to_s});
  if (f.figure) {
    j["figure"] = *f.figure;
    j["unit"] = f.unit;
  }
  if (f.figure_sd) j["figure_sd"] = *f.figure_sd;
  if (!f.remedy.empty()) j["remedy"] = f.remedy;
  if (!f.setting.empty()) j["setting"] = f.setting;
  return j;
}

ordered_json json_of(const CheckStream& s) {
  ordered_json j;
  j["name"] = s.name;
  j["kind"] = s.is_body ? "body" : "input";
  j["samples"] = s.samples;
  j["rate_hz"] = s.rate_hz;
  if (s.rest_level) j["rest_level"] = *s.rest_level;
  if (s.noise_sd) j["noise_sd"] = *s.noise_sd;
  return j;
}

std::string lines_of(const CheckFinding& f, bool with_information) {
  if (f.severity == Severity::kInformation && !with_information) return "";
  const std::string when = description(f.spans);
  std::string text =
      wrapped(fmt::format("{:<12}{}{}{}{}", to_string(f.severity), f.where, f.where.empty() ? "" : ": ",
                          f.what, when.empty() ? "" : "; at " + when),
              2);
  if (f.severity == Severity::kInformation) return text;
  if (!f.remedy.empty()) text += wrapped("remedy: " + f.remedy, 14);
  if (!f.setting.empty()) text += wrapped("setting: " + f.setting, 14);
  return text;
}

}  // namespace

std::string to_string(Severity severity) {
  switch (severity) {
    case Severity::kInformation:
      return "information";
    case Severity::kWarning:
      return "warning";
    case Severity::kSerious:
      return "serious";
  }
  throw std::logic_error("severity without a word");
}

std::string to_text(const CheckReport& report, bool with_information) {
  int serious = 0, warnings = 0;
  for (const CheckFinding& f : report.findings) {
    serious += f.severity == Severity::kSerious;
    warnings += f.severity == Severity::kWarning;
  }
  std::string text =
      fmt::format("{}: {:.1f} s, {}\n", report.name, report.duration_s,
                  serious + warnings == 0 ? "nothing wrong was found"
                                          : fmt::format("{} serious, {} to look at", serious, warnings));
  for (const CheckFinding& f : report.findings) text += lines_of(f, with_information);
  return text;
}

std::string to_text(const std::vector<CheckFinding>& together, std::size_t recordings,
                    bool with_information) {
  std::string text;
  for (const CheckFinding& f : together) text += lines_of(f, with_information);
  return text.empty() ? "" : fmt::format("all {} recordings together:\n", recordings) + text;
}

std::string to_text(const std::vector<CheckReport>& reports, const std::vector<CheckFinding>& together,
                    bool with_information) {
  std::string text;
  for (const CheckReport& report : reports)
    text += (text.empty() ? "" : "\n") + to_text(report, with_information);
  const std::string of_all = to_text(together, reports.size(), with_information);
  return of_all.empty() ? text : text + "\n" + of_all;
}

CheckReport unreadable(const std::string& name, const std::string& why) {
  CheckReport report;
  report.name = name;
  CheckFinding finding;
  finding.severity = Severity::kSerious;
  finding.id = "unreadable";
  finding.what = why;
  finding.remedy = "rosbag reindex saves what a killed recorder left; otherwise record again";
  report.findings.push_back(finding);
  return report;
}

std::string to_json(const std::vector<CheckReport>& reports, const std::string& arm,
                    const std::vector<CheckFinding>& together) {
  ordered_json document;
  document["format"] = 1;
  document["arm"] = arm;
  document["recordings"] = ordered_json::array();
  for (const CheckReport& report : reports) {
    ordered_json j;
    j["name"] = report.name;
    j["duration_s"] = report.duration_s;
    j["worst"] = report.worst() ? to_string(*report.worst()) : "none";
    j["streams"] = ordered_json::array();
    for (const CheckStream& s : report.streams) j["streams"].push_back(json_of(s));
    j["findings"] = ordered_json::array();
    for (const CheckFinding& f : report.findings) j["findings"].push_back(json_of(f));
    document["recordings"].push_back(std::move(j));
  }
  if (reports.size() > 1) {
    document["together"] = ordered_json::array();
    for (const CheckFinding& f : together) document["together"].push_back(json_of(f));
  }
  return document.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace softarm::check
