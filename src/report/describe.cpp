// A diagnosis on the terminal: sentences first, then a short table.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnose/policy.h"
#include "diagnose/sentences.h"

namespace softarm::report {
namespace {

constexpr std::size_t kWidth = 110;
constexpr const auto& kWords = diagnose::kPolicy.words;

/// Number of characters, not of bytes.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(width - std::min(width, width_of(text)), ' ');
}

/// A name of a file or topic must not move the terminal's cursor or change its colours.
std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) == 0x7f; },
      ' ');
  return text;
}

/// Paragraph of at most kWidth characters a line; lines after the first are indented by `hang`.
std::string paragraph(const std::string& first, const std::string& text, std::size_t hang) {
  std::string lines, line = first;
  const std::string words = printable(text);
  std::size_t start = 0;
  bool empty = true;
  while (start < words.size()) {
    const std::size_t end = std::min(words.find(' ', start), words.size());
    const std::string word = words.substr(start, end - start);
    start = end + 1;
    if (word.empty()) continue;
    if (!empty && width_of(line) + 1 + width_of(word) > kWidth) {
      lines += line + "\n";
      line = std::string(hang, ' ');
      empty = true;
    }
    line += (empty ? "" : " ") + word;
    empty = false;
  }
  return lines + line + "\n";
}

std::string labelled(const std::string& label, const std::string& text) {
  return text.empty() ? "" : paragraph("     " + padded(label, 14), text, 19);
}

std::string effect_text(std::size_t number, const diagnose::NamedEffect& effect) {
  const std::string what =
      fmt::format("{} ({})", effect.description.empty() ? effect.id : effect.description, effect.id);
  const bool said = !effect.sentence.empty();
  std::string text =
      paragraph(fmt::format("  {}. ", number), said ? effect.sentence : diagnose::capitalised(what), 5);
  if (said) text += labelled("what", what);
  text += labelled("where", place(effect.where));
  for (const diagnose::EffectValue& value : effect.parameters)
    text += labelled("how large", label(value) + ": " + diagnose::with_interval(value));
  text += labelled("how sure", diagnose::percent(effect.probability));
  text += labelled("mistaken for", effect.confusable_with.empty() ? "nothing that these recordings leave open"
                                                                  : diagnose::one_of(effect.confusable_with));
  if (std::isfinite(effect.held_out_gain_m))
    text += labelled("unseen trials", fmt::format("rms error {} {} with it in the model",
                                                  diagnose::millimetres(std::abs(effect.held_out_gain_m)),
                                                  effect.held_out_gain_m < 0.0 ? "HIGHER" : "lower"));
  return text;
}

std::string law_text(const diagnose::DiscoveredLaw& law) {
  std::string text = "\nA law that was learnt from what is left (learned_moment in arm_extended.yaml):\n";
  text += paragraph("  - ", law.sentence, 4);
  for (std::size_t i = 0; i < law.terms.size(); ++i) {
    const diagnose::LawTerm& term = law.terms[i];
    if (!term.law.empty()) text += labelled("law", term.law + "; " + term.symbols);
    if (i + 1 == law.terms.size() || law.terms[i + 1].source != term.source)
      text += labelled("source", term.source);
  }
  return text + labelled("method", law.source);
}

std::string structure_text(const diagnose::Diagnosis& d) {
  const diagnose::Structure& left = d.after;
  std::string text = fmt::format("The rest is {} times as large as the noise",
                                 diagnose::with_unit(std::sqrt(left.chi2_per_dof), ""));
  std::string shows;
  const auto add = [&](const std::string& what, double p) {
    if (p < kWords.pattern_p)
      shows += (shows.empty() ? "" : ", ") + what +
               (p < 1e-4 ? std::string(" (p < 0.0001)") : fmt::format(" (p = {:.2g})", p));
  };
  add("time", left.whiteness_p);
  add("place along the arm", left.along_s_p);
  for (const auto& [input, p] : left.by_input_p) add(input, p);
  text += shows.empty() ? " and has no pattern left in time, along the arm or with the inputs."
                        : " and still depends on: " + shows + ".";
  const std::string where = place(left.where);
  if (!where.empty() && !shows.empty()) text += " It sits " + where + ".";
  return paragraph("", text, 0);
}

