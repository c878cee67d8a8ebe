#include "belonging.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "compare_frames.h"
#include "math/statistics.h"

namespace softarm::identify {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;

constexpr double kFarthest = 0.4;      // of the length, mean over bodies and frames
constexpr double kLooks = 0.03;        // of the length, from which on other readings are tried
constexpr double kExplains = 0.2;      // of the length, that a reading may leave to be named in any case
constexpr double kBetter = 1.0 / 3.0;  // of the error, that it may leave where that is less than kFarthest
// Of the error, that it may leave over all, and in the worst of the trials. On the pouch arm a wrong order of
// the quaternions shows by 0.5; of those that are read right the best other reading leaves 1.0. Laws that are
// off by up to three times do not get there either.
constexpr double kBetterInAll = 0.7, kBetterInEach = 0.85;
constexpr std::size_t kFewestTrials = 2;
constexpr double kTies = 1.25;              // ratio of errors up to which readings cannot be told apart
constexpr std::size_t kMostTies = 3;        // that are named
constexpr double kOtherLength = 0.1;        // from which on another length of the arm is a reading
constexpr std::size_t kFramesOfTrial = 20;  // that each reading is tried on
// On all gains: a guess of them is to hide no reading, nor to look like one.
constexpr double kGuesses[] = {0.25, 0.5, 1.0, 2.0, 4.0};

constexpr char kOrderKeys[] =
    " (orientation_order of the layout, or what the driver publishes; quaternion_xyzw of the arm file)";

/// What one reading makes of a pose as it was read.
using OfPosition = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;
using OfOrientation = std::function<Quaterniond(const Quaterniond&)>;

std::vector<trial::Trial> read_otherwise(std::vector<trial::Trial> trials, const OfPosition& p,
                                         const OfOrientation& q) {
  for (trial::Trial& trial : trials) {
    for (trial::Frame& frame : trial.frames) {
      if (frame.base_body) {
        Isometry3d base = Isometry3d::Identity();
        base.linear() = q(Quaterniond(frame.base_body->linear())).toRotationMatrix();
        base.translation() = p(frame.base_body->translation());
        frame.base_body = base;
      }
      for (trial::BodyObservation& body : frame.bodies) {
        body.p_mocap = p(body.p_mocap);
        if (body.q_mocap) body.q_mocap = q(*body.q_mocap);
      }
    }
  }
  return trials;
}

Eigen::Vector3d same_position(const Eigen::Vector3d& p) {
  return p;
}
Quaterniond same_orientation(const Quaterniond& q) {
  return q;
}

/// A few frames of each trial, evenly spaced: which are usable depends on how they are read.
std::vector<trial::Trial> thinned(const std::vector<trial::Trial>& trials) {
  std::vector<trial::Trial> few;
  for (const trial::Trial& trial : trials) {
    trial::Trial some{trial.name, {}, trial.inputs};
    const std::size_t count = std::min(kFramesOfTrial, trial.frames.size());
    for (std::size_t k = 0; k < count; ++k)
      some.frames.push_back(trial.frames[k * trial.frames.size() / count]);
    few.push_back(std::move(some));
  }
  return few;
}

/// Shape error, over all frames and by trial.
struct Errors {
  double mean_m = 0.0, share = 0.0;  ///< of the arm's length
  std::map<std::size_t, double> by_trial_m;
};

/// Nothing where no frame can be predicted.
std::optional<Errors> errors_of(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  FrameChoice all;
  all.frames_per_trial = 0;
  all.prefer_static = false;
  const std::vector<FrameComparison> frames = compare(arm, trials, all);
  if (frames.empty()) return std::nullopt;
  Errors errors;
  std::map<std::size_t, std::vector<double>> by_trial;
  for (const FrameComparison& frame : frames) by_trial[frame.trial].push_back(frame.error_m);
  errors.mean_m = summarise(frames, arm.total_length_m()).mean_m;
  errors.share = errors.mean_m / arm.total_length_m();
  for (const auto& [trial, list] : by_trial) errors.by_trial_m[trial] = math::mean(list);
  return errors;
}

/// With all gains and curvatures by inputs as many times as large as fits best.
std::optional<Errors> errors_at_best_gain(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  std::optional<Errors> best;
  for (const double factor : kGuesses) {
    arm::Arm guess = arm;
    for (arm::Segment& segment : guess.segments) {
      for (arm::Chamber& chamber : segment.chambers) chamber.moment_gain_nm_per_pa *= factor;
      for (arm::Tendon& tendon : segment.tendons) tendon.offset_m *= factor;
      for (arm::Cable& cable : segment.cables) cable.curvature_gain_per_m_rad *= factor;
    }
    const std::optional<Errors> errors = errors_of(guess, trials);
    if (errors && (!best || errors->share < best->share)) best = errors;
  }
  return best;
}

/// How many trials there are where it is clearly better in each; else 0.
std::size_t better_in_each(const Errors& other, const Errors& given) {
  if (other.share > kBetterInAll * given.share || given.by_trial_m.size() < kFewestTrials) return 0;
  for (const auto& [trial, given_m] : given.by_trial_m) {
    const auto found = other.by_trial_m.find(trial);
    if (found == other.by_trial_m.end() || found->second > kBetterInEach * given_m) return 0;
  }
  return given.by_trial_m.size();
}

/// "x -z y": the axes that were read, along those of the mocap frame.
std::string axes_name(const Matrix3d& m) {
  std::string name;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (m(row, column) == 0.0) continue;
      name += fmt::format("{}{}{}", row > 0 ? " " : "", m(row, column) < 0.0 ? "-" : "", "xyz"[column]);
    }
  }
  return name;
}

