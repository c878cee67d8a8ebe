#include "size_errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "math/linear_algebra.h"

namespace softarm::model {
namespace {

const double kAnywhere = 1.0 / std::sqrt(12.0);  // sd of a number that may be anywhere, over its range
constexpr double kLeastRoom = 0.1;               // of a standard deviation, for a difference to be one
constexpr double kNoError = 1e-9;                // variance of a direction, of numbers whose own is 1

/// The end of a number's range on an arm.
double high_of(const Parameter& parameter, const arm::Arm& arm) {
  return parameter.along ? std::min(parameter.high, arm.total_length_m()) : parameter.high;
}

/// Numbers that are correlated, if only through others, in the order of their first.
std::vector<std::vector<Eigen::Index>> groups_of(const Eigen::MatrixXd& correlations) {
  std::vector<std::vector<Eigen::Index>> groups;
  std::vector<bool> taken(static_cast<std::size_t>(correlations.rows()), false);
  for (Eigen::Index first = 0; first < correlations.rows(); ++first) {
    if (taken[static_cast<std::size_t>(first)]) continue;
    std::vector<Eigen::Index> group{first};
    taken[static_cast<std::size_t>(first)] = true;
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (Eigen::Index other = first + 1; other < correlations.rows(); ++other) {
        if (taken[static_cast<std::size_t>(other)] || correlations(group[i], other) == 0.0) continue;
        group.push_back(other);
        taken[static_cast<std::size_t>(other)] = true;
      }
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

/// Makes a variance no larger than `most`, as an observation of that number alone would: numbers that go with
/// it are known better, too.
void limit_variance(Eigen::Index k, double most, Eigen::MatrixXd& covariance) {
  const double variance = covariance(k, k);
  if (variance <= most) return;
  const Eigen::VectorXd with = covariance.col(k);
  covariance -= (variance - most) / (variance * variance) * with * with.transpose();
  covariance(k, k) = most;  // to rounding it is
}

}  // namespace

double SizeErrors::Number::most_sd() const {
  return kAnywhere * (high - low);
}

SizeErrors::SizeErrors(const arm::Arm& arm, std::vector<Present> effects)
    : arm_(arm), effects_(in_order(std::move(effects))) {
  for (std::size_t e = 0; e < effects_.size(); ++e) {
    const Present& present = effects_[e];
    const std::vector<Parameter>& parameters = present.effect->info().parameters;
    for (Eigen::Index k = 0; k < present.sd.size(); ++k) {
      const Parameter& parameter = parameters[static_cast<std::size_t>(k)];
      const double low = parameter.low, high = high_of(parameter, arm_);
      if (!parameter.counts && present.sd[k] > 0.0 && high > low)
        numbers_.push_back({e, k, present.sd[k], low, high});
    }
  }
  const Eigen::MatrixXd all = correlations();
  for (const std::vector<Eigen::Index>& group : groups_of(all)) add_errors(group, all);
}

Eigen::MatrixXd SizeErrors::correlations() const {
  const auto n = static_cast<Eigen::Index>(numbers_.size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Identity(n, n);
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Number &a = numbers_[i], &b = numbers_[j];
      const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
      all(row, column) = all(column, row) =
          correlation(effects_[a.effect], a.parameter, effects_[b.effect], b.parameter);
    }
  }
  return all;
}

void SizeErrors::add_errors(const std::vector<Eigen::Index>& group, const Eigen::MatrixXd& all) {
  const auto number = [&](Eigen::Index k) -> const Number& { return numbers_[static_cast<std::size_t>(k)]; };
  Eigen::VectorXd by_number = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(numbers_.size()));
  if (group.size() == 1) {
    const Number& alone = number(group[0]);
    by_number[group[0]] = std::min(alone.sd, alone.most_sd());
    add_error(by_number);
    return;
  }
  // In standard deviations of the file, then of what is left of those.
  Eigen::MatrixXd covariance = math::block_of(all, group);
  const Eigen::Index n = covariance.rows();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Number& of = number(group[static_cast<std::size_t>(i)]);
    limit_variance(i, std::pow(of.most_sd() / of.sd, 2), covariance);
  }
  const Eigen::VectorXd sd = covariance.diagonal().cwiseSqrt();
  const math::Eigensystem directions =
      math::eigensystem_of(sd.cwiseInverse().asDiagonal() * covariance * sd.cwiseInverse().asDiagonal());
  for (Eigen::Index d = 0; d < n; ++d) {
    if (!(directions.values[d] > kNoError)) continue;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index k = group[static_cast<std::size_t>(i)];
      by_number[k] = number(k).sd * sd[i] * std::sqrt(directions.values[d]) * directions.vectors(i, d);
    }
    add_error(by_number);
  }
}

double SizeErrors::room_for(const Eigen::VectorXd& by_number) const {
  double share = 1.0;
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    const double move = by_number[static_cast<Eigen::Index>(k)];
    if (move == 0.0) continue;
    const double value = value_of(numbers_[k], effects_);
    const double room = move > 0.0 ? numbers_[k].high - value : value - numbers_[k].low;
    share = std::min(share, std::max(0.0, room / std::abs(move)));
  }
  return share;
}

void SizeErrors::add_error(const Eigen::VectorXd& by_number) {
  const double up = room_for(by_number), down = room_for(-by_number);
  const double side = up >= 1.0 || up >= down ? 1.0 : -1.0;
  // Numbers at the ends of their ranges, correlated against these, leave no room to either side: then those
  // move that can.
  const bool stuck = std::max(up, down) < kLeastRoom;
  const double share = stuck ? 1.0 : side > 0.0 ? up : down;
  std::vector<Present> others = effects_;
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    const Number& number = numbers_[k];
    const double move = side * share * by_number[static_cast<Eigen::Index>(k)];
    if (move == 0.0) continue;
    double& value = others[number.effect].values[number.parameter];
    const bool to_the_end = stuck || share < 1.0;  // and no further by rounding
    value = to_the_end ? std::clamp(value + move, number.low, number.high) : value + move;
  }
  errors_.push_back({by_number, side / share, others, Memories(others)});
}

std::vector<Present> SizeErrors::leaning(const Eigen::VectorXd& by_sd) const {
  Eigen::VectorXd moves = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(numbers_.size()));
  for (int k = 0; k < count(); ++k) moves += by_sd[k] * at(k).by_number;
  std::vector<Present> effects = effects_;
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    const Number& number = numbers_[k];
    double& value = effects[number.effect].values[number.parameter];
    value = std::clamp(value + moves[static_cast<Eigen::Index>(k)], number.low, number.high);
  }
  return effects;
}

void SizeErrors::rest() {
  for (Error& error : errors_) error.memories.rest();
}

void SizeErrors::drive(const Series& undriven) {
  for (Error& error : errors_) {
    Series series = undriven;
    model::drive(arm_, error.effects, series);
    error.inputs = series.inputs.rightCols<1>();
    error.moment_inputs = series.moment_inputs.rightCols<1>();
    error.payload_kg = series.payload_kg[series.payload_kg.size() - 1];
  }
}

void SizeErrors::remember(const FineRod& fine, const Instant& instant, const Shape& shape) {
  for (Error& error : errors_) error.memories.remember(arm_, fine, instant, shape);
}

void SizeErrors::drive(int k, Instant& instant) const {
  instant.inputs = at(k).inputs;
  instant.moment_inputs = at(k).moment_inputs;
  instant.payload_kg = at(k).payload_kg;
}

}  // namespace softarm::model
