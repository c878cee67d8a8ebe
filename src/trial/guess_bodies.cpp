#include "guess_bodies.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cctype>
#include <cmath>
#include <optional>

#include "guess_poses.h"
#include "math/statistics.h"

namespace softarm::trial {
namespace {

constexpr double kDominates = 0.9;  // mean size of w where a rigid body was aligned with the room's axes
constexpr double kAligned = 0.8, kBetterAligned = 0.3;  // cosines of a right order, and over the wrong one's
constexpr double kLeastTurn = 0.02, kMostTurn = 1.5;  // rad: what says something, and what may be turned over
constexpr double kFarM = 20.0;      // nobody's arm is that long, or that far off: then it is mm
constexpr double kNearM = 0.03;     // nobody's bodies are as close together in m
constexpr double kStill = 0.02;     // of the arm's extent: a mount moves by less
constexpr double kMovesMore = 2.0;  // times: a tip against a mount
constexpr double kRepeats = 0.05;   // share of rows whose poses repeat the last: worth dropping
constexpr double kUpright = 2.0;    // times as far along one axis as along the others

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
    body.order = {
        w_first ? "wxyz" : "xyzw",
        fmt::format("the {} is large, as if the body was aligned with the room", w_first ? "first" : "last")};
    return;
  }
  const std::size_t neighbour = b > 0 ? b - 1 : b + 1;
  if (neighbour < guess->bodies.size()) {
    const double last = turns_along(*guess, body, guess->bodies[neighbour], false),
                 first = turns_along(*guess, body, guess->bodies[neighbour], true);
    if (std::max(first, last) > kAligned && std::abs(first - last) > kBetterAligned) {
      body.order = {first > last ? "wxyz" : "xyzw",
                    "with this order the body turns like the line to its neighbour"};
      return;
    }
  }
  body.order = {"", "xyzw or wxyz: neither the header nor the numbers show it"};
}

/// The one that all columns of positions have; empty where there is none.
std::string said_length_unit(const LayoutGuess& guess) {
  std::set<std::string> units;
  for (const GuessedBody& body : guess.bodies) {
    for (const std::size_t c : body.position) units.insert(guess.shape.columns[c].unit);
  }
  const bool known =
      units.size() == 1 && (*units.begin() == "m" || *units.begin() == "cm" || *units.begin() == "mm");
  return known ? *units.begin() : "";
}

void guess_unit(LayoutGuess* guess, double extent) {
  double farthest = 0.0;
  for (const GuessedBody& body : guess->bodies)
    farthest = std::max(farthest, mean_place(*guess, body).norm());
  const double size = extent > 0.0 ? extent : farthest;
  const std::string what =
      fmt::format("the bodies lie {:.3g} apart, {:.3g} from the origin", extent, farthest);
  const std::string said = said_length_unit(*guess);
  if (!said.empty())
    guess->length_unit = {said, "as the header says"};
  else if (size > kFarM || farthest > kFarM * 5.0)
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
    guess->up = {axis == 1 ? "y" : "z", "the bodies lie along it, as on an arm that hangs or stands"};
  } else {
    guess->up = {"", "z or y: the arm lies along neither"};
  }
}

/// The body's columns have this word in their names.
bool is_called(const LayoutGuess& guess, const GuessedBody& body, const std::string& word) {
  const std::string name = boost::to_lower_copy(guess.shape.columns[body.position[0]].name);
  const auto letter = [&](std::size_t i) {
    return i < name.size() && std::isalpha(static_cast<unsigned char>(name[i]));
  };
  const std::size_t at = name.find(word);
  return at != std::string::npos && (at == 0 || !letter(at - 1)) && !letter(at + word.size());
}

bool is_called_mount(const LayoutGuess& guess, const GuessedBody& body) {
  return is_called(guess, body, "base") || is_called(guess, body, "mount") ||
         is_called(guess, body, "origin");
}

double extent_of(const LayoutGuess& guess) {
  double extent = 0.0;
  for (const GuessedBody& a : guess.bodies) {
    for (const GuessedBody& b : guess.bodies)
      extent = std::max(extent, (mean_place(guess, a) - mean_place(guess, b)).norm());
  }
  return extent;
}

