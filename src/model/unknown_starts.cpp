#include "unknown_starts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "memories.h"
#include "softarm/arm/laws.h"

namespace softarm::model {
namespace {

using Eigen::Vector2d;

constexpr double kForgotten = 1e-3;      // share of the first difference
constexpr double kForgotten_rad = 1e-5;  // of a segment's turn, where inputs have it

double distance(const Memory& a, const Memory& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

/// What the laws make of the last inputs of a series: curvature without load towards x and y.
std::optional<std::vector<Vector2d>> curvatures(const arm::Arm& arm, const Series& series) {
  const Eigen::VectorXd last = series.moment_inputs.rightCols<1>();
  const auto predictions =
      softarm::arm::predict(arm, arm::InputValues(last.data(), last.data() + last.size()));
  if (!predictions) return std::nullopt;
  std::vector<Vector2d> list;
  for (const arm::SegmentPrediction& p : *predictions)
    list.push_back(p.moment_nm / p.bending_stiffness_nm2 + p.curvature_per_m);
  return list;
}

/// Mean curvature without load of each segment, towards x and y.
std::vector<Vector2d> curvatures(const arm::Arm& arm, const FineRod& fine, const rod::Rod& rod) {
  std::vector<Vector2d> list(arm.segments.size(), Vector2d::Zero());
  for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
    const Piece& piece = fine.pieces()[j];
    const rod::Segment& of = rod.segments[j];
    const Vector2d turn = of.rest_curvature_per_m.head<2>() + of.curvature_of(of.moment_nm.head<2>());
    // Bending towards the azimuth (a, b) is a turn about (-b, a).
    list[static_cast<std::size_t>(piece.segment)] +=
        (piece.fraction_to - piece.fraction_from) * Vector2d(turn.y(), -turn.x());
  }
  return list;
}

}  // namespace

UnknownStarts::UnknownStarts(const arm::Arm& arm, std::vector<Present> effects)
    : arm_(arm), effects_(in_order(std::move(effects))) {}

void UnknownStarts::begin(const FineRod& fine) {
  numbers_.clear();
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    const Present& present = effects_[i];
    const auto count = static_cast<Eigen::Index>(present.effect->starts(arm_, present.values).size());
    for (Eigen::Index k = 0; k < count; ++k) {
      Number number{i, Eigen::VectorXd::Unit(count, k), {}};
      present.effect->begin(arm_, fine, present.values, number.start, number.memory);
      numbers_.push_back(std::move(number));
    }
  }
}

void UnknownStarts::drive(const Series& series, const Series& driven) {
  const auto in_inputs = [](const Number& number) { return number.memory.empty(); };
  if (std::none_of(numbers_.begin(), numbers_.end(), in_inputs)) return;
  const auto here = curvatures(arm_, driven);
  if (!here) return;
  for (Number& number : numbers_) {
    if (!in_inputs(number)) continue;
    std::vector<Present> effects = effects_;
    effects[number.effect].start = number.start;
    Series other = series;
    model::drive(arm_, effects, other);
    const auto there = curvatures(arm_, other);
    if (!there) continue;
    double most_rad = 0.0;
    number.by_inputs.resize(here->size());
    for (std::size_t s = 0; s < here->size(); ++s) {
      number.by_inputs[s] = (*there)[s] - (*here)[s];
      most_rad = std::max(most_rad, number.by_inputs[s].norm() * arm_.segments[s].length_m);
    }
    if (most_rad < kForgotten_rad) number.first_difference = 0.0;
  }
  numbers_.erase(std::remove_if(numbers_.begin(), numbers_.end(),
                                [&](const Number& n) { return in_inputs(n) && n.first_difference == 0.0; }),
                 numbers_.end());
}

void UnknownStarts::remember(const FineRod& fine, const Instant& instant, const Shape& shape,
                             const std::vector<Memory>& memories) {
  const auto forgotten = [&](Number& number) {
    if (number.memory.empty()) return false;
    const Present& present = effects_[number.effect];
    present.effect->remember(arm_, fine, present.values, instant, shape, number.memory);
    const double off = distance(number.memory, memories[number.effect]);
    if (number.first_difference < 0.0) number.first_difference = off;
    return off <= kForgotten * number.first_difference;
  };
  numbers_.erase(std::remove_if(numbers_.begin(), numbers_.end(), forgotten), numbers_.end());
}

std::vector<Vector2d> UnknownStarts::curvature_variance(
    InstantSolver& solver, const std::vector<Memory>& memories, const Instant& instant, const Shape& shape,
    const std::vector<arm::SegmentPrediction>& given) const {
  static const Dynamics kStill{false, 0.0};
  std::vector<Vector2d> variance(arm_.segments.size(), Vector2d::Zero());
  rod::Rod rod;
  const auto with = [&](const std::vector<Memory>& remembered) {
    solver.make(arm_, effects_, remembered, kStill, instant, &shape, {}, rod, &given);
    return curvatures(arm_, solver.fine, rod);
  };
  const std::vector<Vector2d> here = with(memories);
  std::vector<Memory> others = memories;
  for (const Number& number : numbers_) {
    if (number.memory.empty()) {
      for (std::size_t s = 0; s < number.by_inputs.size(); ++s)
        variance[s] += number.by_inputs[s].cwiseAbs2();
      continue;
    }
    others[number.effect] = number.memory;
    const std::vector<Vector2d> there = with(others);
    others[number.effect] = memories[number.effect];
    for (std::size_t s = 0; s < variance.size(); ++s) variance[s] += (there[s] - here[s]).cwiseAbs2();
  }
  return variance;
}

}  // namespace softarm::model
