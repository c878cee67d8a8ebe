#include "softarm/check/check.h"

#include <algorithm>
#include <cmath>

#include "checks.h"
#include "context.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

std::vector<CheckStream> streams_of(const Context& context) {
  std::vector<CheckStream> streams;
  for (const Track& track : context.tracks) {
    if (track.poses.empty()) continue;
    CheckStream stream;
    stream.name = track.name;
    stream.is_body = true;
    stream.samples = track.poses.size();
    if (track.period_s > 0.0) stream.rate_hz = 1.0 / track.period_s;
    if (track.white_sd_m > 0.0) stream.noise_sd = track.white_sd_m;
    streams.push_back(std::move(stream));
  }
  for (const Signal& signal : context.signals) {
    if (signal.points.empty()) continue;
    CheckStream stream;
    stream.name = signal.input->name;
    stream.samples = signal.points.size();
    if (signal.period_s > 0.0) stream.rate_hz = 1.0 / signal.period_s;
    if (const auto rest = context.rest()) stream.rest_level = signal.mean(rest->from_s, rest->to_s);
    if (signal.is_measured) stream.noise_sd = signal.noise_sd;
    streams.push_back(std::move(stream));
  }
  return streams;
}

/// At the same time, or both throughout.
bool same_times(const CheckFinding& a, const CheckFinding& b) {
  if (a.spans.size() != b.spans.size()) return false;
  return std::equal(a.spans.begin(), a.spans.end(), b.spans.begin(),
                    [](const CheckSpan& x, const CheckSpan& y) {
                      return std::abs(x.from_s - y.from_s) < kPolicy.timing.same_event_s &&
                             std::abs(x.to_s - y.to_s) < kPolicy.timing.same_event_s;
                    });
}

Alike alike_of(const std::string& id) {
  for (const Check& check : checks()) {
    if (const Statement* statement = check.statement(id)) return statement->alike;
  }
  return Alike::kOnePerPlace;
}

/// What is wrong with the stamps, or stands still, mostly is so for all bodies, or all inputs, of a driver:
/// one finding for them.
void merge_alike(std::vector<CheckFinding>& findings) {
  std::vector<CheckFinding> merged;
  for (CheckFinding& f : findings) {
    const auto same = std::find_if(merged.begin(), merged.end(), [&](const CheckFinding& m) {
      if (m.id != f.id || m.severity != f.severity || !m.figure || !f.figure) return false;
      const Alike alike = alike_of(f.id);
      return alike != Alike::kOnePerPlace &&
             std::abs(*m.figure - *f.figure) <= kPolicy.timing.same_figure * std::abs(*m.figure) &&
             (alike == Alike::kOnePerDriver || same_times(m, f));
    });
    if (same == merged.end()) {
      merged.push_back(std::move(f));
      continue;
    }
    same->where += ", " + f.where;
    const std::string key = f.setting.substr(0, f.setting.find(':'));
    if (!key.empty() && same->setting.find(key) == std::string::npos) same->setting += "; " + f.setting;
  }
  findings = std::move(merged);
}

}  // namespace

std::optional<Severity> CheckReport::worst() const {
  if (findings.empty()) return std::nullopt;
  return std::max_element(
             findings.begin(), findings.end(),
             [](const CheckFinding& a, const CheckFinding& b) { return a.severity < b.severity; })
      ->severity;
}

CheckReport check_recording(const trial::CheckRecording& recording, const arm::Arm& arm) {
  const Strays sorted = without_strays(recording, arm);
  Context context(sorted.kept, arm);
  context.strays = sorted.by_source;
  for (const Check& check : checks()) {
    context.check = &check;
    check.look(context);
  }

  CheckReport report;
  report.name = recording.name;
  report.duration_s = context.duration_s;
  report.streams = streams_of(context);
  report.findings = std::move(context.findings);
  report.zeros = std::move(context.zeros);
  merge_alike(report.findings);
  std::stable_sort(report.findings.begin(), report.findings.end(),
                   [](const CheckFinding& a, const CheckFinding& b) { return a.severity > b.severity; });
  withhold_contradictions(report.findings);
  return report;
}

}  // namespace softarm::check
