#include "sentences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "effects/catalogue.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

constexpr double kPi = 3.14159265358979323846;
// What numbers are shown to: places in whole millimetres, errors in hundredths of one, chances in per cent.
constexpr double kShownPlace_m = 1e-3, kShownError_m = 1e-5, kShownChance = 0.01;

/// Digits behind the point that show `digits` significant ones of a number of this size.
int decimals(double size, int digits) {
  if (!(std::abs(size) > 0.0) || !std::isfinite(size)) return digits - 1;
  return std::clamp(digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(size)))), 0, 9);
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "not known";
  if (value != 0.0 && (std::abs(value) >= 1e6 || std::abs(value) < 1e-6))
    return fmt::format("{:.{}e}", value, digits - 1);
  return fmt::format("{:.{}f}", value, decimals(value, digits));
}

/// A unit as it is put behind a number: nothing where the number is a share.
std::string behind(const std::string& unit) {
  return unit.empty() || unit == "1" || unit == "-" ? "" : " " + unit;
}

std::string axis_description(const std::string& axis) {
  if (axis == "in_plane") return "in the plane of bending";
  if (axis == "out_of_plane") return "across the plane of bending";
  if (axis == "axial") return "along the arm";
  if (axis == "twist") return "in twist";
  return axis;
}

std::string stretch_description(const Where& where) {
  const auto mm = [](double m) { return fmt::format("{:.0f}", 1e3 * m); };
  const auto &from = where.s_from_m, &to = where.s_to_m;
  if (to && *to < kShownPlace_m) return "at the base";
  if (from && to && *to - *from < kShownPlace_m) return fmt::format("{} mm from the base", mm(*from));
  if (from && to) return fmt::format("{} to {} mm from the base", mm(*from), mm(*to));
  if (from) return fmt::format("from {} mm from the base on", mm(*from));
  if (to) return fmt::format("up to {} mm from the base", mm(*to));
  return "";
}

/// "delay" of "delay_s".
std::string without_unit(std::string symbol) {
  for (const char* unit : {"_rad_per_nm", "_n_per_m", "_per_min", "_per_m", "_per_s", "_pa", "_rad", "_kg",
                           "_nm", "_n", "_s", "_m"}) {
    const std::string end = unit;
    if (symbol.size() <= end.size() || symbol.compare(symbol.size() - end.size(), end.size(), end) != 0)
      continue;
    symbol.resize(symbol.size() - end.size());
    break;
  }
  std::replace(symbol.begin(), symbol.end(), '_', ' ');
  return symbol;
}

}  // namespace

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kConsistent:
      return "consistent";
    case Verdict::kExplained:
      return "explained";
    case Verdict::kPartlyExplained:
      return "partly_explained";
    case Verdict::kUnknown:
      return "unknown";
    case Verdict::kCannotTell:
      return "cannot_tell";
  }
  throw std::logic_error("to_string: no such verdict");
}

std::string to_string(Finding finding) {
  switch (finding) {
    case Finding::kPresent:
      return "present";
    case Finding::kAbsent:
      return "absent";
    case Finding::kTrivial:
      return "trivial";
    case Finding::kCannotTell:
      return "cannot_tell";
    case Finding::kRival:
      return "rival";
    case Finding::kNotOfThisArm:
      return "not_of_this_arm";
  }
  throw std::logic_error("to_string: no such finding");
}

std::string on_unseen(std::size_t trials) {
  return trials > 1 ? " on unseen trials" : "";
}

std::string meaning(Verdict verdict) {
  switch (verdict) {
    case Verdict::kConsistent:
      return "The model agrees with the recordings";
    case Verdict::kExplained:
      return "The mismatch is explained";
    case Verdict::kPartlyExplained:
      return "The mismatch is partly explained";
    case Verdict::kUnknown:
      return "Something is there that is not in the catalogue";
    case Verdict::kCannotTell:
      return "These recordings cannot tell";
  }
  throw std::logic_error("meaning: no such verdict");
}

std::string headline(const Diagnosis& d) {
  if (d.exchanged_names) return "Names of bodies are exchanged";
  if (d.told_payloads) return "Payloads are not as stated";
  if (d.narrow_range) return "A range in the arm file is too narrow";
  return meaning(d.verdict);
}