/// The 24 turns that take axes to axes, the identity first.
std::vector<Matrix3d> turns() {
  std::vector<Matrix3d> list;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix3d m = Matrix3d::Zero();
      for (int row = 0; row < 3; ++row)
        m(row, order[static_cast<std::size_t>(row)]) = (signs >> row) % 2 == 0 ? 1.0 : -1.0;
      if (m.determinant() > 0.0) list.push_back(m);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return list;
}

/// How far bodies are from the base along the arm at most, over what the arm file says: the median over the
/// frames; nothing without a base.
std::optional<double> length_ratio(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  std::vector<double> ratios;
  for (const trial::Trial& trial : trials) {
    for (const trial::Frame& frame : trial.frames) {
      if (arm.base.body && !frame.base_body) continue;
      const Isometry3d base = arm.base.body ? *frame.base_body * arm.base.rod_in_body : arm.base.fixed_pose;
      const arm::MeasuredBody* last = nullptr;
      double distance_m = 0.0;
      for (const trial::BodyObservation& seen : frame.bodies) {
        const arm::MeasuredBody& body = arm.bodies[static_cast<std::size_t>(seen.body)];
        if (last != nullptr && body.arclength_m < last->arclength_m) continue;
        last = &body;
        distance_m = (seen.p_mocap - base.translation()).norm();
      }
      if (last != nullptr && last->arclength_m > 0.0) ratios.push_back(distance_m / last->arclength_m);
    }
  }
  if (ratios.empty()) return std::nullopt;
  // Chords of a bent arm are shorter than it: the longest of nearly all is at rest.
  return math::quantile(ratios, 0.95);
}

arm::Arm scaled(arm::Arm arm, double factor) {
  for (arm::Segment& segment : arm.segments) segment.length_m *= factor;
  for (arm::MeasuredBody& body : arm.bodies) body.arclength_m *= factor;
  arm.payload.arclength_m *= factor;
  return arm;
}

/// What other readings leave of the errors, and the best of them.
struct Attempts {
  std::vector<Reading> tried;
  std::optional<Errors> best;

  void add(const std::string& name, const arm::Arm& arm, const std::vector<trial::Trial>& read) {
    const std::optional<Errors> errors = errors_at_best_gain(arm, read);
    if (!errors) return;
    tried.push_back({name, errors->mean_m, errors->share});
    // An arm that is a thousandth as long leaves a thousandth of the millimetres.
    if (!best || errors->share < best->share) best = errors;
  }
};

void try_axes(const arm::Arm& arm, const std::vector<trial::Trial>& few, Attempts& attempts) {
  for (const Matrix3d& m : turns()) {
    if (m.isIdentity()) continue;
    const Quaterniond turn(m);
    attempts.add(fmt::format("axes '{}' (inputs.bodies.axes of the arm file, or mocap.up of the layout)",
                             axes_name(m)),
                 arm,
                 read_otherwise(
                     few, [&](const Eigen::Vector3d& p) { return Eigen::Vector3d(m * p); },
                     [&](const Quaterniond& q) { return turn * q * turn.conjugate(); }));
    if (!arm.base.body) continue;
    arm::Arm turned = arm;
    turned.base.rod_in_body.linear() = turned.base.rod_in_body.linear() * m;
    const Quaterniond q(turned.base.rod_in_body.linear());
    attempts.add(fmt::format("base.rod_in_body turned to its axes '{}' (quaternion_xyzw: [{:.6g}, {:.6g}, "
                             "{:.6g}, {:.6g}])",
                             axes_name(m), q.x(), q.y(), q.z(), q.w()),
                 turned, few);
  }
}

