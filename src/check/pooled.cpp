// One setting of several recordings: what they propose for one key is pooled, or said not to go together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <set>

#include "math/parse_number.h"
#include "math/statistics.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

constexpr char kLayoutMark[] = " (of the layout)";

/// A finding of one of the recordings, with its setting as steps.
struct Proposal {
  CheckFinding* finding = nullptr;
  const std::string* recording = nullptr;
  std::vector<SettingStep> steps;
};

using Proposals = std::vector<Proposal*>;

/// A value without the mark of the layout.
std::string bare(const std::string& value) {
  const std::size_t mark = value.rfind(kLayoutMark);
  return mark == std::string::npos ? value : value.substr(0, mark);
}

std::vector<std::string> paths_of(const Proposal& proposal) {
  std::vector<std::string> paths;
  for (const SettingStep& step : proposal.steps) paths.push_back(step.path);
  return paths;
}

/// What each proposes for the step; nothing where a value is no number, or they set different keys.
std::optional<std::vector<double>> numbers_of(const Proposals& group, std::size_t step) {
  std::vector<double> numbers;
  for (const Proposal* p : group) {
    if (paths_of(*p) != paths_of(*group.front())) return std::nullopt;
    const auto number = math::parse_number(bare(p->steps[step].value));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

/// A value's words, each number as {}, and its numbers: of ranges and poses.
std::pair<std::string, std::vector<double>> parts_of(const std::string& value) {
  static const std::regex kNumber(R"(-?[0-9]+(\.[0-9]+)?([eE][-+]?[0-9]+)?)");
  std::vector<double> numbers;
  for (std::sregex_iterator n(value.begin(), value.end(), kNumber), end; n != end; ++n)
    numbers.push_back(math::parse_number(n->str()).value_or(0.0));
  return {std::regex_replace(value, kNumber, "{}"), numbers};
}

/// Ranges and poses that are nearly the same.
bool are_alike(const std::string& a, const std::string& b) {
  const auto [words, numbers] = parts_of(a);
  const auto [other_words, other_numbers] = parts_of(b);
  if (words != other_words || numbers.size() != other_numbers.size() || numbers.empty()) return false;
  double size = 0.0, off = 0.0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    size = std::max(size, std::abs(numbers[i]));
    off = std::max(off, std::abs(numbers[i] - other_numbers[i]));
  }
  return off <= kPolicy.timing.same_figure * size;
}

/// That of the middle figure, where all are alike: of several keys, not all of one number, that belong
/// together.
std::string middle_of(Proposals group) {
  std::stable_sort(group.begin(), group.end(), [](const Proposal* a, const Proposal* b) {
    return a->finding->figure.value_or(0.0) < b->finding->figure.value_or(0.0);
  });
  const Proposal& middle = *group[group.size() / 2];
  for (const Proposal* p : group) {
    if (paths_of(*p) != paths_of(middle)) return "";
    for (std::size_t k = 0; k < middle.steps.size(); ++k) {
      if (p->steps[k].value != middle.steps[k].value && !are_alike(p->steps[k].value, middle.steps[k].value))
        return "";
    }
  }
  return middle.finding->setting;
}

/// With the decimals that the first has.
std::string as_written(double number, const std::string& like) {
  const std::size_t point = like.find('.');
  const bool plain = like.find_first_of("eE") == std::string::npos;
  return plain ? fmt::format("{:.{}f}", number, point == std::string::npos ? 0 : like.size() - point - 1)
               : fmt::format("{:.4g}", number);
}

/// Whether figures with a standard deviation differ by no more than that.
bool agree(const Proposals& group) {
  double low = 1e300, high = -1e300, sd = 0.0;
  for (const Proposal* p : group) {
    if (!p->finding->figure || !p->finding->figure_sd) return true;
    low = std::min(low, *p->finding->figure);
    high = std::max(high, *p->finding->figure);
    sd = std::max(sd, *p->finding->figure_sd);
  }
  return high - low <= 2.0 * kPolicy.clocks.sds * sd;
}

/// The setting of all; empty where there is none.
std::string pooled(const Proposals& group) {
  std::vector<std::string> steps;
  for (std::size_t k = 0; k < group.front()->steps.size(); ++k) {
    const auto numbers = numbers_of(group, k);
    if (!numbers) return middle_of(group);
    const SettingStep& first = group.front()->steps[k];
    // Held for so long as the longest gap needs; all else are estimates of one number.
    const double number = first.path == kHoldPath ? *std::max_element(numbers->begin(), numbers->end())
                                                  : math::median(*numbers);
    const bool of_layout = bare(first.value).size() < first.value.size();
    steps.push_back(fmt::format("{}: {}{}", first.path, as_written(number, bare(first.value)),
                                of_layout ? kLayoutMark : ""));
  }
  return joined(steps);
}

/// "26.100 by a.bag, 26.300 by b.bag"
std::string list_of(const Proposals& group, const std::string& path) {
  std::string text;
  for (const Proposal* p : group) {
    for (const SettingStep& step : p->steps) {
      const std::string said = fmt::format("{} by {}", bare(step.value), *p->recording);
      if (step.path == path && text.find(said) == std::string::npos)
        text += (text.empty() ? "" : ", ") + said;
    }
  }
  return text;
}

CheckFinding said_of(const Proposals& group, const std::string& path) {
  const std::string setting = agree(group) ? pooled(group) : "";
  CheckFinding finding;
  finding.where = group.front()->finding->where;
  finding.what = fmt::format("{}: {}", path, list_of(group, path));
  if (setting.empty()) {
    // Where nothing is wrong in any of them, their contradiction is mere information.
    const bool any_wrong = std::any_of(group.begin(), group.end(), [](const Proposal* p) {
      return p->finding->severity != Severity::kInformation;
    });
    finding.severity = any_wrong ? Severity::kWarning : Severity::kInformation;
    finding.id = "settings_differ";
    finding.what += ": one file cannot have them all";
    finding.remedy = "something changed between these recordings: give each its own file, or leave some out";
  } else {
    finding.id = "pooled_setting";
    finding.what += path == kHoldPath ? ": the longest is proposed" : ": one setting is proposed";
    finding.remedy = "one file for all of them";
    finding.setting = setting;
  }
  for (const Proposal* p : group) {
    p->finding->setting = setting;
    if (setting.empty())
      p->finding->remedy += fmt::format("{}what to set differs from recording to recording",
                                        p->finding->remedy.empty() ? "" : "; ");
  }
  return finding;
}

}  // namespace

std::vector<CheckFinding> pool_settings(std::vector<CheckReport>& reports) {
  std::vector<Proposal> proposals;
  for (CheckReport& report : reports) {
    for (CheckFinding& f : report.findings) {
      if (!f.setting.empty()) proposals.push_back({&f, &report.name, setting_steps(f.setting)});
    }
  }
  std::map<std::string, Proposals> by_path;
  for (Proposal& p : proposals) {
    for (const SettingStep& step : p.steps) by_path[step.path].push_back(&p);
  }
  std::vector<CheckFinding> findings;
  std::set<const Proposal*> said;
  for (const auto& [path, group] : by_path) {
    std::set<std::string> values;
    for (const Proposal* p : group) {
      for (const SettingStep& step : p->steps) {
        if (step.path == path) values.insert(step.value);
      }
    }
    if (values.size() < 2 ||
        std::any_of(group.begin(), group.end(), [&](const Proposal* p) { return said.count(p) > 0; }))
      continue;
    said.insert(group.begin(), group.end());
    findings.push_back(said_of(group, path));
  }
  return findings;
}

}  // namespace softarm::check