std::string finding_description(const Candidate& candidate) {
  switch (candidate.finding) {
    case Finding::kPresent:
      return candidate.probability >= kPolicy.words.likely ? "present" : "in the model, but improbable";
    case Finding::kTrivial:
      return "too small to matter";
    case Finding::kRival:
      return "rival of an effect above";
    case Finding::kNotOfThisArm:
      return "not applicable to this arm";
    case Finding::kAbsent:
    case Finding::kCannotTell:
      break;
  }
  // What stands out and yet is not named: say why, "absent" would be too much.
  if (!candidate.possible) return "fits, but only with a size that no arm has";
  if (candidate.probability >= kPolicy.words.likely) return "possibly present";
  if (candidate.z >= kPolicy.words.stands_out)
    return "stands out, but effects above or errors of the laws explain it as well";
  return candidate.finding == Finding::kAbsent ? "absent" : "cannot tell: a usual size would not be seen";
}

const std::vector<ShownUnit>& shown_units() {
  static const std::vector<ShownUnit> units{{"m", "mm", 1e3},
                                            {"Pa", "kPa", 1e-3},
                                            {"Pa^2", "kPa^2", 1e-6},
                                            {"rad", "deg", 180.0 / kPi},
                                            {"kg", "g", 1e3}};
  return units;
}

ShownUnit shown_unit(const std::string& unit) {
  for (const ShownUnit& shown : shown_units()) {
    if (shown.unit == unit) return shown;
  }
  return {unit, unit == "1" || unit == "-" ? "" : unit, 1.0};
}

std::string with_unit(double value, const std::string& unit) {
  const ShownUnit shown = shown_unit(unit);
  return number(shown.scale * value, 3) + behind(shown.shown);
}

std::string millimetres(double metres) {
  if (!std::isfinite(metres)) return "not known";
  return fmt::format("{:.{}f} mm", 1e3 * metres, std::abs(metres) < 0.01 ? 2 : 1);
}

std::string percent(double probability) {
  if (!std::isfinite(probability)) return "not known";
  if (probability > 1.0 - kShownChance) return "over 99 %";
  if (probability < kShownChance) return "under 1 %";
  return fmt::format("{:.0f} %", 100.0 * probability);
}

std::string with_interval(const EffectValue& value) {
  if (!value.fitted) return with_unit(value.value, value.unit) + " (not fitted)";
  const ShownUnit shown = shown_unit(value.unit);
  const double v = shown.scale * value.value, low = shown.scale * value.low, high = shown.scale * value.high;
  const bool counts = shown.shown.empty() && v == std::round(v) && !(high > low);
  if (counts) return fmt::format("{:.0f}", v);
  if (!std::isfinite(low) || !std::isfinite(high) || !(high > low)) return with_unit(value.value, value.unit);
  const double largest = std::max({std::abs(v), std::abs(low), std::abs(high)});
  if (largest >= 1e6 || largest < 1e-6)
    return fmt::format("{:.2e}{} (90 % interval {:.2e} to {:.2e})", v, behind(shown.shown), low, high);
  const int digits = decimals(high - low, 2);
  return fmt::format("{:.{}f}{} (90 % interval {:.{}f} to {:.{}f})", v, digits, behind(shown.shown), low,
                     digits, high, digits);
}

std::string label(const EffectValue& value) {
  const std::string &words = value.description, name = without_unit(value.symbol);
  if (words.empty()) return name;
  for (const char* goes_on : {"of ", "by ", "across ", "along ", "that ", "around "}) {
    if (words.rfind(goes_on, 0) == 0) return name + " " + words;
  }
  if (words.rfind("its ", 0) == 0) return name + ", " + words;
  return words[0] >= '0' && words[0] <= '9' ? name + " (" + words + ")" : words;
}

std::string place(const Where& where) {
  std::string text;
  const auto add = [&](const std::string& part) {
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  };
  add(stretch_description(where));
  add(axis_description(where.axis));
  add(where.when);
  if (!where.input.empty()) add("goes with " + where.input);
  return text;
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string one_of(const std::vector<std::string>& names, const std::string& last) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " " + last + " " : ", ") + names[i];
  return text;
}

std::string source_of(const Candidate& candidate) {
  const model::Effect* effect = effects::find(candidate.id);
  return effect ? effect->info().source : "";
}

std::string sentence_of(const NamedEffect& effect) {
  if (!effect.sentence.empty()) return effect.sentence;
  std::string text = capitalised(effect.description.empty() ? effect.id : effect.description);
  const std::string where = place(effect.where);
  if (!where.empty()) text += ", " + where;
  std::string sizes;
  for (const EffectValue& value : effect.parameters)
    sizes += "; " + label(value) + ": " + with_interval(value);
  return text + sizes + "; probability " + percent(effect.probability) + ".";
}

