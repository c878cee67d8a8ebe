// Sentences and numbers for people, shared by the terminal, report.json and report.html.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// How a quantity of an SI unit is shown: value times `scale` in `shown`.
struct ShownUnit {
  std::string unit, shown;
  double scale = 1.0;
};

/// Units that are shown as another one: m as mm, Pa as kPa, rad as deg, kg as g.
const std::vector<ShownUnit>& shown_units();

/// How this unit is shown; as itself where shown_units() does not have it.
ShownUnit shown_unit(const std::string& unit);

/// "12.3 mm" of 0.0123 and "m": three significant digits.
std::string with_unit(double value, const std::string& unit);

/// "1.23 mm".
std::string millimetres(double metres);

/// "97 %"; never rounded to certainty: "over 99 %", "under 1 %".
std::string percent(double probability);

/// "5.2 N m/rad (90 % interval 4.6 ... 5.9)": as many digits as the interval is worth. "80.0 mm (not fitted)"
/// of a number that was held.
std::string with_interval(const EffectValue& value);

/// What it is: its description, which may go on from its symbol: "share of EI, by which it grows", "time
/// constant".
std::string label(const EffectValue& value);

/// "from 40 mm to 80 mm from the base, in the plane of bending, during holds, with payload"; empty if nothing
/// is known.
std::string place(const Where& where);

/// With a capital letter in front.
std::string capitalised(std::string text);

/// "a, b or c".
std::string one_of(const std::vector<std::string>& names, const std::string& last = "or");

/// Of which trials an error is that stands in words: " on unseen trials"; empty for one alone, which is
/// seen by the fit.
std::string on_unseen(std::size_t trials);

/// What the verdict means, for a reader who meets it for the first time.
std::string meaning(Verdict verdict);

/// That, or what is to be seen to before any verdict.
std::string headline(const Diagnosis& d);

/// What became of it, in a few words.
std::string finding_description(const Candidate& candidate);

/// Where the candidate's law is from, with the address of that; empty if the catalogue does not have it.
std::string source_of(const Candidate& candidate);

/// The effect's own sentence, or one made of its parts.
std::string sentence_of(const NamedEffect& effect);

/// The distance of a body, on average, that noise alone makes, m.
double mean_noise_m(const Diagnosis& diagnosis);

/// "falls from 3.10 mm to 2.05 mm".
std::string change(double before_m, double after_m);

/// How much better on trials that were not fitted: plain errors, which trials got worse, and the share of
/// what could be explained; empty where that is not known.
std::string improvement(const Diagnosis& diagnosis);

/// From which trials each unseen one is predicted; empty where that is simply from all others.
/// @param sequence of each trial (sequences.h)
/// @param without by trial, which ones it is predicted without (unseen.h)
std::string predicted_from(const std::vector<std::size_t>& sequence,
                           const std::vector<std::vector<bool>>& without);

}  // namespace softarm::diagnose
