#include "payload_equations.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "effects/catalogue.h"
#include "math/linear_algebra.h"
#include "ranges.h"
#include "screen.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* kOffAxis = "payload_offset";

bool is_off_axis(const model::Present& present) {
  return present.effect->info().id == kOffAxis;
}

/// Unknowns of a fit that do not move here: at an end of their range, and the offset, which is one of all
/// that hangs.
std::vector<bool> held_columns(const Linearised& at) {
  std::vector<bool> held = held_at_ends(at);
  for (std::size_t c = 0; c < held.size(); ++c) {
    const JointUnknown& column = at.columns[c];
    if (column.kind == JointUnknown::Kind::kEffect &&
        is_off_axis(at.at.effects[static_cast<std::size_t>(column.index)]))
      held[c] = true;
  }
  return held;
}

}  // namespace

PayloadEquations::PayloadEquations(const Linearised& at, ToldSums told, double offset_sd_m)
    : held_(held_columns(at)),
      inflation_(inflation(at)),
      square_(at.square),
      // A payload is as likely as the usual one beforehand, against the misfit as it is.
      before_(std::max(1.0, at.square / std::max(1, at.rows))),
      told_(std::move(told)) {
  information_ = at.information;
  gradient_ = at.gradient;
  hold(held_, information_, gradient_);
  const double trust = before_ / (offset_sd_m * offset_sd_m);
  told_.own.diagonal().array() += trust;
  told_.score -= trust * offset_in(at);
  solve();
}

PayloadEquations::Gain PayloadEquations::gain(const PayloadSums& sums, const Span& span) const {
  // Columns: off its axis what was told; the payload; that off its axis.
  constexpr Index kAll = kOffsets + kMoves;
  MatrixXd with(gradient_.size(), kAll);
  with << with_told_, column(sums);
  Eigen::Matrix<double, kAll, kAll> own;
  own << told_.own, sums.with_told, sums.with_told.transpose(), sums.own;
  own -= with.transpose() * covariance_ * with;
  Eigen::Matrix<double, kAll, 1> score;
  score << told_.score, sums.score;
  score -= with.transpose() * move_;
  const auto fall_with = [&](double more) {
    Eigen::Matrix<double, kAll, kMoves> taken = decltype(taken)::Zero();
    taken(kOffsets, 0) = 1.0;
    for (Index i = 0; i < kOffsets; ++i) {
      taken(i, 1 + i) = 1.0;
      taken(kOffsets + 1 + i, 1 + i) = more;
    }
    return fall_of(taken.transpose() * own * taken, taken.transpose() * score, more, span) - off_axis_;
  };
  if (span.exchanged > 0.0) return {fall_with(span.exchanged), span.exchanged};
  Gain best;
  // How much hangs off its axis goes with how much hangs: less and more are apart.
  // Much more is far from the usual.
  const double usual = std::min(span.high, kUsualTimes);
  for (const auto& [low, high] : {std::pair{span.low, 0.0}, {0.0, usual}, {usual, span.high}}) {
    if (!(low < high)) continue;
    std::uintmax_t steps = kGainSteps;
    const auto [more, rise] = boost::math::tools::brent_find_minima([&](double at) { return -fall_with(at); },
                                                                    low, high, kGainBits, steps);
    if (-rise > best.fall) best = {-rise, more};
  }
  return best;
}

double PayloadEquations::z(double part, double fall) const {
  return std::sqrt(std::max(0.0, part) /
                   (inflation_ * std::max(kLeastLeft, 1.0 - (fall + off_axis_) / square_)));
}

