#include "new_arm_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>
#include <map>
#include <sstream>

#include "softarm/arm/arm_file.h"

namespace softarm::app {
namespace {

constexpr double kSoftPa = 2e5;  // modulus of soft silicone
// Sizes to begin with, in diameters: of the shipped arms, and of how such arms are built.
constexpr double kGainPerCube = 0.1;            // moment per pressure of a chamber, over d^3
constexpr double kTendonOffset = 0.35;          // of a tendon from the axis
constexpr double kLever = 0.4, kSpoolM = 0.01;  // of a cable from the axis; and what winds it up
constexpr double kCentralArea = 0.08;           // of a chamber on the axis, of the section
// What the arm file takes.
constexpr double kLeastRangeNm2 = 1e-7, kLeastAxialN = 0.1, kMostGain = 1e-3;
constexpr std::size_t kLongestWords = 60;
constexpr std::size_t kCommentAt = 44;  // column of the comments

double section_m2(const NewSegment& s) {
  return 0.25 * M_PI * s.diameter_m * s.diameter_m;
}

/// Meaning and allowed values of each key, by "section key", from the table that arm files are checked
/// against.
const std::map<std::string, std::string>& meanings() {
  static const std::map<std::string, std::string> all = [] {
    std::map<std::string, std::string> found;
    std::istringstream table(arm::describe_arm_keys());
    std::string section;
    for (std::string line; std::getline(table, line);) {
      if (boost::starts_with(line, "### `")) section = line.substr(5, line.rfind('`') - 5);
      if (!boost::starts_with(line, "| `")) continue;
      std::vector<std::string> cells;
      boost::split(cells, line, [](char c) { return c == '|'; });
      if (cells.size() < 5) continue;
      for (std::string& cell : cells) boost::trim(cell);
      const std::string key = cells[1].substr(1, cells[1].size() - 2);
      // Ranges, and words that the meaning does not explain already.
      const std::string first = cells[2].substr(0, cells[2].find(','));
      const bool words = cells[2].find(", ") != std::string::npos && cells[2].size() < kLongestWords &&
                         !boost::contains(cells[4], first);
      const bool range = boost::contains(cells[2], "[") || words;
      found[section + " " + key] = cells[4] + (range ? "; " + cells[2] : "");
    }
    return found;
  }();
  return all;
}

/// The document, with a comment behind each key.
class Document {
 public:
  /// @param lead indent, with "- " for the first key of an entry
  /// @param guess a value that nobody has measured
  void key(const std::string& section, const std::string& lead, const std::string& key,
           const std::string& value, bool guess = false) {
    std::string text = lead + key + ":" + (value.empty() ? "" : " " + value);
    const auto meaning = meanings().find(section + " " + key);
    if (meaning != meanings().end() && annotated_.insert({section + " " + key, true}).second) {
      text.resize(std::max(kCommentAt, text.size() + 1), ' ');
      text += "# " + std::string(guess ? "A GUESS, to be identified: " : "") + meaning->second;
    } else if (guess) {
      text.resize(std::max(kCommentAt, text.size() + 1), ' ');
      text += "# a guess";
    }
    out_ += text + "\n";
  }
  void line(const std::string& text) { out_ += text + "\n"; }
  const std::string& text() const { return out_; }

