// A guessed layout as an annotated document.
#include <fmt/format.h>

#include <map>

#include "layout_guess.h"

namespace softarm::trial {
namespace {

/// "  key: value" with its reason, or blank with what to fill in.
std::string line(const std::string& indent, const std::string& key, const Guess& guess) {
  if (guess.text.empty()) return fmt::format("{}# FILL IN: {}\n{}{}:\n", indent, guess.why, indent, key);
  return fmt::format("{}# Guessed: {}\n{}{}: {}\n", indent, guess.why, indent, key, guess.text);
}

std::string column(const LayoutGuess& guess, std::size_t c) {
  const std::string& name = guess.shape.columns[c].name;
  if (name.empty()) return std::to_string(c + 1);
  for (std::size_t other = 0; other < guess.shape.columns.size(); ++other) {
    if (other != c && guess.shape.columns[other].name == name)
      return std::to_string(c + 1);  // twice in the header
  }
  const bool plain =
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") ==
      std::string::npos;
  if (plain && name.find_first_not_of("0123456789_") != std::string::npos && name != "y" && name != "Y" &&
      name != "n" && name != "N")
    return name;
  // A name that YAML would read as something else.
  std::string quoted = "'";
  for (const char letter : name) quoted += letter == '\'' ? std::string("''") : std::string(1, letter);
  return name.find_first_not_of("0123456789") == std::string::npos ? std::to_string(c + 1) : quoted + "'";
}

std::string columns(const LayoutGuess& guess, const std::vector<std::size_t>& list) {
  std::string text;
  for (const std::size_t c : list) text += (text.empty() ? "" : ", ") + column(guess, c);
  return "[" + text + "]";
}

std::string format_text(const CsvFormat& format) {
  static const std::map<char, std::string> names{
      {',', "comma"}, {';', "semicolon"}, {'\t', "tab"}, {' ', "space"}};
  const auto name = names.find(format.separator);
  std::string text = "separator: " +
                     (name != names.end()        ? name->second
                      : format.separator == '\'' ? "\"'\""
                                                 : fmt::format("'{}'", format.separator)) +
                     "\n";
  if (format.decimal == ',') text += "decimal: comma\n";
  if (format.header) text += "header: true\n";
  if (format.units_row) text += "# Guessed: the line below the header has units\nunits_row: true\n";
  if (format.skip_lines > 0)
    text += fmt::format("# Lines before the header, or the data\nskip_lines: {}\n", format.skip_lines);
  return text;
}

std::string time_text(const LayoutGuess& guess) {
  std::string text = "time:\n";
  if (guess.time)
    text += "  # Guessed: it rises from row to row\n  column: " + column(guess, *guess.time) + "\n";
  if (guess.counts_samples) {
    text += line("  ", "period_s",
                 {"", guess.time ? "s per unit of the column, which counts samples (0.01: 100 Hz)"
                                 : "s per row: no column is a time (0.01: 100 Hz)"});
  } else {
    text += line("  ", "unit", guess.time_unit);
  }
  if (guess.from_epoch) text += "  # Guessed: the times are dates already\n  start_stamp_s: 0\n";
  if (guess.trial)
    text +=
        "# Guessed: a whole number that rises now and then, so it numbers the trials; each becomes a "
        "bag\ntrial:\n  column: " +
        column(guess, *guess.trial) + "\n";
  return text;
}

std::string mocap_text(const LayoutGuess& guess) {
  std::string text = "mocap:\n" + line("  ", "unit", guess.length_unit) + line("  ", "up", guess.up);
  if (guess.drop_repeated)
    text += "  # Guessed: rows repeat the poses of the row before to the last digit\n  drop_repeated: true\n";
  if (guess.bodies.empty())
    return text + "  # FILL IN: no column looks like a pose; see config/layouts/template.yaml\n  bodies:\n";
  text += "  # From base to tip, with the names that the arm file has for them\n  bodies:\n";
  for (const GuessedBody& body : guess.bodies) {
    text += fmt::format("    # Guessed: {}\n    - name: {}\n      position: {}\n", body.why, body.name,
                        columns(guess, body.position));
    if (body.orientation.empty()) continue;
    text += "      orientation: " + columns(guess, body.orientation) + "\n" +
            line("      ", "orientation_order", body.order);
  }
  return text;
}

std::string inputs_text(const LayoutGuess& guess, const GuessedInputs& group) {
  std::string text;
  if (group.section == kUnknownKind) {
    text = fmt::format(
        "# FILL IN: pressures, angles or tensions instead of {}, and the topics of the arm file. The values "
        "go to both sides\n"
        "# of 0, like those of angles, or of vented pressure sensors. Pressures also have a `reference` "
        "(gauge or absolute).\n"
        "# If the layout has that section already, put these inputs below its inputs.\n",
        kUnknownKind);
  }
  text += group.section + ":\n" + line("  ", "unit", group.unit);
  if (group.section == "pressures") text += line("  ", "reference", group.reference);
  text += group.section == "pressures" ? "  # `zero`: a sensor's value without pressure; softarm check "
                                         "finds it in trials that begin vented\n"
                                       : "";
  text += "  inputs:\n";
  for (const GuessedInput& input : group.inputs) {
    const CsvNumbers& numbers = guess.shape.columns[input.column];
    text += fmt::format("    # {}{:.4g} to {:.4g}, at first {:.4g}\n    - topic: {}\n      column: {}\n",
                        input.why.empty() ? "" : "Guessed: " + input.why + "; ", numbers.low, numbers.high,
                        numbers.level, input.topic, column(guess, input.column));
  }
  return text;
}

/// Entries of inputs as comments, to be uncommented.
std::string not_understood_text(const LayoutGuess& guess) {
  if (guess.not_understood.empty()) return "";
  const std::size_t known = guess.inputs.empty() ? 0 : guess.inputs.back().inputs.size();
  const std::string section = guess.inputs.empty() ? "pressures" : guess.inputs.back().section;
  std::string text =
      fmt::format("# Not understood: uncomment those that are inputs, {} (pressures, tensions or angles).\n",
                  guess.inputs.empty() ? "with their section and unit" : "below the inputs of their section");
  if (guess.inputs.empty()) text += "# " + section + ":\n#   unit:\n#   reference: gauge\n#   inputs:\n";
  for (std::size_t i = 0; i < guess.not_understood.size(); ++i) {
    const std::size_t c = guess.not_understood[i];
    const CsvNumbers& numbers = guess.shape.columns[c];
    text += fmt::format("#     - topic: {}\n#       column: {}    # {:.4g} to {:.4g}, at first {:.4g}\n",
                        topic_of(section, known + i + 1), column(guess, c), numbers.low, numbers.high,
                        numbers.level);
  }
  return text;
}

}  // namespace

std::string topic_of(const std::string& section, std::size_t number) {
  if (section == "pressures") return fmt::format("/pressure/chamber_{}", number);
  if (section == kUnknownKind) return fmt::format("/input/{}", number);
  return section == "angles" ? fmt::format("/servo/{}/angle", number)
                             : fmt::format("/tendon/{}/tension", number);
}

std::string to_yaml(const LayoutGuess& guess, const std::string& source) {
  std::string text = fmt::format(
      "# Column layout for softarm import, drafted by softarm import --guess from {} ({} columns, {} rows "
      "read).\n"
      "# Check the lines with \"Guessed\". Where \"FILL IN\" stands, the file gives no answer: an import "
      "refuses the\n"
      "# layout until this is filled in. config/layouts/template.yaml shows every key.\n",
      source, guess.shape.columns.size(), guess.shape.rows);
  text += format_text(guess.shape.format) + time_text(guess) + mocap_text(guess);
  for (const GuessedInputs& group : guess.inputs) text += inputs_text(guess, group);
  text += not_understood_text(guess);
  if (!guess.not_used.empty()) {
    text += "# Not used:\n";
    for (const std::string& what : guess.not_used) text += "#   " + what + "\n";
  }
  return text +
         "# The payload in kg, from these times of the recording on. Without this section it is unknown, or "
         "given by --payload.\n"
         "# payload:\n#   - from_s: 0\n#     kg: 0\n";
}

}  // namespace softarm::trial
