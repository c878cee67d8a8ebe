#include "figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../command.h"
#include "../output_file.h"

namespace softarm::app::batch {
namespace fs = std::filesystem;

namespace {

using OrderedJson = nlohmann::ordered_json;

/// A line of summary.txt, and what becomes of its number. The indented lines belong to the one before.
struct SummaryLine {
  const char* name;
  const char* column;
  const char* heading;
  double to_si;
  double shown;
  const char* unit;
};

constexpr SummaryLine kSummaryLines[] = {
    {"duration", "duration_s", "duration", 1.0, 1.0, "s"},
    {"frames", "frames", "frames", 1.0, 1.0, ""},
    {"frames ok", "frames_ok", "frames ok", 1.0, 1.0, ""},
    {"rms residual, median", "rms_residual_m", "rms residual", 1e-3, 1e3, "mm"},
    {"reduced chi-square, median", "reduced_chi_square", "reduced chi-square", 1.0, 1.0, ""},
    {"tip angle, median", "tip_angle_rad", "tip angle", 1.0, 180.0 / 3.14159265358979323846, "°"},
    {"M0, median", "M0_nm", "M0", 1.0, 1.0, "N m"},
    {"L, median", "L_m", "L", 1.0, 1e3, "mm"},
    {"EI, median", "EI_nm2", "EI", 1.0, 1.0, "N m²"},
    {"EI, median/identifiable in", "EI_identifiable_frames", "EI identifiable in", 1.0, 1.0, "frames"},
    {"EI, median/median where identifiable", "EI_where_identifiable_nm2", "EI where identifiable", 1.0, 1.0,
     "N m²"},
    {"payload, median", "payload_kg", "payload", 1.0, 1.0, "kg"},
    {"payload, median/identifiable in", "payload_identifiable_frames", "payload identifiable in", 1.0, 1.0,
     "frames"},
    {"payload, median/median where identifiable", "payload_where_identifiable_kg",
     "payload where identifiable", 1.0, 1.0, "kg"},
};

std::optional<double> leading_number(const std::string& text) {
  std::istringstream stream(text);
  double value = 0.0;
  return stream >> value ? std::optional<double>(value) : std::nullopt;
}

/// "segment 2 EI, median" to "segment_2_" and "EI, median".
std::string take_segment(std::string& name) {
  if (!boost::starts_with(name, "segment ")) return "";
  const std::size_t end = name.find(' ', 8);
  if (end == std::string::npos) return "";
  const std::string prefix = "segment_" + name.substr(8, end - 8) + "_";
  name = name.substr(end + 1);
  return prefix;
}

std::optional<double> number_at(const OrderedJson& json, const char* object, const char* key) {
  const auto found = json.find(object);
  if (found == json.end() || !found->is_object() || !found->contains(key) || !found->at(key).is_number())
    return std::nullopt;
  return found->at(key).get<double>();
}

std::optional<double> number_at(const OrderedJson& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? std::optional<double>(found->get<double>())
                                                   : std::nullopt;
}

Figure word(const char* column, const char* heading, const std::string& text) {
  return {column, heading, std::nullopt, text, 1.0, ""};
}

Figure millimetres(const char* column, const char* heading, std::optional<double> metres) {
  return {column, heading, metres, "", 1e3, "mm"};
}

Figure percent(const char* column, const char* heading, std::optional<double> share) {
  return {column, heading, share, "", 100.0, "%"};
}

Figure count(const char* column, const char* heading, std::size_t number) {
  return {column, heading, static_cast<double>(number), "", 1.0, ""};
}

OrderedJson parsed(const std::string& text) {
  OrderedJson json = OrderedJson::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) throw Failure("the result is no JSON");
  return json;
}

std::string joined(const std::vector<std::string>& words) {
  return boost::join(words, " ");
}

}  // namespace

std::vector<Figure> figures_of_estimate(const std::string& summary) {
  std::vector<Figure> figures;
  std::istringstream lines(summary);
  std::string line, above, segment;
  while (std::getline(lines, line)) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    std::string name = boost::trim_copy(line.substr(0, colon));
    if (boost::starts_with(line, " ")) {
      name = above + "/" + name;
    } else {
      segment = take_segment(name);
      above = name;
    }
    for (const SummaryLine& known : kSummaryLines) {
      if (name != known.name) continue;
      std::optional<double> number = leading_number(line.substr(colon + 1));
      if (number) *number *= known.to_si;
      figures.push_back({segment + known.column,
                         (segment.empty() ? "" : boost::replace_all_copy(segment, "_", " ")) + known.heading,
                         number, "", known.shown, known.unit});
    }
  }
  return figures;
}

