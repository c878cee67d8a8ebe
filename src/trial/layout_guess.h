// A draft of a column layout, guessed from a recording.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "csv_shape.h"

namespace softarm::trial {

/// Something that was guessed, or that the file does not tell: then `text` is empty and `why` says what to
/// fill in.
struct Guess {
  std::string text;
  std::string why;
};

struct GuessedBody {
  std::string name;
  std::vector<std::size_t> position, orientation;  ///< columns from 0; orientation may be empty
  Guess order;
  std::string why;
};

struct GuessedInput {
  std::string topic;
  std::size_t column = 0;
  std::string why;
};

/// Section of inputs of which the file does not tell whether they are pressures, angles or tensions: a layout
/// that has it is refused.
inline constexpr char kUnknownKind[] = "FILL_IN";

/// pressures, angles, tensions or kUnknownKind
struct GuessedInputs {
  std::string section;
  Guess unit;
  Guess reference;  ///< of pressures
  std::vector<GuessedInput> inputs;
};

struct LayoutGuess {
  CsvShape shape;
  std::optional<std::size_t> time, trial;
  Guess time_unit;
  bool counts_samples =
      false;  ///< the time column is a number of samples, or there is none: a period is to be given
  bool from_epoch = false;
  Guess length_unit, up;
  bool drop_repeated = false;
  std::vector<GuessedBody> bodies;
  std::vector<GuessedInputs> inputs;
  std::vector<std::size_t> not_understood;  ///< columns of numbers that may be inputs: written as comments
  std::vector<std::string> not_used;        ///< a line each: which columns, and what they hold
};

/// Looks for what moves as time, poses and inputs do: time by its steps; unit quaternions by their norm;
/// positions beside them, by names that differ in x, y and z, or three by three; inputs by name, else by what
/// is left over. No column of numbers is passed over in silence.
/// @throws CsvError where the file cannot be read or has no rows of numbers
LayoutGuess guess_layout(const std::string& path);

/// The draft with a comment for each guess, and FILL IN where the file does not tell: what is left blank the
/// reader of layouts refuses in one line.
/// @param source name of the recording, for the first line
std::string to_yaml(const LayoutGuess& guess, const std::string& source);

/// A topic for an input of a section (pressures, angles, tensions).
/// @param number from 1
std::string topic_of(const std::string& section, std::size_t number);

/// How many values are to be filled in.
std::size_t blanks(const LayoutGuess& guess);

}  // namespace softarm::trial