void PayloadEquations::add(const PayloadSums& sums, double already, double beside, const Span& span) {
  const MatrixXd with = column(sums);
  const Index n = gradient_.size();
  // Of two that have each other's nothing is to be found.
  const double trust = before_ / (span.exchanged > 0.0 ? kHeld * kHeld : 1.0);
  information_.conservativeResize(n + 1, n + 1);
  information_.col(n).head(n) = with.col(0);
  information_.row(n).head(n) = with.col(0).transpose();
  information_(n, n) = sums.own(0, 0) + trust;
  gradient_.conservativeResize(n + 1);
  gradient_[n] = sums.score[0] - trust * (already - span.exchanged);
  const Eigen::Matrix<double, kOffsets, kOffsets> told = sums.with_told.rightCols<kOffsets>();
  told_.mixed.conservativeResize(n + 1, kOffsets);
  told_.mixed.topRows(constants()) += beside * sums.mixed.rightCols<kOffsets>();
  told_.mixed.row(n) = (sums.with_told.col(0) + beside * sums.own.block<kOffsets, 1>(1, 0)).transpose();
  told_.score += beside * sums.score.tail<kOffsets>();
  told_.own += beside * (told + told.transpose() + beside * sums.own.bottomRightCorner<kOffsets, kOffsets>());
  solve();
}

double PayloadEquations::sd(std::size_t payload) const {
  return std::sqrt(inflation_ * all_covariance_(place(payload), place(payload)));
}

double PayloadEquations::fall_of(const Eigen::Matrix<double, kMoves, kMoves>& own, const Moves& score,
                                 double more, const Span& span) const {
  const Offsets offsets = score.tail<kOffsets>() - more * own.bottomLeftCorner<kOffsets, 1>();
  const double trust = span.exchanged > 0.0 ? 0.0 : before_;
  return more * (2.0 * score[0] - more * (own(0, 0) + trust)) +
         offsets.dot(own.bottomRightCorner<kOffsets, kOffsets>().ldlt().solve(offsets));
}

MatrixXd PayloadEquations::column(const PayloadSums& sums) const {
  MatrixXd with = MatrixXd::Zero(gradient_.size(), kMoves);
  for (std::size_t c = 0; c < held_.size(); ++c)
    if (!held_[c]) with.row(static_cast<Index>(c)) = sums.mixed.row(static_cast<Index>(c));
  return with;
}

void PayloadEquations::solve() {
  covariance_ = math::inverse_of_symmetric(information_);
  move_ = covariance_ * gradient_;
  with_told_ = told_.mixed;
  for (std::size_t c = 0; c < held_.size(); ++c)
    if (held_[c]) with_told_.row(static_cast<Index>(c)).setZero();
  const Offsets score = told_.score - with_told_.transpose() * move_;
  const Eigen::Matrix<double, kOffsets, kOffsets> own =
      told_.own - with_told_.transpose() * covariance_ * with_told_;
  const Eigen::Matrix<double, kOffsets, kOffsets> inverse = own.inverse();
  offset_m_ = inverse * score;
  off_axis_ = score.dot(offset_m_);
  const MatrixXd absorbed = covariance_ * with_told_;
  all_covariance_ = covariance_ + absorbed * inverse * absorbed.transpose();
  all_move_ = move_ - absorbed * offset_m_;
}

Eigen::Vector3d offset_in(const Linearised& at) {
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
  for (const model::Present& present : at.at.effects)
    if (is_off_axis(present)) offset_m += present.values.head<3>();
  return offset_m;
}

Linearised off_axis_by(const Eigen::Vector3d& offset_m, JointModel& model, Linearised at) {
  for (const std::unique_ptr<model::Effect>& effect : effects::catalogue()) {
    const bool known = std::any_of(model.known().begin(), model.known().end(),
                                   [&](const model::Present& p) { return p.effect == effect.get(); });
    if (effect->info().id != kOffAxis || known) continue;
    JointParameters from = at.at;
    model::Values values = offset_m;
    for (int i = 0; i < 3; ++i) {
      const model::Parameter& range = effect->info().parameters[static_cast<std::size_t>(i)];
      values[i] = std::clamp(values[i], range.low, range.high);
    }
    from.effects.push_back({effect.get(), values});
    at = model.fit(from, {}, &at.predicted);
  }
  return at;
}

}  // namespace softarm::diagnose
