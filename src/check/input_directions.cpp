// Inputs that bend the arm elsewhere than the arm file says: exchanged, or all turned about the arm's axis.
#include "input_directions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "arm/actuators/actuator.h"
#include "block_fit.h"
#include "clock_problem.h"
#include "context.h"
#include "policy.h"

namespace softarm::check {
namespace {

using Eigen::Vector2d;

constexpr double kDegrees = 180.0 / M_PI;

/// Where an input bends the arm.
struct Direction {
  const Signal* signal = nullptr;
  double told_rad = 0.0, seen_rad = 0.0, sd_rad = 0.0;
};

double turned(double from_rad, double to_rad) {
  return std::remainder(to_rad - from_rad, 2.0 * M_PI);
}

/// What one input alone does to the outermost body across the arm, by a fit of all inputs to its places.
struct Answer {
  BlockFit fit;            ///< the first coefficients are the inputs' own, m per half of the range
  double explained = 0.0;  ///< share of the motion across the arm
};

Answer answer_of(const ClockProblem& problem, const Eigen::Isometry3d& base, double shift_s) {
  const Eigen::MatrixXd y = problem.y * base.linear().leftCols<2>();
  Answer answer;
  answer.fit = fit_in_blocks(regressors(problem, shift_s), y, problem.block);
  answer.explained = 1.0 - answer.fit.left.squaredNorm() / std::max(y.squaredNorm(), 1e-300);
  return answer;
}

/// Whether what drives the arm is all there: what moves along unseen is else taken for another's doing.
bool all_recorded(const Context& context) {
  return !context.found({"dead_input"}) &&
         std::all_of(context.signals.begin(), context.signals.end(), [](const Signal& signal) {
           return signal.points.size() >= kPolicy.signals.least_values;
         });
}

/// In degrees from -179 to 180.
double degrees_of(double turn_rad) {
  const double degrees = std::round(kDegrees * turn_rad);
  return degrees <= -180.0 ? 180.0 : degrees;
}

/// Of the inputs whose direction is seen well and told by the arm file. Beyond the first segment they bend an
/// arm that others have turned.
std::vector<Direction> directions_of(const Context& context, const ClockProblem& problem,
                                     const Answer& answer) {
  std::vector<Direction> list;
  for (std::size_t i = 0; i < problem.signals.size(); ++i) {
    const auto told = bending_direction(context.arm, problem.signals[i]->input->name, 1);
    const Vector2d seen = answer.fit.x.row(static_cast<Eigen::Index>(i));
    const double moves_m = 2.0 * seen.norm();
    if (!told || moves_m < context.of_length(kPolicy.directions.moves)) continue;
    const Vector2d beside = Vector2d(-seen.y(), seen.x()).normalized();
    const double sd_rad = std::sqrt(beside.dot(answer.fit.covariance[i] * beside)) / seen.norm();
    if (sd_rad > kPolicy.directions.most_sd_rad) continue;
    list.push_back(
        {problem.signals[i], std::atan2(told->y(), told->x()), std::atan2(seen.y(), seen.x()), sd_rad});
  }
  return list;
}

bool any_elsewhere(const std::vector<Direction>& list) {
  return std::any_of(list.begin(), list.end(), [](const Direction& one) {
    return std::abs(turned(one.told_rad, one.seen_rad)) >
           kPolicy.directions.off_rad + kPolicy.directions.sds * one.sd_rad;
  });
}

/// Those by the lag that explains most; none where one that explains about as much has all of them where the
/// arm file says: where inputs go round, a lag looks like a turn.
std::vector<Direction> surely_elsewhere(const Context& context) {
  const auto base = context.rod_base();
  auto problem = clock_problem(
      context, 0.0, std::max(kPolicy.clocks.sample_s, context.duration_s / kPolicy.clocks.most_samples),
      false);
  if (!base || !problem) return {};
  problem->with_plays = problem->with_cubes = false;
  std::vector<Answer> answers;
  for (const double lag_s : kPolicy.directions.lags_s) answers.push_back(answer_of(*problem, *base, lag_s));
  const auto best = std::max_element(answers.begin(), answers.end(), [](const Answer& a, const Answer& b) {
    return a.explained < b.explained;
  });
  if (best->explained < kPolicy.directions.least_explained) return {};
  std::vector<Direction> list = directions_of(context, *problem, *best);
  for (const Answer& other : answers) {
    const bool as_much = 1.0 - other.explained <=
                         kPolicy.directions.as_much * (1.0 - best->explained) + kPolicy.directions.no_more;
    if (as_much && !any_elsewhere(directions_of(context, *problem, other))) return {};
  }
  return list;
}

/// Whose place in the arm file each of them has, where all then bend as that says: of such orders the one
/// that exchanges the fewest.
std::optional<std::vector<std::size_t>> order_of(const std::vector<Direction>& list) {
  std::vector<std::size_t> order(list.size()), best;
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (list.size() < 2 || list.size() > kPolicy.directions.most_ordered) return std::nullopt;
  auto least = std::make_pair(list.size() + 1, 0.0);
  do {
    auto now = std::make_pair(std::size_t{0}, 0.0);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const bool same = list[i].signal->input->kind == list[order[i]].signal->input->kind;
      now.first += order[i] != i;
      now.second =
          std::max(now.second, same ? std::abs(turned(list[order[i]].told_rad, list[i].seen_rad)) : M_PI);
    }
    if (now.second < kPolicy.directions.alike_rad && now < least) {
      least = now;
      best = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  if (best.empty()) return std::nullopt;
  return best;
}

/// By how much all are turned about the arm's axis, where that is the same.
std::optional<double> turn_of(const std::vector<Direction>& list) {
  Vector2d sum = Vector2d::Zero();
  for (const Direction& one : list) {
    const double off_rad = turned(one.told_rad, one.seen_rad);
    sum += Vector2d(std::cos(off_rad), std::sin(off_rad));
  }
  const double turn_rad = std::atan2(sum.y(), sum.x());
  for (const Direction& one : list)
    if (std::abs(turned(one.told_rad + turn_rad, one.seen_rad)) > kPolicy.directions.alike_rad)
      return std::nullopt;
  return turn_rad;
}

std::string names_of(const std::vector<Direction>& list) {
  std::string names;
  for (const Direction& one : list) names += (names.empty() ? "" : ", ") + one.signal->input->name;
  return names;
}

constexpr char kWiring[] =
    "compare hoses, topics and columns with the arm file's inputs, and the base's x axis with its azimuths";

void say_order(Context& context, const std::vector<Direction>& list, const std::vector<std::size_t>& order) {
  std::string what;
  std::vector<Direction> moved;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (order[i] == i) continue;
    moved.push_back(list[i]);
    what += fmt::format("{}{} bends the arm where the arm file's {} does", what.empty() ? "" : ", ",
                        list[i].signal->input->name, list[order[i]].signal->input->name);
  }
  const std::optional<double> turn_rad = turn_of(list);
  if (turn_rad)
    what += fmt::format("; so does an arm that is turned by {:.0f} degrees about its axis at the base",
                        degrees_of(*turn_rad));
  CheckFinding& finding = context.add("bends_elsewhere", names_of(moved), what);
  finding.remedy = kWiring;
}

void say_turn(Context& context, const std::vector<Direction>& list, double turn_rad) {
  CheckFinding& finding =
      context.add("bends_elsewhere", names_of(list),
                  fmt::format("the arm bends {:.0f} degrees about its axis from where the arm file says",
                              degrees_of(turn_rad)));
  finding.figure = turn_rad;
  finding.unit = "rad";
  finding.remedy = kWiring;
}

/// What one input of several seems to do alone may be another's doing, in a closed loop or on a segment that
/// is carried along: said is what fits all of them.
void check_directions(Context& context) {
  if (!all_recorded(context)) return;
  const std::vector<Direction> list = surely_elsewhere(context);
  if (!any_elsewhere(list)) return;
  if (const auto order = order_of(list)) return say_order(context, list, *order);
  const auto bending = std::count_if(context.signals.begin(), context.signals.end(), [&](const Signal& s) {
    return bending_direction(context.arm, s.input->name, 1).has_value();
  });
  const auto turn_rad = turn_of(list);
  if (turn_rad && std::abs(*turn_rad) > kPolicy.directions.off_rad && (list.size() > 1 || bending == 1))
    say_turn(context, list, *turn_rad);
}

}  // namespace

std::optional<Vector2d> bending_direction(const arm::Arm& arm, const std::string& input,
                                          std::size_t segments) {
  std::optional<Vector2d> direction;
  for (std::size_t s = 0; s < std::min(segments, arm.segments.size()); ++s) {
    const arm::Segment& segment = arm.segments[s];
    for (const arm::ActuatorKind* kind : arm::actuator_kinds()) {
      for (int i = 0; i < kind->count(segment); ++i) {
        const auto azimuth = kind->bending_direction_rad(segment, i);
        if (!azimuth || kind->input(segment, i) != input) continue;
        const Vector2d here(std::cos(*azimuth), std::sin(*azimuth));
        if (direction && direction->dot(here) < kPolicy.directions.along) return std::nullopt;
        direction = here;
      }
    }
  }
  return direction;
}

Check make_input_directions() {
  return {check_directions, {{"bends_elsewhere", Severity::kSerious}}};
}

}  // namespace softarm::check