std::string shifts_text(const diagnose::Diagnosis& d) {
  if (d.shifts.empty() || (d.effects.empty() && d.small_departures.empty() && d.stand_ins.empty())) return "";
  std::size_t width = 8;
  for (const diagnose::Shift& shift : d.shifts) width = std::max(width, width_of(shift.name));
  std::string text = "\nEstimates before, and with this in the model (+- 1 sd):\n";
  for (const diagnose::Shift& shift : d.shifts) {
    const diagnose::ShownUnit shown = diagnose::shown_unit(shift.unit);
    std::string change;
    const auto identifiable = [](double value, double sd) {
      return sd < kWords.identifiable * std::abs(value);
    };
    if (!identifiable(shift.before, shift.sd_before) && !identifiable(shift.after, shift.sd_after))
      change = "not identifiable";
    else if (shift.before != 0.0 && shift.after != 0.0)
      change = fmt::format("{:+.1f} %", 100.0 * (shift.after / shift.before - 1.0));
    text += fmt::format("  {}  {:>9.4g} +- {:<8.2g} -> {:>9.4g} +- {:<8.2g} {:<8} {}\n",
                        padded(printable(shift.name), width), shown.scale * shift.before,
                        shown.scale * shift.sd_before, shown.scale * shift.after,
                        shown.scale * shift.sd_after, shown.shown, change);
  }
  return text;
}

std::string ranking_text(const diagnose::Diagnosis& d) {
  if (d.ranking.empty()) return "";
  std::size_t width = 9, listed = 0;
  for (std::size_t i = 0; i < std::min(kWords.ranked, d.ranking.size()); ++i)
    width = std::max(width, width_of(d.ranking[i].id));
  std::string text = fmt::format("\n{}  {:>11}  {:>12}  {:>8}  {:>10}  {}\n", padded("candidate", width + 4),
                                 "probability", "collinearity", "screen z", "rms effect", "finding");
  for (const diagnose::Candidate& candidate : d.ranking) {
    if (candidate.finding == diagnose::Finding::kNotOfThisArm) continue;
    if (++listed > kWords.ranked) continue;
    text += fmt::format("{:>2}. {}  {:>11}  {:>12}  {:>8.1f}  {:>10}  {}\n", listed,
                        padded(printable(candidate.id), width), diagnose::percent(candidate.probability),
                        diagnose::percent(candidate.collinearity), candidate.z,
                        diagnose::millimetres(candidate.size_m), diagnose::finding_description(candidate));
  }
  if (listed > kWords.ranked) text += fmt::format("    and {} more in the report\n", listed - kWords.ranked);
  return text +
         "probability: of being there at a size that matters\n"
         "collinearity: share of its signature that the arm's own constants absorb\n";
}

}  // namespace

std::string describe(const diagnose::Diagnosis& d) {
  std::string name = to_string(d.verdict);
  std::transform(name.begin(), name.end(), name.begin(), [](char c) {
    return c == '_' ? ' ' : c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
  });
  if (d.told_payloads) name += " WITH OTHER PAYLOADS";
  std::string text =
      paragraph("", name + ": " + (d.summary.empty() ? diagnose::meaning(d.verdict) + "." : d.summary), 0);
  if (!d.effects.empty())
    text += d.verdict == diagnose::Verdict::kUnknown ? "\nWhat helps, without being the whole explanation:\n"
                                                     : "\nLeft out of the model:\n";
  for (std::size_t i = 0; i < d.effects.size(); ++i) text += effect_text(i + 1, d.effects[i]);
  const auto add_list = [&](const std::string& heading, const std::vector<diagnose::NamedEffect>& list) {
    if (!list.empty()) text += "\n" + heading + ":\n";
    for (const diagnose::NamedEffect& effect : list)
      text += paragraph("  - ", fmt::format("{}: {}", effect.id, sentence_of(effect)), 4);
  };
  add_list("Small departures, as every arm has them", d.small_departures);
  add_list("In the model too, and likely to stand in for something else", d.stand_ins);
  if (d.discovered_law) text += law_text(*d.discovered_law);
  text += "\n";
  const std::string better = diagnose::improvement(d);
  if (!better.empty()) text += paragraph("", better, 0);
  text += structure_text(d);
  if (!d.ladder_sentence.empty()) text += paragraph("", d.ladder_sentence, 0);
  text += shifts_text(d);
  if (d.next_experiment) {
    std::string next = d.next_experiment->action;
    if (!next.empty() && next.back() != '.') next += ".";
    const std::string& sentence = d.next_experiment->sentence;
    if (!sentence.empty()) next += " " + sentence;
    if (sentence.empty() && !d.next_experiment->separates.empty())
      next += " It would separate " + diagnose::one_of(d.next_experiment->separates, "and");
    if (sentence.empty() && !d.next_experiment->separates.empty() &&
        d.next_experiment->expected_separation > 0.0)
      next += fmt::format(" by about {:.1f} standard deviations", d.next_experiment->expected_separation);
    if (sentence.empty() && !d.next_experiment->separates.empty()) next += ".";
    text += "\n" + paragraph("Measure next: ", next, 2);
  }
  text += ranking_text(d);
  if (!d.notes.empty()) text += "\n";
  for (const std::string& note : d.notes) text += paragraph("note: ", note, 6);
  return text;
}

}  // namespace softarm::report