double mean_noise_m(const Diagnosis& d) {
  return std::sqrt(8.0 / (3.0 * M_PI)) * d.noise_floor_m;
}

std::string change(double before_m, double after_m) {
  return fmt::format("{} from {} to {}", after_m < before_m ? "falls" : "GROWS", millimetres(before_m),
                     millimetres(after_m));
}

namespace {

/// Trials that are predicted worse than before, by more than would show.
std::string got_worse(const Diagnosis& d) {
  constexpr std::size_t kMost = 4;
  std::vector<const TrialCurves*> worse;
  for (const TrialCurves& trial : d.trials) {
    if (trial.mean_after_m > kPolicy.words.worse * trial.mean_before_m) worse.push_back(&trial);
  }
  if (worse.empty()) return "";
  std::stable_sort(worse.begin(), worse.end(), [](const TrialCurves* a, const TrialCurves* b) {
    return a->mean_after_m - a->mean_before_m > b->mean_after_m - b->mean_before_m;
  });
  std::vector<std::string> list;
  for (std::size_t i = 0; i < std::min(kMost, worse.size()); ++i)
    list.push_back(fmt::format("{} ({} to {})", worse[i]->name, millimetres(worse[i]->mean_before_m),
                               millimetres(worse[i]->mean_after_m)));
  return fmt::format(" WORSE in {} of {} trials: {}{}.", worse.size(), d.trials.size(), one_of(list, "and"),
                     worse.size() > kMost ? " (the worst)" : "");
}

}  // namespace

std::string improvement(const Diagnosis& d) {
  const double before = d.baseline.held_out_mean_m, after = d.extended.held_out_mean_m;
  if (!(before > 0.0) || !(after > 0.0)) return "";
  const bool same = (d.effects.empty() && d.small_departures.empty() && d.stand_ins.empty()) ||
                    std::abs(before - after) < 0.5 * kShownError_m;
  const double length_m = d.extended_arm.arm.total_length_m();
  const auto of_length = [&](double mean_m, double most_m) {
    const std::string share =
        length_m > 0.0 ? fmt::format(" ({:.2g} % of the length)", 100.0 * mean_m / length_m) : "";
    return fmt::format("{} off on average{}, {} at most", millimetres(mean_m), share, millimetres(most_m));
  };
  std::string text = d.trials.size() == 1 ? "On the only trial" : "On unseen trials";
  text += " the bodies are " + of_length(after, d.extended.held_out_max_m);
  if (!same) text += "; without these effects " + of_length(before, d.baseline.held_out_max_m);
  if (d.noise_floor_m > 0.0) text += fmt::format("; noise alone makes {}", millimetres(mean_noise_m(d)));
  text += ".";
  if (!same) text += got_worse(d);
  if (!(d.ceiling_rms_m > 0.0)) return text;
  text += fmt::format(" By precision, as rms: {}{}; a flexible model of the residuals reaches {}",
                      same ? "" : millimetres(d.baseline.held_out_rms_m) + " to ",
                      millimetres(d.extended.held_out_rms_m), millimetres(d.ceiling_rms_m));
  if (!same && d.ceiling_rms_m < d.baseline.held_out_rms_m && std::isfinite(d.explained_share))
    text += fmt::format(", and {:.0f} % of what could be explained is explained", 100.0 * d.explained_share);
  return text + ".";
}

std::string predicted_from(const std::vector<std::size_t>& sequence,
                           const std::vector<std::vector<bool>>& without) {
  const std::size_t trials = sequence.size();
  std::size_t most = 0, least = trials;
  for (const std::vector<bool>& out : without) {
    const auto count = static_cast<std::size_t>(std::count(out.begin(), out.end(), true));
    most = std::max(most, count);
    least = std::min(least, count);
  }
  std::string text;
  const bool one_sequence =
      trials > 1 && std::all_of(sequence.begin(), sequence.end(), [](std::size_t s) { return s == 0; });
  if (one_sequence)
    text =
        "All trials were driven by the same commands: an unseen trial has another payload or attitude, "
        "and says nothing about other commands.";
  if (most <= 1) return text;
  const std::string from =
      most == least ? std::to_string(trials - most) : fmt::format("{} to {}", trials - most, trials - least);
  return text + (text.empty() ? "" : " ") +
         fmt::format(
             "Each unseen trial is predicted from {} of the {} trials: those {}of the same session are left "
             "out.",
             from, trials, one_sequence ? "" : "driven by the same commands or ");
}

}  // namespace softarm::diagnose
