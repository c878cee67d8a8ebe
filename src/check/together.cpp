// What several recordings of one arm say together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "math/statistics.h"
#include "settings.h"
#include "softarm/check/check.h"

namespace softarm::check {
namespace {

/// The levels of one input, one per recording that has a rest.
struct Zeros {
  std::vector<const CheckReport*> reports;
  std::vector<ZeroAtRest> all;
};

std::map<std::string, Zeros> by_input(const std::vector<CheckReport>& reports) {
  std::map<std::string, Zeros> inputs;
  for (const CheckReport& report : reports) {
    for (const ZeroAtRest& zero : report.zeros) {
      inputs[zero.input].reports.push_back(&report);
      inputs[zero.input].all.push_back(zero);
    }
  }
  return inputs;
}

/// A level with the zero taken off that it has: recordings may have been imported with different ones.
double raw_of(const ZeroAtRest& zero) {
  return zero.level + zero.zero * zero.si_per_unit;
}

std::string figure(const ZeroAtRest& zero, double level) {
  return zero.unit_si == "Pa" && !zero.of_layout ? fmt::format("{:.2f} kPa", 1e-3 * level)
                                                 : in_unit(zero, level);
}

/// Sets the setting of every finding of an input's level.
void propose(std::vector<CheckReport>& reports, const std::string& input, const std::string& remedy,
             const std::string& setting) {
  for (CheckReport& report : reports) {
    for (CheckFinding& f : report.findings) {
      if (f.id != "offset_at_rest" || f.where != input) continue;
      f.severity = Severity::kInformation;
      f.remedy = remedy;
      f.setting = setting;
    }
  }
}

CheckFinding zero_finding(const char* id, const Zeros& zeros, const std::string& what) {
  CheckFinding finding;
  finding.severity = Severity::kWarning;
  finding.id = id;
  finding.where = zeros.all.front().input;
  finding.what = what;
  finding.unit = zeros.all.front().unit_si;
  return finding;
}

CheckFinding common_zero(const Zeros& zeros, double raw, double spread) {
  const ZeroAtRest& first = zeros.all.front();
  CheckFinding finding =
      zero_finding("zero_of_all", zeros,
                   fmt::format("rests at {} in {} recordings, alike to {}: its zero is off",
                               figure(first, raw), zeros.all.size(), figure(first, spread)));
  finding.figure = raw;
  finding.figure_sd = spread / std::sqrt(static_cast<double>(zeros.all.size()));
  finding.remedy = "if it is not really driven at rest, subtract it";
  finding.setting = zero_setting(first, raw - first.zero * first.si_per_unit);
  return finding;
}

CheckFinding zeros_differ(const Zeros& zeros, std::size_t low, std::size_t high) {
  CheckFinding finding = zero_finding(
      "zeros_differ", zeros,
      fmt::format("rests at {} in {} and at {} in {}: pressure that is left in it, or a zero that wanders",
                  figure(zeros.all[low], raw_of(zeros.all[low])), zeros.reports[low]->name,
                  figure(zeros.all[high], raw_of(zeros.all[high])), zeros.reports[high]->name));
  finding.figure = raw_of(zeros.all[high]) - raw_of(zeros.all[low]);
  finding.remedy = "no common zero is proposed: vent before each trial, and record two seconds of it";
  return finding;
}

}  // namespace

std::vector<CheckFinding> check_together(std::vector<CheckReport>& reports) {
  std::vector<CheckFinding> findings;
  if (reports.size() < 2) return findings;
  for (const auto& [input, zeros] : by_input(reports)) {
    if (zeros.all.size() < 2) continue;
    std::vector<double> raw, limits;
    bool off = false, held = true;
    for (const ZeroAtRest& zero : zeros.all) {
      raw.push_back(raw_of(zero));
      limits.push_back(zero.limit);
      off = off || std::abs(zero.level) >= zero.limit;
      held = held && zero.may_be_held;
    }
    if (!off || held) continue;
    const auto [low, high] = std::minmax_element(raw.begin(), raw.end());
    const double spread = *high - *low;
    if (spread > 2.0 * *std::max_element(limits.begin(), limits.end())) {
      const auto at = [&](std::vector<double>::iterator i) {
        return static_cast<std::size_t>(i - raw.begin());
      };
      findings.push_back(zeros_differ(zeros, at(low), at(high)));
      propose(reports, input, "the recordings differ in it: no zero", "");
      continue;
    }
    findings.push_back(common_zero(zeros, math::median(raw), spread));
    propose(reports, input, "the common zero of all these recordings", findings.back().setting);
  }
  for (CheckFinding& finding : pool_settings(reports)) findings.push_back(std::move(finding));
  return findings;
}

}  // namespace softarm::check
