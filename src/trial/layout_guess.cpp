#include "layout_guess.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/algorithm/string.hpp>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>

#include "guess_bodies.h"
#include "math/statistics.h"

namespace softarm::trial {
namespace {

constexpr double kFastest = 5e-4, kSlowest = 1.0;  // s between rows of a recording
constexpr double kAmbientPa = 101325.0, kNearAmbient = 0.06;
// What soft arms are driven with, at most; beyond either end a unit is hardly meant.
constexpr double kLeastGaugePa = -6e4;  // chambers are hardly evacuated
constexpr double kLeastDrivePa = 4e3, kMostDrivePa = 4e5;
constexpr std::size_t kFewValues = 5;  // of a column that a command may be
constexpr double kDiscrete = 0.15;     // distinct values per row of a converter's, or a command's, column
constexpr double kMostRad = 7.0;       // of a servo that is in radians
constexpr double kBothSigns = 0.2;     // of the larger side: an angle goes both ways, a pressure does not
constexpr double kAlike = 20.0;        // times: how far apart the ranges of one arm's inputs are, at most

bool named(const CsvNumbers& column, std::initializer_list<const char*> words) {
  const std::string name = boost::to_lower_copy(column.name);
  return std::any_of(words.begin(), words.end(), [&](const char* w) { return boost::contains(name, w); });
}

/// A unit in a header: "t [ms]", "pressure_kPa".
std::string unit_in(const std::string& name, const std::vector<std::string>& units) {
  std::string found;
  for (const std::string& unit : units) {
    const std::size_t at = name.rfind(unit);
    if (at == std::string::npos || unit.size() <= found.size()) continue;
    const auto letter = [&](std::size_t i) {
      return i < name.size() && std::isalpha(static_cast<unsigned char>(name[i]));
    };
    if ((at == 0 || !letter(at - 1)) && !letter(at + unit.size())) found = unit;
  }
  return found;
}

bool is_one_of(const std::vector<std::string>& units, const std::string& unit) {
  return std::find(units.begin(), units.end(), unit) != units.end();
}

/// A unit that the row of units says, or the name; empty where it is none of these.
std::string said_unit(const CsvNumbers& column, const std::vector<std::string>& units) {
  return is_one_of(units, column.unit) ? column.unit : unit_in(column.name, units);
}

const std::vector<std::string> kTimes{"s", "ms", "us", "ns"},
    kPressures{"Pa", "hPa", "kPa", "MPa", "mbar", "bar", "psi"}, kAngles{"rad", "deg"},
    kForces{"N", "mN", "kgf", "gf"};

std::string label(const LayoutGuess& guess, std::size_t column) {
  const std::string& name = guess.shape.columns[column].name;
  return name.empty() ? fmt::format("column {}", column + 1) : name;
}

Guess time_unit(const CsvNumbers& column) {
  const std::string said = said_unit(column, {"s", "ms", "us", "ns", "sec", "nsec", "usec", "msec"});
  static const std::vector<std::pair<std::string, double>> kUnits{
      {"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};
  if (!said.empty()) return {said == "sec" ? "s" : said.substr(0, said.find("ec")), "as the header says"};
  for (const auto& [unit, s] : kUnits) {
    const double step_s = column.median_step * s;
    if (step_s >= kFastest && step_s < kSlowest)
      return {unit, fmt::format("a row every {:.4g} {}, {:.3g} Hz", column.median_step, unit, 1.0 / step_s)};
  }
  return {"", fmt::format("s, ms, us or ns: the column rises by {:.4g} from row to row", column.median_step)};
}

void find_time(LayoutGuess* guess, std::set<std::size_t>* used) {
  const auto& columns = guess->shape.columns;
  std::vector<std::size_t> rising;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].increases && columns[c].count == guess->shape.rows) rising.push_back(c);
  }
  const auto is_counter = [&](std::size_t c) {
    return columns[c].median_step == 1.0 &&
           columns[c].values.front() == std::floor(columns[c].values.front());
  };
  std::stable_sort(rising.begin(), rising.end(), [&](std::size_t a, std::size_t b) {
    const auto rank = [&](std::size_t c) {
      const bool said = named(columns[c], {"time", "stamp", "sec"}) || is_one_of(kTimes, columns[c].unit);
      return (said ? 0 : 2) + (is_counter(c) ? 1 : 0);
    };
    return rank(a) < rank(b);
  });
  if (!rising.empty()) {
    guess->time = rising.front();
    used->insert(rising.begin(), rising.end());
    guess->counts_samples = is_counter(*guess->time) && said_unit(columns[*guess->time], kTimes).empty();
    if (!guess->counts_samples) guess->time_unit = time_unit(columns[*guess->time]);
    for (const double s : {1.0, 1e-3, 1e-6, 1e-9}) {
      const double first_s = columns[*guess->time].values.front() * s;
      guess->from_epoch = guess->from_epoch || (first_s > 1e9 && first_s < 4e9);
    }
    for (std::size_t i = 1; i < rising.size(); ++i)
      guess->not_used.push_back(label(*guess, rising[i]) + ": rises like a time, too");
    return;
  }
  guess->counts_samples = true;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const CsvNumbers& column = columns[c];
    // A number that goes up now and then: of a trial.
    const bool whole =
        std::all_of(column.values.begin(), column.values.end(), [](double x) { return x == std::floor(x); });
    if (!whole || !column.never_falls || column.is_constant() || column.distinct * 20 > guess->shape.rows)
      continue;
    guess->trial = c;
    used->insert(c);
    return;
  }
}