void try_units(const arm::Arm& arm, const std::vector<trial::Trial>& few, Attempts& attempts) {
  for (const auto& [factor, units] :
       {std::pair(1e-3, "mm in place of m"), std::pair(1e3, "m in place of mm"),
        std::pair(1e-2, "cm in place of m"), std::pair(1e-1, "mm in place of cm"),
        std::pair(0.0254, "inches in place of m"), std::pair(10.0, "cm in place of mm"),
        std::pair(100.0, "m in place of cm")})
    attempts.add(
        fmt::format("positions in {} (inputs.bodies.unit of the arm file, or mocap.unit of the layout)",
                    units),
        arm,
        read_otherwise(
            few, [factor = factor](const Eigen::Vector3d& p) { return Eigen::Vector3d(factor * p); },
            same_orientation));
}

void try_quaternions(const arm::Arm& arm, const std::vector<trial::Trial>& few, Attempts& attempts) {
  attempts.add(std::string("quaternions in the order w, x, y, z") + kOrderKeys, arm,
               read_otherwise(few, same_position,
                              [](const Quaterniond& q) { return Quaterniond(q.x(), q.y(), q.z(), q.w()); }));
  attempts.add(std::string("quaternions in the order x, y, z, w") + kOrderKeys, arm,
               read_otherwise(few, same_position,
                              [](const Quaterniond& q) { return Quaterniond(q.z(), q.w(), q.x(), q.y()); }));
  attempts.add("quaternions that turn the other way", arm,
               read_otherwise(few, same_position, [](const Quaterniond& q) { return q.conjugate(); }));
}

void try_length(const arm::Arm& arm, const std::vector<trial::Trial>& few, Attempts& attempts) {
  const std::optional<double> ratio = length_ratio(arm, few);
  if (!ratio || std::abs(*ratio - 1.0) <= kOtherLength) return;
  attempts.add(
      fmt::format("an arm {:.2f} times as long (length_m of the segments and arclength_m of bodies and "
                  "payload)",
                  *ratio),
      scaled(arm, *ratio), few);
}

}  // namespace

Belonging belonging(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  Belonging result;
  result.length_m = arm.total_length_m();
  const std::vector<trial::Trial> few = thinned(trials);
  const std::optional<Errors> given = errors_of(arm, few);
  if (given) result.mean_m = given->mean_m;
  result.together = given && given->mean_m <= kFarthest * result.length_m;
  if (given && given->mean_m <= kLooks * result.length_m) return result;
  Attempts attempts;
  try_axes(arm, few, attempts);
  try_units(arm, few, attempts);
  try_quaternions(arm, few, attempts);
  try_length(arm, few, attempts);
  result.tried = std::move(attempts.tried);
  std::stable_sort(result.tried.begin(), result.tried.end(),
                   [](const Reading& a, const Reading& b) { return a.share < b.share; });
  const std::optional<Errors>& best = attempts.best;
  const std::optional<Errors> as_read = errors_at_best_gain(arm, few);
  const bool better = as_read && best && best->share < kBetter * as_read->share;
  result.together = result.together && !better;
  if (as_read && best) result.better_in = better_in_each(*best, *as_read);
  return result;
}

namespace {

/// The best readings, of which some cannot be told apart.
std::string best_of(const Belonging& belonging) {
  std::string names;
  for (std::size_t i = 0; i < std::min(kMostTies, belonging.tried.size()); ++i) {
    if (belonging.tried[i].share <= kTies * belonging.tried.front().share)
      names += (i == 0 ? "" : ", or ") + belonging.tried[i].name;
  }
  return names;
}

}  // namespace

std::string describe(const Belonging& belonging) {
  const double left = belonging.tried.empty() ? 1.0 : belonging.tried.front().share;
  const bool explained = left <= kExplains || (left <= kFarthest && belonging.mean_m &&
                                               left < kBetter * *belonging.mean_m / belonging.length_m);
  if (belonging.together && belonging.better_in > 0)
    return fmt::format(
        "ANOTHER READING FITS EACH OF THE {} TRIALS BETTER: with {}; by the arm file's laws the bodies are "
        "then "
        "{:.1f} mm off instead of {:.1f} mm",
        belonging.better_in, best_of(belonging), 1e3 * belonging.tried.front().mean_m,
        1e3 * *belonging.mean_m);
  // Frames of which none can be used may lack anything.
  if (belonging.together || (!belonging.mean_m && !explained)) return "";
  const std::string far =
      belonging.mean_m ? fmt::format("by its laws the bodies are {:.0f} mm off", 1e3 * *belonging.mean_m)
                       : "as they are read no frame can be used";
  const std::string line = fmt::format(
      "THE RECORDINGS AND THE ARM FILE DO NOT BELONG TOGETHER: {}, on an arm of {:.0f} mm. Tried: other "
      "axes, units, lengths, orders of the quaternion, attitudes of the base. ",
      far, 1e3 * belonging.length_m);
  if (!explained)
    return line +
           "None of them explains it: is it this arm, are the lengths and the bodies' arclengths right?";
  return line + fmt::format("With {} {:.0f} mm would be left", best_of(belonging),
                            1e3 * belonging.tried.front().mean_m);
}

}  // namespace softarm::identify
