#include "law_library.h"

#include <algorithm>
#include <cmath>

#include "effects/learned_moment.h"
#include "math/parallel.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using effects::learned_moment;
using effects::LearnedMoment;
using effects::Regressor;
using model::Values;

constexpr double kLeastRange = 1e-9;  // of the largest value: what varies less does not

Values term(Regressor of, std::size_t first = 0, std::size_t second = 0, double scale = 0.0) {
  Values values = Values::Zero(LearnedMoment::kCount);
  values[LearnedMoment::kOf] = static_cast<double>(of);
  values[LearnedMoment::kFirst] = static_cast<double>(first);
  values[LearnedMoment::kSecond] = static_cast<double>(second);
  values[LearnedMoment::kScale] = scale;
  return values;
}

/// Least and largest of an input in the blocks that are compared.
std::pair<double, double> range_of(const JointModel& model, const Linearised& at, Eigen::Index input) {
  double low = 1e300, high = -1e300;
  for (std::size_t t = 0; t < at.predicted.size(); ++t) {
    for (std::size_t k = 0; k < at.predicted[t].size(); ++k) {
      if (!model.uses(t, k) || !at.predicted[t][k].solved) continue;
      low = std::min(low, at.predicted[t][k].instant.inputs[input]);
      high = std::max(high, at.predicted[t][k].instant.inputs[input]);
    }
  }
  return {low, high};
}

/// Everything that might be, whether it varies or not.
std::vector<Values> candidates(const JointModel& model, const Linearised& at) {
  std::vector<Values> list;
  const std::size_t inputs = model.arm().inputs.scalars.size();
  for (std::size_t i = 1; i <= inputs; ++i) {
    const auto [low, high] = range_of(model, at, static_cast<Eigen::Index>(i) - 1);
    if (!(high - low > kLeastRange * std::max(std::abs(low), std::abs(high)))) continue;
    list.push_back(term(Regressor::kInput, i));
    for (std::size_t j = i; j <= inputs; ++j) list.push_back(term(Regressor::kProduct, i, j));
    for (const double width : kPolicy.flexible.play)
      list.push_back(term(Regressor::kPlay, i, 0, width * (high - low)));
    for (const double time_s : kPolicy.law.times_s) list.push_back(term(Regressor::kLag, i, 0, time_s));
  }
  list.push_back(term(Regressor::kPayload));
  list.push_back(term(Regressor::kAttitude));
  for (const double time_s : kPolicy.law.times_s) list.push_back(term(Regressor::kDriveLag, 0, 0, time_s));
  for (const double time_s : kPolicy.law.times_s)
    list.push_back(term(Regressor::kCurvatureLag, 0, 0, time_s));
  list.push_back(term(Regressor::kCurvature));
  return list;
}

/// What it goes with in one trial, as the model walks through it.
std::vector<Eigen::Matrix2Xd> walk(const JointModel& model, const arm::Arm& arm, const Linearised& at,
                                   std::size_t trial, const Values& values) {
  const bool vector = LearnedMoment::is_vector(LearnedMoment::of(values));
  const auto places = static_cast<Eigen::Index>(vector ? model.rod().pieces().size() : 1);
  std::vector<Eigen::Matrix2Xd> list(at.predicted[trial].size());
  model::Memory memory;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const model::Predicted& now = at.predicted[trial][k];
    if (!now.solved) continue;
    if (k > 0 && now.instant.dt_s <= 0.0) memory.clear();
    list[k].resize(2, places);
    for (Eigen::Index j = 0; j < places; ++j)
      list[k].col(j) = learned_moment().regressor(arm, model.rod(), values, now.instant, memory,
                                                  static_cast<std::size_t>(j));
    learned_moment().remember(arm, model.rod(), values, now.instant, now.shape, memory);
  }
  return list;
}

/// Puts in the range that the term has in the blocks that are compared.
/// @return whether it varies
bool set_range(const JointModel& model, LibraryTerm& term) {
  const bool vector = LearnedMoment::is_vector(LearnedMoment::of(term.values));
  double low = 1e300, high = -1e300;
  for (std::size_t t = 0; t < term.regressor.size(); ++t) {
    for (std::size_t k = 0; k < term.regressor[t].size(); ++k) {
      const Eigen::Matrix2Xd& z = term.regressor[t][k];
      if (z.size() == 0 || !model.uses(t, k)) continue;
      low = std::min(low, vector ? 0.0 : z(0, 0));
      high = std::max(high, vector ? z.colwise().norm().maxCoeff() : z(0, 0));
    }
  }
  term.values[LearnedMoment::kFrom] = low;
  term.values[LearnedMoment::kTo] = high;
  return high - low > kLeastRange * std::max(std::abs(low), std::abs(high));
}

}  // namespace

std::vector<LibraryTerm> law_library(const JointModel& model, const Linearised& at, unsigned jobs) {
  const arm::Arm arm = model.arm_with(at.at.constants);
  std::vector<LibraryTerm> all;
  for (const Values& values : candidates(model, at)) all.push_back({values, {}});
  std::vector<char> varies(all.size(), 0);
  math::in_parallel(all.size(), jobs, [&](std::size_t i) {
    for (std::size_t t = 0; t < at.predicted.size(); ++t)
      all[i].regressor.push_back(walk(model, arm, at, t, all[i].values));
    varies[i] = set_range(model, all[i]) ? 1 : 0;
  });
  std::vector<LibraryTerm> list;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (varies[i] != 0) list.push_back(std::move(all[i]));
  return list;
}

std::vector<Values> with_rising(const Values& values) {
  std::vector<Values> list(2, values);
  list[0][LearnedMoment::kRising] = 0.0;
  list[1][LearnedMoment::kRising] = 1.0;
  return list;
}

Eigen::MatrixX2d unit_moments(const model::FineRod& rod, const Values& values,
                              const Eigen::Matrix2Xd& regressor) {
  const double most = std::max(std::abs(values[LearnedMoment::kFrom]), std::abs(values[LearnedMoment::kTo]));
  const bool rising = std::lround(values[LearnedMoment::kRising]) == 1;
  const auto pieces = static_cast<Eigen::Index>(rod.pieces().size());
  Eigen::MatrixX2d moments(2 * pieces, 2);
  for (Eigen::Index j = 0; j < pieces; ++j) {
    const double middle_m = rod.pieces()[static_cast<std::size_t>(j)].middle_m();
    const double share = (rising ? 2.0 * middle_m / rod.length_m() - 1.0 : 1.0) / most;
    const Eigen::Vector2d z = share * regressor.col(std::min(j, regressor.cols() - 1));
    // As LearnedMoment::act() has it: along z and across, about the axes of the section.
    moments.col(0).segment<2>(2 * j) << -z.y(), z.x();
    moments.col(1).segment<2>(2 * j) << -z.x(), -z.y();
  }
  return moments;
}

}  // namespace softarm::diagnose