/// One of several columns' extremes together.
struct Range {
  double low = 0.0, high = 0.0, level = 0.0;
};

Range range_of(const LayoutGuess& guess, const std::vector<GuessedInput>& inputs) {
  Range range{1e300, -1e300, 1e300};
  for (const GuessedInput& input : inputs) {
    const CsvNumbers& column = guess.shape.columns[input.column];
    range.low = std::min(range.low, column.low);
    range.high = std::max(range.high, column.high);
    range.level = std::min(range.level, column.level);
  }
  return range;
}

struct PressureUnit {
  const char* name;
  double pa;
};
constexpr std::array<PressureUnit, 4> kUsualPressures{
    {{"Pa", 1.0}, {"kPa", 1e3}, {"bar", 1e5}, {"psi", 6894.757293168}}};

void guess_pressure_unit(const LayoutGuess& guess, GuessedInputs* pressures) {
  const Range range = range_of(guess, pressures->inputs);
  const std::string said = said_unit(guess.shape.columns[pressures->inputs.front().column], kPressures);
  std::string could;
  for (const PressureUnit& unit : kUsualPressures) {
    if (!said.empty() && said != unit.name) continue;
    const double low = range.low * unit.pa, high = range.high * unit.pa;
    if (std::abs(low - kAmbientPa) < kNearAmbient * kAmbientPa && high - kAmbientPa < kMostDrivePa) {
      pressures->unit = {unit.name,
                         fmt::format("the lowest value, {:.4g}, is the ambient pressure", range.low)};
      pressures->reference = {"absolute", "the same"};
      return;
    }
    if (high < kLeastDrivePa || high > kMostDrivePa || low < kLeastGaugePa) continue;
    could += fmt::format("{}{} (then {:.3g} to {:.3g} kPa)", could.empty() ? "" : " or ", unit.name,
                         1e-3 * low, 1e-3 * high);
    pressures->unit.text = pressures->unit.text.empty() ? unit.name : "?";
  }
  pressures->reference = {"gauge",
                          fmt::format("the lowest value, {:.3g}, is not the ambient pressure", range.low)};
  if (!said.empty()) {
    pressures->unit = {said, "as the header says"};
  } else if (pressures->unit.text == "?" || pressures->unit.text.empty()) {
    pressures->unit = {
        "", could.empty()
                ? fmt::format("Pa, hPa, kPa, MPa, mbar, bar or psi: {:.4g} to {:.4g}", range.low, range.high)
                : could};
  } else {
    pressures->unit.why = could;
  }
}

void guess_angle_unit(const LayoutGuess& guess, GuessedInputs* angles) {
  const Range range = range_of(guess, angles->inputs);
  const std::string said = said_unit(guess.shape.columns[angles->inputs.front().column], kAngles);
  const double most = std::max(std::abs(range.low), std::abs(range.high));
  if (!said.empty())
    angles->unit = {said, "as the header says"};
  else if (most > kMostRad)
    angles->unit = {"deg", fmt::format("up to {:.3g}: more than a turn in rad", most)};
  else
    angles->unit = {"", fmt::format("rad or deg: up to {:.3g}", most)};
}

void guess_tension_unit(const LayoutGuess& guess, GuessedInputs* tensions) {
  const Range range = range_of(guess, tensions->inputs);
  const std::string said = said_unit(guess.shape.columns[tensions->inputs.front().column], kForces);
  tensions->unit = said.empty()
                       ? Guess{"", fmt::format("N, mN, kgf or gf: {:.3g} to {:.3g}", range.low, range.high)}
                       : Guess{said, "as the header says"};
}

