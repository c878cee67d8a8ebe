#include "guess_poses.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

namespace softarm::trial {

const std::vector<double>& values(const LayoutGuess& guess, std::size_t column) {
  return guess.shape.columns[column].values;
}

std::string stem_of(const std::string& name, char axis) {
  const std::string lower = boost::to_lower_copy(name);
  for (std::size_t i = lower.size(); i-- > 0;) {
    const auto letter = [&](std::size_t k) {
      return k < lower.size() && std::isalpha(static_cast<unsigned char>(lower[k]));
    };
    if (lower[i] != axis || (i > 0 && letter(i - 1)) || letter(i + 1)) continue;
    return lower.substr(0, i) + "*" + lower.substr(i + 1);
  }
  // "tipX", "posx"
  if (lower.size() > 1 && lower.back() == axis) return lower.substr(0, lower.size() - 1) + "*";
  return "";
}

namespace {

constexpr double kUnitShare = 0.95;  // of the rows are unit quaternions
constexpr std::size_t kFewDistinct = 5;

/// By how much four columns are off a unit quaternion, rms; nothing where they are none.
std::optional<double> off_unit(const LayoutGuess& guess, const std::set<std::size_t>& used,
                               std::size_t first) {
  if (first + 4 > guess.shape.columns.size()) return std::nullopt;
  for (std::size_t c = first; c < first + 4; ++c) {
    if (used.count(c)) return std::nullopt;
  }
  std::size_t unit = 0, seen = 0;
  double squares = 0.0;
  for (std::size_t row = 0; row < guess.shape.rows; ++row) {
    double norm2 = 0.0;
    for (std::size_t c = first; c < first + 4; ++c) norm2 += values(guess, c)[row] * values(guess, c)[row];
    if (!std::isfinite(norm2) || norm2 == 0.0) continue;  // a lost body
    const double off = std::sqrt(norm2) - 1.0;
    ++seen;
    if (std::abs(off) > kUnitNorm) continue;
    ++unit;
    squares += off * off;
  }
  if (seen == 0 || static_cast<double>(unit) < kUnitShare * static_cast<double>(seen)) return std::nullopt;
  return std::sqrt(squares / static_cast<double>(unit));
}

bool varies(const LayoutGuess& guess, std::size_t first, std::size_t count) {
  const auto begin = guess.shape.columns.begin() + static_cast<std::ptrdiff_t>(first);
  return std::any_of(begin, begin + static_cast<std::ptrdiff_t>(count),
                     [](const CsvNumbers& c) { return c.distinct >= kFewDistinct; });
}

/// The stem of neighbouring names that differ in these letters alone, in their order; empty where they do
/// not.
std::string common_stem(const LayoutGuess& guess, std::size_t first, const std::string& axes) {
  const auto& columns = guess.shape.columns;
  const std::string stem = stem_of(columns[first].name, axes[0]);
  for (std::size_t i = 1; i < axes.size(); ++i) {
    if (stem != stem_of(columns[first + i].name, axes[i])) return "";
  }
  return stem;
}

/// Names of a position: neither of a turn ("base_qx", "tip_rot_x") nor of a rate.
bool is_named_triple(const LayoutGuess& guess, std::size_t first) {
  const std::string stem = common_stem(guess, first, "xyz");
  if (stem.empty() || stem == "q*") return false;
  const auto has = [&](const char* word) { return boost::contains(stem, word); };
  return !has("_q*") && !has("_r*") && !has("rot") && !has("quat") && !has("orient") && !has("euler") &&
         !has("vel") && !has("acc");
}

/// Names of a quaternion: "base_qx", "base_qy", "base_qz", "base_qw", or w first.
bool is_named_quaternion(const LayoutGuess& guess, std::size_t first) {
  return !common_stem(guess, first, "xyzw").empty() || !common_stem(guess, first, "wxyz").empty();
}

bool are_free(const LayoutGuess& guess, const std::set<std::size_t>& used, std::size_t first) {
  if (first + 3 > guess.shape.columns.size()) return false;
  for (std::size_t c = first; c < first + 3; ++c) {
    if (used.count(c) || guess.shape.columns[c].count == 0) return false;
  }
  return true;
}

/// A point goes evenly from row to row: neither in the steps of a converter nor in those of a command.
bool is_point(const LayoutGuess& guess, std::size_t first) {
  for (std::size_t c = first; c < first + 3; ++c) {
    const CsvNumbers& column = guess.shape.columns[c];
    if (static_cast<double>(column.distinct) < 0.02 * static_cast<double>(guess.shape.rows) &&
        column.distinct > 1)
      return false;
  }
  return guess.shape.columns[first].distinct + guess.shape.columns[first + 1].distinct > 2;
}

GuessedBody body_at(std::size_t position, const std::vector<std::size_t>& orientation, std::string why) {
  GuessedBody body;
  if (position != std::numeric_limits<std::size_t>::max())
    body.position = {position, position + 1, position + 2};
  body.orientation = orientation;
  body.why = std::move(why);
  return body;
}

std::vector<std::size_t> four_from(std::size_t first) {
  return {first, first + 1, first + 2, first + 3};
}

/// Without names: constants beside a pose that are one as well, such as a mount's that is not measured.
void take_constant_poses(const LayoutGuess& guess, std::set<std::size_t>* used,
                         std::vector<std::size_t>* quaternions) {
  constexpr std::size_t kPose = 7;  // columns
  for (std::size_t i = 0; i < quaternions->size(); ++i) {
    const std::size_t q = (*quaternions)[i];
    const bool before = q >= 3 && are_free(guess, *used, q - 3);
    for (const std::size_t c : {q - kPose, q + kPose}) {
      if (c > guess.shape.columns.size() || !off_unit(guess, *used, c) || varies(guess, c, 4)) continue;
      if (before ? c < 3 || !are_free(guess, *used, c - 3) : !are_free(guess, *used, c + 4)) continue;
      quaternions->push_back(c);
      const std::vector<std::size_t> four = four_from(c);
      used->insert(four.begin(), four.end());
    }
  }
}

/// The first columns of all quaternions, which are used then. A place 1.00 m up and three small numbers are
/// nearly a unit quaternion, too: of those that overlap the one with names counts, else the nearest to one.
std::vector<std::size_t> take_quaternions(const LayoutGuess& guess, std::set<std::size_t>* used) {
  std::vector<std::tuple<bool, double, std::size_t>> candidates;
  for (std::size_t c = 0; c + 4 <= guess.shape.columns.size(); ++c) {
    const bool by_name = is_named_quaternion(guess, c);
    // Constants such as 0, 0, 0, 1 are anything; what cameras see has noise.
    if (!by_name && !varies(guess, c, 4)) continue;
    if (const auto off = off_unit(guess, *used, c)) candidates.emplace_back(!by_name, *off, c);
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<std::size_t> quaternions;
  for (const auto& [without_name, off, c] : candidates) {
    const std::vector<std::size_t> four = four_from(c);
    if (std::any_of(four.begin(), four.end(), [&](std::size_t k) { return used->count(k) > 0; })) continue;
    quaternions.push_back(c);
    used->insert(four.begin(), four.end());
  }
  const bool has_names = std::any_of(guess.shape.columns.begin(), guess.shape.columns.end(),
                                     [](const CsvNumbers& c) { return !c.name.empty(); });
  if (!has_names) take_constant_poses(guess, used, &quaternions);
  std::sort(quaternions.begin(), quaternions.end());
  return quaternions;
}

/// Positions by their names, which differ in x, y and z.
std::vector<std::size_t> named_positions(const LayoutGuess& guess, const std::set<std::size_t>& used) {
  std::vector<std::size_t> positions;
  for (std::size_t c = 0; c + 3 <= guess.shape.columns.size(); ++c) {
    if (!are_free(guess, used, c) || !is_named_triple(guess, c)) continue;
    positions.push_back(c);
    c += 2;
  }
  return positions;
}

void add_named(LayoutGuess* guess, const std::vector<std::size_t>& positions,
               const std::vector<std::size_t>& quaternions) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const std::size_t p = positions[i];
    std::optional<std::size_t> of_it;
    if (quaternions.size() == positions.size()) {
      of_it = quaternions[i];  // each after its position, or all of them after all positions
    } else {
      for (const std::size_t q : quaternions) {
        if (q == p + 3 || q + 4 == p) of_it = q;
      }
    }
    guess->bodies.push_back(body_at(
        p, of_it ? four_from(*of_it) : std::vector<std::size_t>{},
        of_it ? "names that differ in x, y, z, and a unit quaternion" : "names that differ in x, y, z"));
  }
}

/// Poses: quaternions, and the positions that belong to them.
void add_poses(LayoutGuess* guess, std::set<std::size_t>* used) {
  const std::vector<std::size_t> quaternions = take_quaternions(*guess, used);
  const std::vector<std::size_t> positions = named_positions(*guess, *used);
  if (!positions.empty()) {
    add_named(guess, positions, quaternions);
  } else {
    for (const std::size_t q : quaternions) {
      const bool before = q >= 3 && are_free(*guess, *used, q - 3);
      if (!before && !are_free(*guess, *used, q + 4)) continue;
      guess->bodies.push_back(body_at(before ? q - 3 : q + 4, four_from(q),
                                      before ? "a unit quaternion, and the three columns before it"
                                             : "a unit quaternion, and the three columns after it"));
      used->insert(guess->bodies.back().position.begin(), guess->bodies.back().position.end());
    }
  }
  for (const GuessedBody& body : guess->bodies) used->insert(body.position.begin(), body.position.end());
}

/// Without names and quaternions: three by three, from the first that moves like a point on.
void add_points(LayoutGuess* guess, std::set<std::size_t>* used) {
  for (std::size_t c = 0; c + 3 <= guess->shape.columns.size(); ++c) {
    const bool is_named = !guess->shape.columns[c].name.empty();
    if (is_named || !are_free(*guess, *used, c) || !is_point(*guess, c)) {
      if (!guess->bodies.empty() && !is_named) break;  // bodies come together
      continue;
    }
    guess->bodies.push_back(body_at(c, {}, "CHECK: three neighbouring columns without names"));
    for (std::size_t k = c; k < c + 3; ++k) used->insert(k);
    c += 2;
  }
}

}  // namespace

void find_poses(LayoutGuess* guess, std::set<std::size_t>* used) {
  add_poses(guess, used);
  if (guess->bodies.empty()) add_points(guess, used);
}

}  // namespace softarm::trial