 private:
  std::string out_;
  std::map<std::string, bool> annotated_;  // an entry's keys are explained once
};

std::string shown(double x) {
  return fmt::format("{:.4g}", x);
}

/// Names of the inputs, numbered over the whole arm.
struct Counters {
  int chamber = 0, tendon = 0, servo = 0;
};

void actuators_text(const NewSegment& s, Counters& counters, Document& doc) {
  const auto list = [&](bool has, const std::string& list_key, const std::string& name, int& counter,
                        const auto& own_keys) {
    if (!has) return;
    const std::string section = "segments[]." + list_key + "[]";
    doc.key("segments[]", "    ", list_key, "");
    for (const double angle : s.angles_deg) {
      doc.key(section, "      - ", "input", fmt::format("{}_{}", name, ++counter));
      doc.key(section, "        ", "bending_direction_deg", fmt::format("{:g}", angle));
      own_keys(section);
    }
  };
  list(s.drive.chambers, "chambers", "chamber", counters.chamber, [&](const std::string& section) {
    doc.key(section, "        ", "moment_gain_nm_per_pa",
            shown(std::min(kMostGain, kGainPerCube * std::pow(s.diameter_m, 3))), true);
  });
  if (s.drive.central) {
    doc.key("segments[]", "    ", "central_chamber", "");
    doc.key("segments[].central_chamber", "      ", "input", fmt::format("chamber_{}", ++counters.chamber));
    doc.key("segments[].central_chamber", "      ", "area_m2", shown(kCentralArea * section_m2(s)), true);
  }
  list(s.drive.tendons, "tendons", "tendon", counters.tendon, [&](const std::string& section) {
    doc.key(section, "        ", "offset_m", shown(kTendonOffset * s.diameter_m), true);
  });
  list(s.drive.cables, "cables", "servo", counters.servo, [&](const std::string& section) {
    doc.key(section, "        ", "curvature_gain_per_m_rad",
            shown(kSpoolM / (s.length_m * kLever * s.diameter_m)), true);
  });
}

void segments_text(const NewArm& arm, Counters& counters, Document& doc) {
  doc.key("(top)", "", "segments", "");
  int count = 0;
  for (const NewSegment& s : arm.segments) {
    doc.key("segments[]", "  - ", "name", fmt::format("segment_{}", ++count));
    doc.key("segments[]", "    ", "length_m", shown(s.length_m));
    doc.key("segments[]", "    ", "mass_per_length_kg_m", shown(s.mass_kg / s.length_m));
    doc.key("segments[]", "    ", "diameter_m", shown(s.diameter_m));
    doc.key("segments[]", "    ", "bending_stiffness", "");
    doc.key("segments[].bending_stiffness", "      ", "base_nm2", shown(s.stiffness_nm2), true);
    doc.key("segments[].bending_stiffness", "      ", "range_nm2",
            fmt::format("[{}, {}]", shown(std::max(kLeastRangeNm2, 0.05 * s.stiffness_nm2)),
                        shown(20.0 * s.stiffness_nm2)));
    // Only what stretches tells it.
    if (s.drive.central)
      doc.key("segments[]", "    ", "axial_stiffness_n",
              shown(std::max(kLeastAxialN, kSoftPa * section_m2(s))), true);
    actuators_text(s, counters, doc);
  }
}

void inputs_text(const Counters& counters, Document& doc) {
  doc.key("(top)", "", "inputs", "");
  doc.key("inputs", "  ", "bodies", "");
  doc.key("inputs.bodies", "    ", "topic", "/mocap/<body>/pose");
  doc.key("inputs.bodies", "    ", "type", "geometry_msgs/PoseStamped");
  const auto list = [&](int count, const std::string& key, const std::string& name, const std::string& topic,
                        const std::string& type, const std::string& unit) {
    if (count == 0) return;
    const std::string section = "inputs." + key + "[]";
    doc.key("inputs", "  ", key, "");
    for (int i = 1; i <= count; ++i) {
      doc.key(section, "    - ", "name", fmt::format("{}_{}", name, i));
      doc.key(section, "      ", "topic", fmt::format(topic, i));
      doc.key(section, "      ", "type", type);
      doc.key(section, "      ", "unit", unit);
      if (key == "pressures") doc.key(section, "      ", "reference", "absolute");
    }
  };
  list(counters.chamber, "pressures", "chamber", "/pressure/chamber_{}", "sensor_msgs/FluidPressure", "Pa");
  list(counters.tendon, "tensions", "tendon", "/tendon/{}/tension", "std_msgs/Float64", "N");
  list(counters.servo, "angles", "servo", "/servo/{}/angle", "std_msgs/Float64", "rad");
}

void base_text(const NewArm& arm, Document& doc) {
  doc.key("(top)", "", "base", "");
  if (!arm.base_body.empty()) {
    doc.key("base", "  ", "body", arm.base_body);
    doc.key("base", "  ", "rod_in_body", "{}");
    return;
  }
  doc.key("base", "  ", "fixed", "");
  doc.line("    # MEASURE the place where the arm begins, in the mocap frame");
  doc.key("base.fixed", "    ", "position_m", "[0, 0, 0]");
  doc.key("base.fixed", "    ", "attitude", arm.attitude);
}

void bodies_text(const NewArm& arm, Document& doc) {
  doc.key("(top)", "", "bodies", "");
  for (const NewBody& body : arm.bodies) {
    const bool tip = std::abs(body.arclength_m - arm.length_m()) < 1e-9;
    doc.key("bodies[]", "  - ", "name", body.name);
    doc.key("bodies[]", "    ", "arclength_m", tip ? "tip" : fmt::format("{:.6g}", body.arclength_m));
    doc.key("bodies[]", "    ", "orientation_usable", "false");
  }
}

Counters counters_of(const NewArm& arm) {
  Counters counters;
  Document none;
  for (const NewSegment& s : arm.segments) actuators_text(s, counters, none);
  return counters;
}

}  // namespace

double NewArm::length_m() const {
  double sum = 0.0;
  for (const NewSegment& s : segments) sum += s.length_m;
  return sum;
}

double guessed_stiffness_nm2(double diameter_m) {
  return std::clamp(kSoftPa * M_PI / 64.0 * std::pow(diameter_m, 4), kLeastStiffnessNm2, kMostStiffnessNm2);
}

std::string arm_text(const NewArm& arm) {
  Document doc;
  doc.line(
      "# Written by softarm new-arm. SI units; the end of a key is its unit. config/arms/README.md lists all "
      "keys;");
  doc.line(
      "# online_200mm.yaml shows them in use. A guess is a starting value that follows from the diameter; "
      "softarm");
  doc.line("# identify fits it to trials.");
  doc.key("(top)", "", "format", "1");
  doc.key("(top)", "", "name", arm.name);
  doc.key("(top)", "", "gravity_m_s2", "[0, 0, -9.80665]");
  base_text(arm, doc);
  Counters counters;
  segments_text(arm, counters, doc);
  doc.key("(top)", "", "payload", "");
  doc.key("payload", "  ", "arclength_m", "tip");
  doc.key("payload", "  ", "range_kg", "[0, 1]");
  doc.key("(top)", "", "noise", "");
  doc.key("noise", "  ", "position_sd_m", "0.0005");
  bodies_text(arm, doc);
  inputs_text(counters, doc);
  doc.key("(top)", "", "estimator", "");
  doc.key("estimator", "  ", "method", "full_points");
  doc.key("estimator", "  ", "unknown", "stiffness");
  return doc.text();
}

std::string layout_text(const NewArm& arm) {
  std::string text =
      "# Column layout of the recordings of " + arm.name +
      " for softarm import, written by softarm new-arm: time, bodies, inputs, in this order.\n"
      "# Enter the columns and units of your files (softarm import --guess FILE drafts a "
      "layout from one of them);\n"
      "# config/layouts/template.yaml explains every key.\n"
      "separator: comma\ntime:\n  column: 1\n  # s, ms, us or ns\n  unit: s\n"
      "mocap:\n  # Unit of the positions: m, cm or mm\n  unit: m\n  # The axis that points up in "
      "the recording: z or y\n"
      "  up: z\n  bodies:\n";
  int column = 1;
  const auto body = [&](const std::string& name) {
    text += fmt::format(
        "    - name: {}\n      position: [{}, {}, {}]\n      orientation: [{}, {}, {}, {}]\n"
        "      orientation_order: xyzw\n",
        name, column + 1, column + 2, column + 3, column + 4, column + 5, column + 6, column + 7);
    column += 7;
  };
  if (!arm.base_body.empty()) body(arm.base_body);
  for (const NewBody& b : arm.bodies) body(b.name);
  const Counters counters = counters_of(arm);
  const auto list = [&](int count, const std::string& head, const std::string& topic) {
    if (count == 0) return;
    text += head + "  inputs:\n";
    for (int i = 1; i <= count; ++i)
      text += fmt::format("    - topic: {}\n      column: {}\n", fmt::format(topic, i), ++column);
  };
  list(counters.chamber,
       "pressures:\n  # Pa, hPa, kPa, MPa, mbar, bar or psi\n  unit: kPa\n  # gauge (above ambient) or "
       "absolute\n"
       "  reference: gauge\n",
       "/pressure/chamber_{}");
  list(counters.servo, "angles:\n  # rad or deg\n  unit: rad\n", "/servo/{}/angle");
  list(counters.tendon, "tensions:\n  # N, mN, kgf or gf\n  unit: N\n", "/tendon/{}/tension");
  return text +
         "# The payload in kg from a time of the recording on; --payload on the command line replaces it.\n"
         "payload:\n  - from_s: 0\n    kg: 0\n";
}

}  // namespace softarm::app
