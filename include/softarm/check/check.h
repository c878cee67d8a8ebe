// What is wrong with a recording, before anyone trusts it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/export.h"
#include "softarm/trial/recording.h"

namespace softarm::check {

enum class Severity {
  kInformation,  ///< worth knowing; nothing to repair
  kWarning,      ///< costs accuracy, or may; look at it
  kSerious,      ///< spoils estimates as long as it is not repaired
};

SOFTARM_EXPORT std::string to_string(Severity severity);  ///< "information", "warning", "serious"

/// A stretch of the recording, s since its first sample.
struct CheckSpan {
  double from_s = 0.0;
  double to_s = 0.0;
};

/// One thing that was found.
struct CheckFinding {
  Severity severity = Severity::kInformation;
  std::string id;                   ///< stable, for programs: "frozen_body"; doc/check.md lists them
  std::string where;                ///< body, input or topic; empty: the recording
  std::string what;                 ///< one sentence with the figures
  std::vector<CheckSpan> spans;     ///< the longest first dozen, in order; empty: throughout
  std::optional<double> figure;     ///< the measured size, SI
  std::string unit;                 ///< of the figure: "m", "s", "Pa", "rad", "1"
  std::optional<double> figure_sd;  ///< its standard deviation, where it is an estimate
  std::string remedy;               ///< a sentence
  std::string setting;              ///< key and value that repair it, as the file has them; empty: none does
};

/// Noise and extent of a recording's streams, for pictures.
struct CheckStream {
  std::string name;
  bool is_body = false;
  double rate_hz = 0.0;  ///< median
  std::uint64_t samples = 0;
  std::optional<double> rest_level;  ///< inputs: mean at rest, SI; pressures as gauge, vacuum below ambient
  std::optional<double> noise_sd;    ///< bodies: white noise of a coordinate, m; inputs: SI
};

/// What an input shows at rest, and how a file says that this is its zero.
struct ZeroAtRest {
  std::string input;
  double level = 0.0;        ///< mean at rest, SI; pressures as gauge, vacuum below ambient
  double limit = 0.0;        ///< less is no offset, SI
  std::string unit_si;       ///< "Pa", "N" or "rad"
  bool may_be_held = false;  ///< nothing tells an offset from an input that is held there
  std::string path;          ///< of its zero, in the layout by which it was imported, else in the arm file
  bool of_layout = false;
  std::string unit;          ///< in which that zero is given
  double si_per_unit = 1.0;  ///< negative where the level counts downwards (vacuum)
  double zero = 0.0;         ///< that it has now, in that unit
};

struct SOFTARM_EXPORT CheckReport {
  std::string name;
  double duration_s = 0.0;
  std::vector<CheckStream> streams;
  std::vector<CheckFinding> findings;  ///< most serious first
  std::vector<ZeroAtRest> zeros;       ///< of the inputs whose level at rest may be their zero

  /// The worst of all findings; nothing where there is none.
  std::optional<Severity> worst() const;
};

/// Looks at a recording with the eyes of one who knows what goes wrong with motion capture, pressure sensors
/// and clocks. The same recording gives the same report.
///
/// 1. Topics; stamps and receipt; numbers that are none.
/// 2. Bodies: exchanged, frozen, lost, jumping, turned over; a mount that moves.
/// 3. Against the arm: units, order and spacing, base attitude, gravity, places that drift.
/// 4. Inputs: units, levels at rest, noise, steps, stuck and saturated values.
/// 5. The trial: rest at both ends, payload, noise; the clocks of bodies and inputs against each other.
SOFTARM_EXPORT CheckReport check_recording(const trial::CheckRecording& recording, const arm::Arm& arm);

/// Of a bag that cannot be read at all: a finding, too, so that others are still looked at.
/// @param why one line
SOFTARM_EXPORT CheckReport unreadable(const std::string& name, const std::string& why);

/// What several recordings of one arm say together: zeros of sensors, from all trials with a rest. The
/// reports' own findings of zeros are then information and propose the common one, or, where the trials
/// disagree, none. So with every setting that they propose differently. Nothing below two recordings.
SOFTARM_EXPORT std::vector<CheckFinding> check_together(std::vector<CheckReport>& reports);

/// For people: one finding after another, the most serious first, each with its remedy.
/// @param with_information false: findings that are mere information are left out
SOFTARM_EXPORT std::string to_text(const CheckReport& report, bool with_information = true);

/// All reports as one JSON document, {"format": 1, "recordings": [...]}. Indented, ends with a line end.
/// @param together of check_together()
SOFTARM_EXPORT std::string to_json(const std::vector<CheckReport>& reports, const std::string& arm,
                                   const std::vector<CheckFinding>& together = {});
/// Those for people; empty where there are none.
/// @param recordings how many
SOFTARM_EXPORT std::string to_text(const std::vector<CheckFinding>& together, std::size_t recordings,
                                   bool with_information = true);

/// All of it for people: one report after another, then what they say together.
SOFTARM_EXPORT std::string to_text(const std::vector<CheckReport>& reports,
                                   const std::vector<CheckFinding>& together, bool with_information = true);

}  // namespace softarm::check
