// A laboratory's CSV recording, described by its columns.
#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace softarm::trial {

/// A layout or a recording that cannot be used. what() is one line: file, key or line, value, allowed values.
class CsvError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One column, by its number (1 is the first) or, where the file has a header line, by its name.
struct CsvColumn {
  std::string label;       ///< as written in the layout
  std::string key;         ///< key of the layout that named it, for messages
  bool in_inputs = false;  ///< of the inputs file that is joined, not of the recording
};

/// What the lines of a file look like.
struct CsvFormat {
  char separator = ',';  ///< ' ' stands for any white space
  char decimal = '.';
  bool header = false;
  bool units_row = false;  ///< a line of units stands below the header (or before the data)
  int skip_lines = 0;      ///< lines before the header (or the data)
};

/// Whether a layout may name this character as a separator: one that is no part of a number.
bool may_separate(char c);

/// Columns of one rigid body's pose.
struct CsvBody {
  std::string name;  ///< topic /mocap/<name>/pose
  std::array<CsvColumn, 3> position;
  /// x y z w, whatever the order in the file; absent: only the position was measured
  std::optional<std::array<CsvColumn, 4>> orientation;
  /// Of a body that does not turn: its unit quaternion x y z w in the recording's axes, in place of columns.
  std::optional<std::array<double, 4>> fixed_orientation_xyzw;
};

/// One pressure column. Published as absolute Pa: (value - zero) * scale_to_pa (+ ambient if gauge).
struct CsvPressure {
  std::string topic;
  CsvColumn column;
  std::string unit;  ///< as the layout has it
  double scale_to_pa = 1.0;
  bool gauge = false;
  double zero = 0.0;  ///< what the sensor reads too much, in the recording's unit
};

/// A column that becomes a std_msgs/Float64: an angle in rad or a tension in N, (value - zero) * scale_to_si.
struct CsvScalar {
  std::string topic;
  CsvColumn column;
  std::string unit;  ///< as the layout has it
  double scale_to_si = 1.0;
  double zero = 0.0;  ///< in the recording's unit
};

/// A column that says what hangs on the arm; published when it changes.
struct CsvPayloadColumn {
  CsvColumn column;
  double scale_to_kg = 1.0;
};

/// A second file with the inputs of each row of the recording, found by an id that both have.
struct CsvJoinLayout {
  CsvColumn id;         ///< in the recording
  CsvColumn inputs_id;  ///< in the inputs file
  CsvFormat format;     ///< of the inputs file
};

/// The payload from `from_s` (time of the recording) on.
struct CsvPayloadStep {
  double from_s = 0.0;
  double kg = 0.0;
};

enum class UpAxis { kZ, kY };

/// How to read a CSV recording. Every conversion to SI is named here.
struct CsvLayout {
  CsvFormat format;
  std::optional<CsvColumn> time_column;  ///< absent: the row's number, from 0
  double time_scale_to_s = 1.0;          ///< s per unit of the column, or per row
  double start_stamp_s = 1600000000.0;   ///< added to every time; a constant, so that bags are reproducible
  double position_scale_to_m = 1.0;
  UpAxis up = UpAxis::kZ;
  double bodies_ahead_s = 0.0;  ///< what the clock of the poses is ahead of the inputs', subtracted from it
  /// Whose value says to which trial a row belongs, where a file holds several. Rows of a trial are together.
  std::optional<CsvColumn> trial_column;
  std::optional<CsvJoinLayout> join;
  bool drop_repeated = false;  ///< poses all equal to the last row's are not a new measurement
  std::vector<CsvBody> bodies;
  double ambient_pressure_pa = 101325.0;
  std::vector<CsvPressure> pressures;
  std::vector<CsvScalar> scalars;
  std::optional<CsvPayloadColumn> payload_column;
  std::vector<CsvPayloadStep> payload;  ///< empty: unknown, nothing is published
};

/// Parses a layout, see config/layouts/template.yaml for every key.
/// @param text the document
/// @param source its name for messages (usually the file)
/// @throws CsvError on a syntax error, an unknown or missing key, an unknown unit, or an impossible value.
CsvLayout parse_csv_layout(const std::string& text, const std::string& source);

}  // namespace softarm::trial
