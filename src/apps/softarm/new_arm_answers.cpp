#include "new_arm_answers.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <optional>

#include "command.h"
#include "math/parse_number.h"

namespace softarm::app {

std::vector<std::string> parts(const std::string& text, char at) {
  std::vector<std::string> all;
  boost::split(all, text, [at](char c) { return c == at; });
  for (std::string& part : all) boost::trim(part);
  return all;
}

std::vector<std::string> per_segment(const Told& told, const std::string& flag, std::size_t segments,
                                     char at) {
  std::vector<std::string> all = parts(told.at(flag), at);
  if (all.size() == 1) all.resize(segments, all.front());
  if (all.size() != segments)
    throw Failure(fmt::format("--{} {}: must be one value, or {}, one for each segment", flag, told.at(flag),
                              segments));
  return all;
}

namespace {

double number_of(const std::string& flag, const std::string& text, double low, double high,
                 const std::string& unit) {
  const std::optional<double> value = math::parse_number(text);
  if (!value || !(*value >= low && *value <= high))
    throw Failure(fmt::format("--{} {}: must be a number from {:g} to {:g}{}{}", flag, text, low, high,
                              unit.empty() ? "" : " ", unit));
  return *value;
}

}  // namespace

std::size_t whole(const std::string& flag, const std::string& text, double most) {
  const double value = number_of(flag, text, 1.0, most, "");
  if (value != std::floor(value)) throw Failure(fmt::format("--{} {}: must be a whole number", flag, text));
  return static_cast<std::size_t>(value);
}

std::size_t count_of(const Told& told) {
  return whole("segments", told.at("segments"), 20.0);
}

namespace {

/// A number for each segment.
std::vector<double> numbers_of(const Told& told, const std::string& flag, double low, double high,
                               const std::string& unit) {
  std::vector<double> numbers;
  for (const std::string& text : per_segment(told, flag, count_of(told)))
    numbers.push_back(number_of(flag, text, low, high, unit));
  return numbers;
}

}  // namespace

std::vector<double> lengths_of(const Told& told) {
  return numbers_of(told, "length", 0.005, 10.0, "m");
}

std::vector<double> masses_of(const Told& told) {
  const std::vector<double> lengths_m = lengths_of(told);
  const std::vector<std::string> texts = per_segment(told, "mass", lengths_m.size());
  std::vector<double> masses;
  for (std::size_t i = 0; i < texts.size(); ++i)
    masses.push_back(number_of("mass", texts[i], 0.0, 50.0 * lengths_m[i], "kg"));
  return masses;
}

std::vector<double> diameters_of(const Told& told) {
  return numbers_of(told, "diameter", 5e-4, 1.0, "m");
}

std::vector<double> stiffnesses_of(const Told& told) {
  if (told.count("stiffness"))
    return numbers_of(told, "stiffness", kLeastStiffnessNm2, kMostStiffnessNm2, "N m^2");
  std::vector<double> stiffnesses;
  for (const double diameter_m : diameters_of(told)) stiffnesses.push_back(guessed_stiffness_nm2(diameter_m));
  return stiffnesses;
}

NewDrive drive_of(const std::string& text) {
  NewDrive drive;
  for (const std::string& kind : parts(text, '+')) {
    bool* has = kind == "chambers"  ? &drive.chambers
                : kind == "tendons" ? &drive.tendons
                : kind == "cables"  ? &drive.cables
                : kind == "central" ? &drive.central
                                    : nullptr;
    if (!has)
      throw Failure(
          fmt::format("--kind {}: must be chambers, tendons, cables or central, joined by +", text));
    *has = true;
  }
  return drive;
}

bool any_bends(const Told& told) {
  const auto kind = told.find("kind");
  if (kind == told.end()) return true;
  const std::vector<std::string> all = parts(kind->second, ',');
  return std::any_of(all.begin(), all.end(), [](const std::string& k) { return drive_of(k).bends(); });
}

namespace {

std::vector<double> angles_of(const Told& told, std::size_t segment, std::size_t segments,
                              std::size_t count) {
  std::vector<double> angles;
  if (told.count("angles") == 0) {
    for (std::size_t i = 0; i < count; ++i)
      angles.push_back(360.0 * static_cast<double>(i) / static_cast<double>(count));
    return angles;
  }
  const std::string text = per_segment(told, "angles", segments, '/')[segment];
  for (const std::string& angle : parts(text, ','))
    angles.push_back(number_of("angles", angle, -360.0, 360.0, "deg"));
  if (angles.size() != count)
    throw Failure(fmt::format("--angles {}: must be {}, one for each of --actuators", text, count));
  return angles;
}

}  // namespace

std::vector<NewDrive> drives_of(const Told& told) {
  std::vector<NewDrive> drives;
  for (const std::string& kind : per_segment(told, "kind", count_of(told))) drives.push_back(drive_of(kind));
  return drives;
}

std::vector<std::vector<double>> all_angles_of(const Told& told) {
  const std::vector<NewDrive> drives = drives_of(told);
  std::vector<std::vector<double>> angles(drives.size());
  for (std::size_t i = 0; i < drives.size(); ++i) {
    if (!drives[i].bends()) continue;
    const std::size_t actuators = whole("actuators", per_segment(told, "actuators", drives.size())[i], 32.0);
    angles[i] = angles_of(told, i, drives.size(), actuators);
  }
  return angles;
}

namespace {

std::vector<NewSegment> segments_of(const Told& told) {
  const std::vector<NewDrive> drives = drives_of(told);
  const std::vector<double> lengths_m = lengths_of(told), masses_kg = masses_of(told),
                            diameters_m = diameters_of(told), stiffnesses_nm2 = stiffnesses_of(told);
  const std::vector<std::vector<double>> angles_deg = all_angles_of(told);
  std::vector<NewSegment> segments(drives.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    segments[i].drive = drives[i];
    segments[i].length_m = lengths_m[i];
    segments[i].mass_kg = masses_kg[i];
    segments[i].diameter_m = diameters_m[i];
    segments[i].stiffness_nm2 = stiffnesses_nm2[i];
    segments[i].angles_deg = angles_deg[i];
  }
  return segments;
}

void refuse_name(const std::string& flag, const std::string& name) {
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  const auto part = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  if (name.empty() || !letter(name[0]) || !std::all_of(name.begin(), name.end(), part))
    throw Failure(fmt::format("--{} {}: must be a name: a letter, then letters, digits or _", flag, name));
}

}  // namespace

std::vector<NewBody> bodies_of(const Told& told) {
  const std::string& text = told.at("bodies");
  const std::vector<double> lengths_m = lengths_of(told);
  const double length_m = std::accumulate(lengths_m.begin(), lengths_m.end(), 0.0);
  std::vector<NewBody> bodies;
  if (text.find(':') == std::string::npos) {
    const std::size_t count = whole("bodies", text, 50.0);
    for (std::size_t i = 1; i <= count; ++i) {
      const double at = static_cast<double>(i) / static_cast<double>(count);
      bodies.push_back(
          {i == count ? "tip" : fmt::format("ring_{}", i), i == count ? length_m : at * length_m});
    }
    return bodies;
  }
  for (const std::string& body : parts(text, ',')) {
    const std::vector<std::string> pair = parts(body, ':');
    if (pair.size() != 2)
      throw Failure(fmt::format("--bodies {}: must be name:arclength in m, or name:tip", body));
    refuse_name("bodies", pair[0]);
    if (std::any_of(bodies.begin(), bodies.end(), [&](const NewBody& b) { return b.name == pair[0]; }))
      throw Failure(fmt::format("--bodies {}: another body has that name", body));
    bodies.push_back(
        {pair[0], pair[1] == "tip" ? length_m : number_of("bodies", pair[1], 1e-4, length_m, "m")});
    if (bodies.size() > 1 && !(bodies.back().arclength_m > bodies[bodies.size() - 2].arclength_m))
      throw Failure(
          fmt::format("--bodies {}: list bodies from base to tip, each beyond the one before", body));
  }
  return bodies;
}

namespace {

bool is_attitude(const std::string& base) {
  return base == "hanging" || base == "standing" || base == "horizontal";
}

}  // namespace

std::string base_of(const Told& told) {
  const std::string base = told.count("base") ? told.at("base") : "base";
  if (is_attitude(base)) return base;
  refuse_name("base", base);
  for (const NewBody& body : bodies_of(told)) {
    if (body.name == base) throw Failure(fmt::format("--base {}: is a body on the arm already", base));
  }
  return base;
}

NewArm arm_of(const Told& told) {
  NewArm arm;
  arm.name = std::filesystem::path(told.at("out")).stem().string();
  std::replace_if(
      arm.name.begin(), arm.name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); },
      '_');
  arm.segments = segments_of(told);
  arm.bodies = bodies_of(told);
  const std::string base = base_of(told);
  (is_attitude(base) ? arm.attitude : arm.base_body) = base;
  return arm;
}

}  // namespace softarm::app
