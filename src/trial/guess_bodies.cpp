#include "guess_bodies.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>

#include "math/statistics.h"

namespace softarm::trial {
namespace {

constexpr double kUnitNorm = 5e-3, kUnitShare = 0.95;  // rows whose four numbers are a unit quaternion
constexpr std::size_t kFewValues = 5;
constexpr double kDominates = 0.9;  // mean size of w where a rigid body was aligned with the room's axes
constexpr double kAligned = 0.8, kBetterAligned = 0.3;  // cosines of a right order, and over the wrong one's
constexpr double kLeastTurn = 0.02, kMostTurn = 1.5;  // rad: what says something, and what may be turned over
constexpr double kFarM = 20.0;      // nobody's arm is that long, or that far off: then it is mm
constexpr double kNearM = 0.03;     // nobody's bodies are as close together in m
constexpr double kStill = 0.02;     // of the arm's extent: a mount moves by less
constexpr double kMovesMore = 2.0;  // times: a tip against a mount
constexpr double kRepeats = 0.05;   // share of rows whose poses repeat the last: worth dropping
constexpr double kUpright = 2.0;    // times as far along one axis as along the others

const std::vector<double>& values(const LayoutGuess& guess, std::size_t column) {
  return guess.shape.columns[column].values;
}

/// By how much four columns are off a unit quaternion, rms; nothing where they are none.
std::optional<double> off_unit(const LayoutGuess& guess, const std::set<std::size_t>& used,
                               std::size_t first) {
  // Constants such as 0, 0, 0, 1 are anything; what cameras see has noise.
  bool varies = false;
  for (std::size_t c = first; c < first + 4; ++c) {
    if (used.count(c)) return std::nullopt;
    varies = varies || guess.shape.columns[c].distinct >= kFewValues;
  }
  if (!varies) return std::nullopt;
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

/// The name without the one letter that says which axis it is; empty where it says none.
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

bool is_named_triple(const LayoutGuess& guess, std::size_t first) {
  const auto& columns = guess.shape.columns;
  const std::string stem = stem_of(columns[first].name, 'x');
  return !stem.empty() && stem == stem_of(columns[first + 1].name, 'y') &&
         stem == stem_of(columns[first + 2].name, 'z');
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

/// The first columns of all quaternions, which are used then. A place 1.00 m up and three small numbers are
/// nearly a unit quaternion, too: of those that overlap the nearest to one counts.
std::vector<std::size_t> take_quaternions(const LayoutGuess& guess, std::set<std::size_t>* used) {
  std::vector<std::pair<double, std::size_t>> candidates;
  for (std::size_t c = 0; c + 4 <= guess.shape.columns.size(); ++c) {
    if (const auto off = off_unit(guess, *used, c)) candidates.emplace_back(*off, c);
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<std::size_t> quaternions;
  for (const auto& [off, c] : candidates) {
    const std::vector<std::size_t> four = four_from(c);
    if (std::any_of(four.begin(), four.end(), [&](std::size_t k) { return used->count(k) > 0; })) continue;
    quaternions.push_back(c);
    used->insert(four.begin(), four.end());
  }
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

Eigen::Vector3d place(const LayoutGuess& guess, const GuessedBody& body, std::size_t row) {
  return {values(guess, body.position[0])[row], values(guess, body.position[1])[row],
          values(guess, body.position[2])[row]};
}

Eigen::Vector3d mean_place(const LayoutGuess& guess, const GuessedBody& body) {
  const auto& columns = guess.shape.columns;
  return {columns[body.position[0]].mean, columns[body.position[1]].mean, columns[body.position[2]].mean};
}

double motion(const LayoutGuess& guess, const GuessedBody& body) {
  double most = 0.0;
  for (const std::size_t c : body.position)
    most = std::max(most, guess.shape.columns[c].high - guess.shape.columns[c].low);
  return most;
}

/// How well the axis about which a body turns is the one about which the chord to its neighbour does: the
/// cosine of the angle between them, a mean weighted by the turn; 0 where nothing turns.
double turns_along(const LayoutGuess& guess, const GuessedBody& body, const GuessedBody& other,
                   bool w_first) {
  std::optional<Eigen::Quaterniond> first;
  Eigen::Vector3d first_chord = Eigen::Vector3d::Zero();
  double cosines = 0.0, weights = 0.0;
  for (std::size_t row = 0; row < guess.shape.rows; row += 1 + guess.shape.rows / 2000) {
    double q[4];
    for (std::size_t k = 0; k < 4; ++k) q[k] = values(guess, body.orientation[k])[row];
    const Eigen::Quaterniond turn =
        w_first ? Eigen::Quaterniond(q[0], q[1], q[2], q[3]) : Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
    const Eigen::Vector3d chord = place(guess, body, row) - place(guess, other, row);
    if (!chord.allFinite() || chord.norm() == 0.0 || !(std::abs(turn.norm() - 1.0) < kUnitNorm)) continue;
    if (!first) {
      first = turn.normalized();
      first_chord = chord.normalized();
      continue;
    }
    const Eigen::AngleAxisd since(turn.normalized() * first->conjugate());
    const Eigen::Vector3d chord_turn = first_chord.cross(chord.normalized());
    if (chord_turn.norm() < kLeastTurn || since.angle() < kLeastTurn || since.angle() > kMostTurn) continue;
    cosines += chord_turn.dot(since.axis());
    weights += chord_turn.norm();
  }
  return weights > 0.0 ? cosines / weights : 0.0;
}

/// The letter of the header that stands for a column of a quaternion; 0 where it says none.
bool ends_with_w(const std::string& name) {
  return !stem_of(name, 'w').empty() || boost::iends_with(name, "qw");
}

void guess_order(LayoutGuess* guess, std::size_t b) {
  GuessedBody& body = guess->bodies[b];
  const auto& columns = guess->shape.columns;
  const bool first_named = ends_with_w(columns[body.orientation[0]].name),
             last_named = ends_with_w(columns[body.orientation[3]].name);
  if (first_named != last_named) {
    body.order = {first_named ? "wxyz" : "xyzw", "as the header says"};
    return;
  }
  std::vector<double> sizes(4, 0.0);
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<double> all;
    for (const double x : values(*guess, body.orientation[k])) {
      if (std::isfinite(x)) all.push_back(std::abs(x));
    }
    sizes[k] = math::median(std::move(all));
  }
  if (sizes[0] > kDominates || sizes[3] > kDominates) {
    const bool w_first = sizes[0] > kDominates;
    body.order = {w_first ? "wxyz" : "xyzw",
                  fmt::format("the {} is the large one, as where a body was aligned with the room",
                              w_first ? "first" : "last")};
    return;
  }
  const std::size_t neighbour = b > 0 ? b - 1 : b + 1;
  if (neighbour < guess->bodies.size()) {
    const double last = turns_along(*guess, body, guess->bodies[neighbour], false),
                 first = turns_along(*guess, body, guess->bodies[neighbour], true);
    if (std::max(first, last) > kAligned && std::abs(first - last) > kBetterAligned) {
      body.order = {first > last ? "wxyz" : "xyzw", "by it the body turns as the line to its neighbour does"};
      return;
    }
  }
  body.order = {"", "xyzw or wxyz: neither the header nor the numbers tell"};
}

void guess_unit(LayoutGuess* guess, double extent) {
  double farthest = 0.0;
  for (const GuessedBody& body : guess->bodies)
    farthest = std::max(farthest, mean_place(*guess, body).norm());
  const double size = extent > 0.0 ? extent : farthest;
  const std::string what =
      fmt::format("the bodies lie {:.3g} apart, {:.3g} from the origin", extent, farthest);
  if (size > kFarM || farthest > kFarM * 5.0)
    guess->length_unit = {"mm", what};
  else if (size > kNearM && size < kFarM / 10.0)
    guess->length_unit = {"m", what};
  else
    guess->length_unit = {"", "m, cm or mm: " + what};
}

void guess_up(LayoutGuess* guess, const Eigen::Vector3d& along) {
  const Eigen::Vector3d size = along.cwiseAbs();
  Eigen::Index axis = 0;
  const double most = size.maxCoeff(&axis);
  double next = 0.0;
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (k != axis) next = std::max(next, size(k));
  }
  if (most > 0.0 && axis > 0 && most > kUpright * next) {
    guess->up = {axis == 1 ? "y" : "z",
                 "the bodies lie along it, as those of an arm that hangs or stands do"};
  } else {
    guess->up = {"", "z or y: the arm lies along neither"};
  }
}

void name_bodies(LayoutGuess* guess, double extent) {
  std::size_t still = 0;
  while (still < guess->bodies.size() && motion(*guess, guess->bodies[still]) < kStill * extent) ++still;
  if (still == guess->bodies.size()) still = 0;
  std::size_t ring = 0;
  for (std::size_t b = 0; b < guess->bodies.size(); ++b) {
    GuessedBody& body = guess->bodies[b];
    const bool last = b + 1 == guess->bodies.size();
    if (b == 0 && still > 0) {
      body.name = "base";
      body.why += "; it does not move";
      continue;
    }
    body.name = last ? "tip" : fmt::format("ring_{}", ++ring);
    if (b < still)
      body.why += "; it does not move either: call it base, and delete the one above, if the arm begins here";
    if (b == 0) body.why += "; it moves, so no body is the mount: the arm file's base is then fixed";
  }
}

void find_repeats(LayoutGuess* guess) {
  std::size_t repeats = 0;
  for (std::size_t row = 1; row < guess->shape.rows; ++row) {
    bool same = true;
    for (const GuessedBody& body : guess->bodies) {
      for (const auto* columns : {&body.position, &body.orientation}) {
        for (const std::size_t c : *columns)
          same = same && values(*guess, c)[row] == values(*guess, c)[row - 1];
      }
    }
    repeats += same;
  }
  guess->drop_repeated = static_cast<double>(repeats) > kRepeats * static_cast<double>(guess->shape.rows);
}

}  // namespace

void find_bodies(LayoutGuess* guess, std::set<std::size_t>* used) {
  add_poses(guess, used);
  if (guess->bodies.empty()) add_points(guess, used);
  if (guess->bodies.empty()) {
    guess->length_unit.why = "m, cm or mm";
    guess->up.why = "z or y";
    return;
  }
  std::stable_sort(guess->bodies.begin(), guess->bodies.end(),
                   [](const GuessedBody& a, const GuessedBody& b) { return a.position < b.position; });
  const double first_m = motion(*guess, guess->bodies.front()), last_m = motion(*guess, guess->bodies.back());
  const double apart_m =
      (mean_place(*guess, guess->bodies.back()) - mean_place(*guess, guess->bodies.front())).norm();
  if (first_m > kStill * apart_m && first_m > kMovesMore * last_m) {
    std::reverse(guess->bodies.begin(), guess->bodies.end());
    for (GuessedBody& body : guess->bodies) body.why += "; the file begins with the tip, which moves most";
  }
  const Eigen::Vector3d along =
      mean_place(*guess, guess->bodies.back()) - mean_place(*guess, guess->bodies.front());
  for (std::size_t b = 0; b < guess->bodies.size(); ++b) {
    if (!guess->bodies[b].orientation.empty()) guess_order(guess, b);
  }
  guess_unit(guess, along.norm());
  guess_up(guess, along);
  name_bodies(guess, along.norm());
  find_repeats(guess);
}

}  // namespace softarm::trial