std::vector<Figure> figures_of_diagnosis(const std::string& text) {
  const OrderedJson json = parsed(text);
  std::vector<std::string> names;
  std::vector<Figure> sizes;
  std::optional<double> probability;
  for (const OrderedJson& effect : json.value("effects", OrderedJson::array())) {
    names.push_back(effect.value("name", "?"));
    if (!probability) probability = number_at(effect, "probability");
  }
  const OrderedJson ranking = json.value("ranking", OrderedJson::array());
  const std::string likeliest = ranking.empty() ? "" : ranking.front().value("name", "");
  return {
      word("verdict", "verdict", json.value("verdict", "?")),
      word("effects", "effects named", joined(names)),
      percent("probability_of_first", "probability of the first", probability),
      word("likeliest", "likeliest", likeliest),
      percent("probability_of_likeliest", "its probability",
              ranking.empty() ? std::nullopt : number_at(ranking.front(), "probability")),
      millimetres("held_out_rms_m", "error on unseen trials", number_at(json, "baseline", "held_out_rms_m")),
      millimetres("held_out_rms_extended_m", "with the effects",
                  number_at(json, "extended", "held_out_rms_m")),
      millimetres("noise_floor_m", "noise", number_at(json, "noise_floor_m")),
      percent("left_out_share", "left out", number_at(json, "left_out_share")),
      percent("discrepancy_share", "without a name", number_at(json, "discrepancy_share"))};
}

std::vector<Figure> figures_of_check(const std::string& text) {
  const OrderedJson json = parsed(text);
  std::map<std::string, std::vector<std::string>> ids;
  std::map<std::string, std::size_t> counts;
  std::string worst = "nothing wrong";
  std::optional<double> duration_s;
  for (const OrderedJson& recording : json.value("recordings", OrderedJson::array())) {
    if (const std::string found = recording.value("worst", ""); found == "serious" || found == "warning")
      worst = found;
    duration_s = number_at(recording, "duration_s");
    for (const OrderedJson& finding : recording.value("findings", OrderedJson::array())) {
      const std::string severity = finding.value("severity", "?"), id = finding.value("id", "?");
      ++counts[severity];
      std::vector<std::string>& known = ids[severity];
      if (std::find(known.begin(), known.end(), id) == known.end()) known.push_back(id);
    }
  }
  return {word("worst", "worst", worst),
          count("serious", "serious", counts["serious"]),
          word("serious_findings", "what is serious", joined(ids["serious"])),
          count("warnings", "warnings", counts["warning"]),
          word("warning_findings", "what is warned of", joined(ids["warning"])),
          {"duration_s", "duration", duration_s, "", 1.0, "s"}};
}

std::vector<Figure> figures_of(const Job& job, const JobFolder& folder) {
  const fs::path result = folder.result();
  try {
    if (job.work == "diagnose") return figures_of_diagnosis(read_text(result / "report.json"));
    if (job.work == "check") return figures_of_check(read_text(result / "findings.json"));
    return figures_of_estimate(read_text(result / fs::path(job.bags.front()).stem() / "summary.txt"));
  } catch (const OrderedJson::exception&) {
    throw Failure(fmt::format("{}: is not what {} writes", result.string(), job.work));
  }
}

std::string headline(const std::vector<Figure>& figures) {
  std::string text;
  for (const char* column : {"verdict", "effects", "worst", "serious_findings", "frames_ok",
                             "EI_where_identifiable_nm2", "payload_kg"}) {
    const auto figure =
        std::find_if(figures.begin(), figures.end(), [&](const Figure& one) { return one.column == column; });
    if (figure == figures.end() || (!figure->number && figure->text.empty())) continue;
    const std::string value = figure->number ? fmt::format("{} {:.4g} {}", figure->heading,
                                                           *figure->number * figure->scale, figure->unit)
                                             : figure->text;
    text += (text.empty() ? "" : ", ") + boost::trim_copy(value);
  }
  return text;
}

std::string page_of(const Job& job, const JobFolder& folder) {
  const fs::path stem = fs::path(job.bags.front()).stem();
  const fs::path page = job.work == "diagnose" ? fs::path("result") / "report.html"
                        : job.work == "check"  ? fs::path("result") / "findings.json"
                                               : fs::path("result") / stem / "summary.txt";
  std::error_code error;
  return fs::is_regular_file(folder.path() / page, error) ? page.string() : "";
}

}  // namespace softarm::app::batch