/// What other columns are named that vary.
bool is_about_something_else(const CsvNumbers& column) {
  return named(column,
               {"error", "resid",   "quality", "temp",  "batt",  "volt",  "frame", "count", "index", "valid",
                "track", "payload", "mass",    "humid", "flag",  "trial", "state", "mode",  "label", "rot",
                "quat",  "orient",  "euler",   "roll",  "pitch", "yaw",   "vel",   "acc"});
}

/// Which of the sections a column belongs to, by its name or its unit.
std::string section_by_name(const CsvNumbers& column) {
  const bool unit_of_none = !column.unit.empty() && !is_one_of(kPressures, column.unit) &&
                            !is_one_of(kAngles, column.unit) && !is_one_of(kForces, column.unit);
  if (unit_of_none) return "";
  if (!column.unit.empty() && !is_about_something_else(column))
    return is_one_of(kPressures, column.unit) ? "pressures"
           : is_one_of(kAngles, column.unit)  ? "angles"
                                              : "tensions";
  if (named(column, {"press", "chamber", "psi", "bar", "kpa", "vacuum"})) return "pressures";
  if (named(column, {"tension", "force", "load"}) && !named(column, {"payload"})) return "tensions";
  if (named(column, {"angle", "phi", "servo", "motor", "theta"})) return "angles";
  const std::string name = boost::to_lower_copy(column.name);
  const bool numbered = name.size() > 1 && std::all_of(name.begin() + 1, name.end(), [](char c) {
                          return c == '_' || std::isdigit(static_cast<unsigned char>(c));
                        });
  if (numbered && name[0] == 'p') return "pressures";
  return "";
}

void add_input(LayoutGuess* guess, const std::string& section, std::size_t column, const std::string& why) {
  auto found = std::find_if(guess->inputs.begin(), guess->inputs.end(),
                            [&](const GuessedInputs& i) { return i.section == section; });
  if (found == guess->inputs.end()) {
    guess->inputs.push_back({section, {}, {}, {}});
    found = guess->inputs.end() - 1;
  }
  found->inputs.push_back({topic_of(section, found->inputs.size() + 1), column, why});
}

/// "14-17, 43"
std::string list_of(const LayoutGuess& guess, const std::vector<std::size_t>& columns) {
  std::string text;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::size_t last = i;
    while (last + 1 < columns.size() && columns[last + 1] == columns[last] + 1) ++last;
    text += text.empty() ? "" : ", ";
    text += label(guess, columns[i]);
    if (last > i) text += " to " + label(guess, columns[last]);
    i = last;
  }
  return text;
}

/// Columns without a known meaning, by how their values go.
struct Leftovers {
  std::vector<std::size_t> constant, commands, discrete, even;
};

/// Adds what is an input by its name, and sorts the rest.
Leftovers take_named_inputs(LayoutGuess* guess, const std::set<std::size_t>& used) {
  const auto& columns = guess->shape.columns;
  Leftovers rest;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (used.count(c) || columns[c].count == 0) continue;
    const std::string section = section_by_name(columns[c]);
    if (!section.empty())
      add_input(guess, section, c, "");
    else if (columns[c].is_constant())
      rest.constant.push_back(c);
    else if (columns[c].distinct < kFewValues)
      rest.commands.push_back(c);
    else if (static_cast<double>(columns[c].distinct) < kDiscrete * static_cast<double>(guess->shape.rows))
      rest.discrete.push_back(c);
    else
      rest.even.push_back(c);
  }
  return rest;
}

bool goes_both_ways(const CsvNumbers& column) {
  return column.low < -kBothSigns * std::max(column.high, 0.0) && column.low < 0.0 &&
         std::abs(column.low) > kBothSigns * (column.high - column.low) * 2.0;
}

/// Columns without names: what comes in the steps of a converter; else what is left; else the few values that
/// a command has.
void take_unnamed_inputs(LayoutGuess* guess, Leftovers* rest) {
  const bool has_discrete = !rest->discrete.empty();
  std::vector<std::size_t>& inputs = has_discrete          ? rest->discrete
                                     : !rest->even.empty() ? rest->even
                                                           : rest->commands;
  for (const std::size_t c : inputs)
    add_input(guess, goes_both_ways(guess->shape.columns[c]) ? kUnknownKind : "pressures", c,
              has_discrete ? "moves in steps, as a converter's values do" : "what is left over");
  inputs.clear();
}