/// The body that carries the arm: one that is called so, else the only one that is constant, or stands still.
std::optional<std::size_t> find_mount(const LayoutGuess& guess) {
  for (const char* word : {"base", "mount", "origin"}) {
    for (std::size_t b = 0; b < guess.bodies.size(); ++b) {
      if (is_called(guess, guess.bodies[b], word)) return b;
    }
  }
  if (guess.bodies.size() < 2) return std::nullopt;
  for (const double most : {0.0, kStill * extent_of(guess)}) {
    std::vector<std::size_t> still;
    for (std::size_t b = 0; b < guess.bodies.size(); ++b) {
      if (motion(guess, guess.bodies[b]) <= most) still.push_back(b);
    }
    if (still.size() == 1) return still.front();
  }
  return std::nullopt;
}

/// Constants that are called a mount, or have no noise, beside the mount: no rings.
void leave_out_fixed(LayoutGuess* guess) {
  const double still = kStill * extent_of(*guess);
  for (std::size_t b = guess->bodies.size(); b-- > 1;) {
    const GuessedBody& body = guess->bodies[b];
    const double moves = motion(*guess, body);
    if (moves > 0.0 && !(is_called_mount(*guess, body) && moves < still)) continue;
    const std::string& name = guess->shape.columns[body.position[0]].name;
    guess->not_used.push_back(
        fmt::format("pose from {}: stands still beside the base, no ring on the arm",
                    name.empty() ? fmt::format("column {}", body.position[0] + 1) : name));
    guess->bodies.erase(guess->bodies.begin() + static_cast<std::ptrdiff_t>(b));
  }
}

/// From base to tip. @return whether the first is known to be the mount
bool put_in_order(LayoutGuess* guess) {
  std::vector<GuessedBody>& bodies = guess->bodies;
  std::stable_sort(bodies.begin(), bodies.end(),
                   [](const GuessedBody& a, const GuessedBody& b) { return a.position < b.position; });
  const auto mount = find_mount(*guess);
  if (!mount) {
    const double first = motion(*guess, bodies.front()), last = motion(*guess, bodies.back());
    const double apart = (mean_place(*guess, bodies.back()) - mean_place(*guess, bodies.front())).norm();
    if (first > kStill * apart && first > kMovesMore * last) {
      std::reverse(bodies.begin(), bodies.end());
      for (GuessedBody& body : bodies) body.why += "; the file begins with the tip, which moves most";
    }
    return false;
  }
  std::rotate(bodies.begin(), bodies.begin() + static_cast<std::ptrdiff_t>(*mount),
              bodies.begin() + static_cast<std::ptrdiff_t>(*mount) + 1);
  leave_out_fixed(guess);
  const auto from_base = [&](const GuessedBody& body) {
    return (mean_place(*guess, body) - mean_place(*guess, bodies.front())).norm();
  };
  if (bodies.size() > 2 && from_base(bodies[1]) > from_base(bodies.back())) {
    std::reverse(bodies.begin() + 1, bodies.end());
    for (std::size_t b = 1; b < bodies.size(); ++b)
      bodies[b].why += "; the file begins with the tip, which is farther from the base";
  }
  return true;
}

void name_bodies(LayoutGuess* guess, bool has_mount) {
  const double extent = extent_of(*guess);
  std::size_t still = 0;
  while (still < guess->bodies.size() && motion(*guess, guess->bodies[still]) < kStill * extent) ++still;
  if (still == guess->bodies.size()) still = 0;
  std::size_t ring = 0;
  for (std::size_t b = 0; b < guess->bodies.size(); ++b) {
    GuessedBody& body = guess->bodies[b];
    const bool last = b + 1 == guess->bodies.size();
    if (b == 0 && (has_mount || still > 0)) {
      body.name = "base";
      body.why += is_called_mount(*guess, body) ? "; its name says so" : "; it does not move";
      if (body.orientation.empty())
        body.why += "; without orientation: give it a fixed_orientation, or the arm file a fixed base";
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
  find_poses(guess, used);
  if (guess->bodies.empty()) {
    guess->length_unit.why = "m, cm or mm";
    guess->up.why = "z or y";
    return;
  }
  const bool has_mount = put_in_order(guess);
  const Eigen::Vector3d along =
      mean_place(*guess, guess->bodies.back()) - mean_place(*guess, guess->bodies.front());
  for (std::size_t b = 0; b < guess->bodies.size(); ++b) {
    if (!guess->bodies[b].orientation.empty()) guess_order(guess, b);
  }
  guess_unit(guess, along.norm());
  guess_up(guess, along);
  name_bodies(guess, has_mount);
  find_repeats(guess);
}

}  // namespace softarm::trial