/// Of a header whose names say nothing ("c11", "left", "sensor1"): columns that vary about as much as one
/// another, where there are poses that they may move.
void take_inputs_by_range(LayoutGuess* guess, Leftovers* rest) {
  const auto& columns = guess->shape.columns;
  const auto span = [&](std::size_t c) { return columns[c].high - columns[c].low; };
  std::vector<double> spans;
  for (const auto* list : {&rest->discrete, &rest->even, &rest->commands}) {
    for (const std::size_t c : *list) {
      if (!is_about_something_else(columns[c])) spans.push_back(span(c));
    }
  }
  if (spans.empty() || guess->bodies.empty()) return;
  const double usual = math::median(spans);
  const auto is_input = [&](std::size_t c) {
    return !is_about_something_else(columns[c]) && span(c) * kAlike >= usual && span(c) <= usual * kAlike;
  };
  std::vector<std::size_t> inputs;
  for (auto* list : {&rest->discrete, &rest->even, &rest->commands}) {
    std::copy_if(list->begin(), list->end(), std::back_inserter(inputs), is_input);
    list->erase(std::remove_if(list->begin(), list->end(), is_input), list->end());
  }
  std::sort(inputs.begin(), inputs.end());
  for (const std::size_t c : inputs)
    add_input(guess, goes_both_ways(columns[c]) ? kUnknownKind : "pressures", c,
              "CHECK: neither time nor pose, and nothing in its name");
}

/// Columns that have no number in any row; a separator at the end of the lines makes no column.
std::vector<std::size_t> without_numbers(const LayoutGuess& guess) {
  const auto& columns = guess.shape.columns;
  std::vector<std::size_t> empty;
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (columns[c].count == 0 && (c + 1 < columns.size() || !columns[c].name.empty())) empty.push_back(c);
  return empty;
}

void find_inputs(LayoutGuess* guess, const std::set<std::size_t>& used) {
  Leftovers rest = take_named_inputs(guess, used);
  if (guess->inputs.empty()) {
    const bool named = std::any_of(guess->shape.columns.begin(), guess->shape.columns.end(),
                                   [](const CsvNumbers& c) { return !c.name.empty(); });
    if (named)
      take_inputs_by_range(guess, &rest);
    else
      take_unnamed_inputs(guess, &rest);
  }
  if (!rest.commands.empty())
    guess->not_used.push_back(list_of(*guess, rest.commands) +
                              ": fewer than five values, as commands have; measured ones are better");
  if (!rest.constant.empty()) guess->not_used.push_back(list_of(*guess, rest.constant) + ": constant");
  if (const std::vector<std::size_t> empty = without_numbers(*guess); !empty.empty())
    guess->not_used.push_back(
        fmt::format("{}: not one number in {} rows", list_of(*guess, empty), guess->shape.rows));
  guess->not_understood = rest.even;
  guess->not_understood.insert(guess->not_understood.end(), rest.discrete.begin(), rest.discrete.end());
  std::sort(guess->not_understood.begin(), guess->not_understood.end());
  for (GuessedInputs& group : guess->inputs) {
    if (group.section == "pressures") guess_pressure_unit(*guess, &group);
    if (group.section == "angles") guess_angle_unit(*guess, &group);
    if (group.section == "tensions") guess_tension_unit(*guess, &group);
    if (group.section == kUnknownKind)
      group.unit.why = "of pressures Pa, kPa, bar, psi; of angles rad, deg; of tensions N, mN, kgf";
  }
}

}  // namespace

LayoutGuess guess_layout(const std::string& path) {
  LayoutGuess guess;
  guess.shape = read_shape(path);
  std::set<std::size_t> used;
  find_time(&guess, &used);
  find_bodies(&guess, &used);
  find_inputs(&guess, used);
  return guess;
}

std::size_t blanks(const LayoutGuess& guess) {
  std::size_t count = guess.counts_samples ? 1 : guess.time_unit.text.empty();
  count += guess.length_unit.text.empty() + guess.up.text.empty();
  for (const GuessedBody& body : guess.bodies) count += !body.orientation.empty() && body.order.text.empty();
  for (const GuessedInputs& group : guess.inputs)
    count += group.unit.text.empty() + (group.section == kUnknownKind) +
             (group.section == "pressures" && group.reference.text.empty());
  return count + guess.bodies.empty();
}

}  // namespace softarm::trial
