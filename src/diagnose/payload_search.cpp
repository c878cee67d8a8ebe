#include "payload_search.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "effects/catalogue.h"
#include "math/linear_algebra.h"
#include "policy.h"
#include "ranges.h"
#include "screen.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Something more hangs where the payload does, and off its axis. No effect of the arm, and of no catalogue:
/// what was told is wrong, in one trial or another.
class MorePayload : public model::Effect {
 public:
  const model::Info& info() const override { return info_; }
  bool varies_along() const override { return false; }
  void drive(const arm::Arm&, const model::Values& values, model::Series& series) const override {
    series.payload_kg.array() += values[0];
  }
  void act(const arm::Arm&, const model::FineRod&, const model::Values& values, const model::Instant& instant,
           const model::Shape*, const model::Memory&, rod::Rod& rod) const override {
    if (instant.payload_kg > 0.0)
      rod.loads[rod::kPayloadLoad].offset_m += values.tail<3>() / instant.payload_kg;
  }

 private:
  const model::Info info_{"more_payload",
                          "more hangs on the arm than was told",
                          "m = m_told + more, m offset = m_told offset_told + (x, y, z)",
                          "",
                          model::Family::kLoad,
                          {{"more_kg", "kg", "beside what was told", -1e3, 1e3, 1.0},
                           {"x_kg_m", "kg m", "off its axis along x, times the mass", -1e3, 1e3, 1.0},
                           {"y_kg_m", "kg m", "the same along y", -1e3, 1e3, 1.0},
                           {"z_kg_m", "kg m", "the same along z", -1e3, 1e3, 1.0}},
                          4,
                          {},
                          {}};
};

constexpr const char* kOffAxis = "payload_offset";
constexpr double kPayloadStep = 0.02;  // of the usual payload: a difference to first order
constexpr double kOffsetStep = 0.5;    // of the length, of such a payload

/// Of a payload over the usual one, and of that one a metre off its axis: x, y, z.
constexpr Index kMoves = 4, kOffsets = 3;
using Moves = Eigen::Matrix<double, kMoves, 1>;
using Offsets = Eigen::Matrix<double, kOffsets, 1>;

/// Sums over stretches of trials: of moves [m b], m by the usual payload and b by that one off its axis, with
/// the derivatives J by the constants, with residuals, with themselves, and with w b, w what was told there.
struct PayloadSums {
  explicit PayloadSums(Index constants) : mixed(MatrixXd::Zero(constants, kMoves)) {}
  MatrixXd mixed;  ///< J^T [m b]
  Moves score = Moves::Zero();
  Eigen::Matrix<double, kMoves, kMoves> own = decltype(own)::Zero();
  Eigen::Matrix<double, kOffsets, kMoves> with_told = decltype(with_told)::Zero();

  /// Those of another stretch, in which it hangs with this sign.
  void add(double sign, const PayloadSums& other) {
    mixed += sign * other.mixed;
    score += sign * other.score;
    own += other.own;
    with_told += sign * other.with_told;
  }
};

/// Sums over all trials of w b: what was told hangs off its axis.
struct ToldSums {
  explicit ToldSums(Index constants) : mixed(MatrixXd::Zero(constants, kOffsets)) {}
  MatrixXd mixed;
  Offsets score = Offsets::Zero();
  Eigen::Matrix<double, kOffsets, kOffsets> own = decltype(own)::Zero();
};

/// Sums of one trial up to each of its blocks.
class PayloadSumsTo {
 public:
  /// @param moves of [m b], four columns
  PayloadSumsTo(const Linearised& at, const model::TrialData& trial, std::size_t t, const MatrixXd& moves,
                double usual_kg)
      : to_(trial.blocks.size() + 1, PayloadSums(at.gradient.size())), told_(at.gradient.size()) {
    Index bodies = 0, tangents = 0;  // the first rows of a block
    for (const model::Block& block : trial.blocks) tangents += 3 * static_cast<Index>(block.bodies.size());
    for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
      const model::Block& block = trial.blocks[k];
      const double told =
          trial.series.payload_kg
              .segment(static_cast<Index>(block.first), static_cast<Index>(block.last - block.first))
              .mean() /
          usual_kg;
      PayloadSums& to = to_[k + 1];
      to = to_[k];
      for (auto [row, seen] :
           {std::pair<Index&, std::size_t>{bodies, block.bodies.size()}, {tangents, block.tangents.size()}}) {
        const Index rows = 3 * static_cast<Index>(seen);
        const auto own = moves.middleRows(row, rows);
        PayloadSums here(at.gradient.size());
        here.mixed = at.derivative[t].middleRows(row, rows).transpose() * own;
        here.score = own.transpose() * at.residual[t].segment(row, rows);
        here.own = own.transpose() * own;
        here.with_told = told * here.own.bottomRows<kOffsets>();
        to.add(1.0, here);
        told_.mixed += told * here.mixed.rightCols<kOffsets>();
        told_.score += told * here.score.tail<kOffsets>();
        told_.own += told * here.with_told.rightCols<kOffsets>();
        row += rows;
      }
    }
  }
  /// Of a stretch of blocks [first, last): adds it.
  void add_between(std::size_t first, std::size_t last, double sign, PayloadSums& sums) const {
    PayloadSums stretch = to_[last];
    stretch.mixed -= to_[first].mixed;
    stretch.score -= to_[first].score;
    stretch.own -= to_[first].own;
    stretch.with_told -= to_[first].with_told;
    sums.add(sign, stretch);
  }
  const ToldSums& told() const { return told_; }

 private:
  std::vector<PayloadSums> to_;
  ToldSums told_;
};

/// Of what hangs beside what was told, over the usual payload.
struct Span {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  double exchanged = 0.0;  ///< of two that have each other's: just that; else 0
};

bool is_off_axis(const model::Present& present) {
  return present.effect->info().id == kOffAxis;
}

/// What hangs is off its axis in a fit by so much.
Eigen::Vector3d offset_in(const Linearised& at) {
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
  for (const model::Present& present : at.at.effects)
    if (is_off_axis(present)) offset_m += present.values.head<3>();
  return offset_m;
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

/// Normal equations of the constants, of payloads beside what was told, over the usual one, and of where what
/// hangs is off its axis, m.
class PayloadEquations {
 public:
  /// @param offset_sd_m as which a payload may be off its axis
  PayloadEquations(const Linearised& at, ToldSums told, double offset_sd_m)
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

  struct Gain {
    double fall = 0.0;  ///< of chi^2, beside what was told off its axis
    double more = 0.0;
  };
  /// With one payload more, within what can hang there, which hangs where all others do.
  Gain gain(const PayloadSums& sums, const Span& span) const {
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
      const auto [more, rise] = boost::math::tools::brent_find_minima(
          [&](double at) { return -fall_with(at); }, low, high, kGainBits, steps);
      if (-rise > best.fall) best = {-rise, more};
    }
    return best;
  }
  /// Of a part of a fall of chi^2: what falls does not count as scatter.
  double z(double part, double fall) const {
    return std::sqrt(std::max(0.0, part) /
                     (inflation_ * std::max(kLeastLeft, 1.0 - (fall + off_axis_) / square_)));
  }
  /// @param already of it, in the fit and in what counts as told
  /// @param beside of it, found beside what counts as told
  void add(const PayloadSums& sums, double already, double beside, const Span& span) {
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
    told_.own +=
        beside * (told + told.transpose() + beside * sums.own.bottomRightCorner<kOffsets, kOffsets>());
    solve();
  }
  /// By which all that hangs is off its axis.
  const Offsets& offset_m() const { return offset_m_; }
  /// Of the payload that was added so many after the first.
  double more(std::size_t payload) const { return all_move_[place(payload)]; }
  double sd(std::size_t payload) const {
    return std::sqrt(inflation_ * all_covariance_(place(payload), place(payload)));
  }

 private:
  static constexpr int kGainSteps = 30, kGainBits = 10;
  static constexpr double kUsualTimes = 2.0;
  static constexpr double kLeastLeft = 1e-3;  // of chi^2: rounding
  static constexpr double kHeld = 1e-4;       // sd of a payload that is known, over the usual one

  Index constants() const { return static_cast<Index>(held_.size()); }
  Index place(std::size_t payload) const { return constants() + static_cast<Index>(payload); }
  /// Fall of chi^2 with so much more, and all off their axis where that is most.
  double fall_of(const Eigen::Matrix<double, kMoves, kMoves>& own, const Moves& score, double more,
                 const Span& span) const {
    const Offsets offsets = score.tail<kOffsets>() - more * own.bottomLeftCorner<kOffsets, 1>();
    const double trust = span.exchanged > 0.0 ? 0.0 : before_;
    return more * (2.0 * score[0] - more * (own(0, 0) + trust)) +
           offsets.dot(own.bottomRightCorner<kOffsets, kOffsets>().ldlt().solve(offsets));
  }
  /// With the unknowns so far: the constants, and payloads of other trials, which it has nothing to do with.
  MatrixXd column(const PayloadSums& sums) const {
    MatrixXd with = MatrixXd::Zero(gradient_.size(), kMoves);
    for (std::size_t c = 0; c < held_.size(); ++c)
      if (!held_[c]) with.row(static_cast<Index>(c)) = sums.mixed.row(static_cast<Index>(c));
    return with;
  }
  void solve() {
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

  const std::vector<bool> held_;  ///< constants
  const double inflation_, square_, before_;
  ToldSums told_;  ///< rows: constants, payloads
  MatrixXd information_, covariance_, with_told_, all_covariance_;
  VectorXd gradient_, move_, all_move_;
  Offsets offset_m_;
  double off_axis_ = 0.0;  ///< fall of chi^2 where what was told is off its axis
};

/// Zeroes the blocks in which one of the arms has no equilibrium: its column alone is nothing there.
void leave_out_unsolved(const model::TrialData& trial, MatrixXd& moves) {
  Index row = 0;
  for (const model::Block& block : trial.blocks) {
    auto of_block = moves.middleRows(row, 3 * static_cast<Index>(block.bodies.size()));
    const Eigen::Array<bool, 1, Eigen::Dynamic> moved = of_block.colwise().squaredNorm().array() > 0.0;
    if (moved.any() && !moved.all()) of_block.setZero();
    row += of_block.rows();
  }
}

/// Sums of all trials.
class PayloadSumsOf {
 public:
  PayloadSumsOf(JointModel& model, const Linearised& at, double usual_kg) : constants_(at.gradient.size()) {
    static const MorePayload kMore;
    const double step_m = kOffsetStep * model.arm().total_length_m();
    std::vector<JointParameters> changed(kMoves, at.at);
    for (Index k = 0; k < kMoves; ++k) {
      model::Values values = model::Values::Zero(kMoves);
      values[0] = kPayloadStep * usual_kg;
      if (k > 0) values[k] = values[0] * step_m;
      changed[static_cast<std::size_t>(k)].effects.push_back({&kMore, std::move(values)});
    }
    std::vector<MatrixXd> moves(model.trials().size());
    model.each_trial([&](std::size_t t) {
      moves[t] = model.differences(at, t, changed, std::vector<double>(kMoves, kPayloadStep));
      leave_out_unsolved(model.trials()[t], moves[t]);
      for (Index k = 1; k < kMoves; ++k) moves[t].col(k) = (moves[t].col(k) - moves[t].col(0)) / step_m;
      moves[t] = at.root_weight[t].asDiagonal() * moves[t];
    });
    for (std::size_t t = 0; t < moves.size(); ++t)
      trials_.emplace_back(at, model.trials()[t], t, moves[t], usual_kg);
  }
  PayloadSums over(const std::vector<TrialStretch>& where) const {
    PayloadSums sums(constants_);
    for (const TrialStretch& one : where) trials_[one.trial].add_between(one.first, one.last, one.sign, sums);
    return sums;
  }
  ToldSums told() const {
    ToldSums sums(constants_);
    for (const PayloadSumsTo& trial : trials_) {
      sums.mixed += trial.told().mixed;
      sums.score += trial.told().score;
      sums.own += trial.told().own;
    }
    return sums;
  }

 private:
  Index constants_;
  std::vector<PayloadSumsTo> trials_;
};

/// What can hang there beside what was told, kg: together no less than nothing, and what the arm may bear.
Span possible_kg(const std::vector<TrialStretch>& where, const JointModel& model) {
  Span span;
  for (const TrialStretch& stretch : where) {
    const ToldIn told = told_in(stretch, model.trials()[stretch.trial]);
    const double less = told.least, more = std::max(0.0, model.arm().payload.range_kg.high - told.most);
    span.low = std::max(span.low, stretch.sign > 0.0 ? -less : -more);
    span.high = std::min(span.high, stretch.sign > 0.0 ? more : less);
  }
  return span;
}

/// The same over the usual payload, and what is expected: of two that have each other's, just that.
Span span_of(const OtherPayload& payload, const JointModel& model, double usual_kg) {
  Span span = possible_kg(payload.where, model);
  span.low /= usual_kg;
  span.high /= usual_kg;
  if (payload.exchanged_kg) span.exchanged = *payload.exchanged_kg / usual_kg;
  return span;
}

struct FoundPayload {
  OtherPayload payload;
  PayloadEquations::Gain gain;
};

/// Payloads that may be other ones, weighed against each other.
class PayloadSearch {
 public:
  PayloadSearch(JointModel& model, const Linearised& at, double usual_kg)
      : model_(model),
        usual_kg_(usual_kg),
        sums_(model, at, usual_kg),
        equations_(at, sums_.told(), kPolicy.told.offset_sd * model.arm().total_length_m()),
        is_in_(model.trials().size(), false),
        is_all_in_(is_in_) {}

  /// @param beside of it, over the usual one, that is not in the trials
  void add(const OtherPayload& payload, double beside) {
    for (const TrialStretch& stretch : payload.where) {
      is_in_[stretch.trial] = true;
      is_all_in_[stretch.trial] = payload.exchanged_kg ? false : is_all(stretch);
    }
    equations_.add(sums_.over(payload.where), payload.more_kg / usual_kg_, beside,
                   span_of(payload, model_, usual_kg_));
    list_.push_back(payload);
  }
  std::size_t size() const { return list_.size(); }
  /// The one that gains most beside those; nothing where none is worth a second diagnosis.
  std::optional<FoundPayload> next() const {
    FoundPayload best;
    for (std::size_t t = 0; t < is_in_.size(); ++t) {
      if (!is_in_[t]) take_better(in_one_trial(t), best);
    }
    const std::map<double, std::vector<TrialStretch>> groups = told_alike();
    for (const auto& [told_kg, trials] : groups) {
      for (std::vector<TrialStretch>& some : several_of(trials)) {
        // A trial more is to gain something: one that says nothing would join any other.
        FoundPayload one = found(std::move(some));
        if (equations_.z(one.gain.fall - best.gain.fall, one.gain.fall) >= kPolicy.told.least_z)
          best = std::move(one);
      }
    }
    FoundPayload exchanged = exchanged_among(groups);
    if (exchanged.gain.fall > kPolicy.told.exchanged * best.gain.fall &&
        equations_.z(best.gain.fall - exchanged.gain.fall, best.gain.fall) < kPolicy.told.least_z)
      best = std::move(exchanged);
    if (equations_.z(best.gain.fall, best.gain.fall) < kPolicy.told.least_z) return std::nullopt;
    return best;
  }
  /// All of them, with what the fit makes of them together; without those of which it leaves next to nothing.
  OtherPayloads all() const {
    OtherPayloads found{list_, equations_.offset_m()};
    std::vector<OtherPayload>& list = found.list;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (list[i].exchanged_kg) {
        list[i].more_kg = *list[i].exchanged_kg;
        continue;
      }
      const Span possible = possible_kg(list[i].where, model_);
      list[i].more_kg += std::clamp(usual_kg_ * equations_.more(i), possible.low, possible.high);
      list[i].sd_kg = usual_kg_ * equations_.sd(i);
    }
    const double least = least_kg(list);
    list.erase(std::remove_if(list.begin(), list.end(),
                              [&](const OtherPayload& one) { return std::abs(one.more_kg) < least; }),
               list.end());
    return found;
  }

 private:
  /// Below which a difference is an effect's.
  double least_kg(const std::vector<OtherPayload>& list) const {
    double heaviest = usual_kg_;
    for (const OtherPayload& one : list) heaviest = std::max(heaviest, std::abs(one.more_kg));
    return kPolicy.told.least_share * heaviest;
  }
  /// Blocks in which one hangs, of a trial.
  std::size_t fewest_blocks(std::size_t t) const {
    return static_cast<std::size_t>(
        std::ceil(kPolicy.told.least_time * static_cast<double>(model_.trials()[t].blocks.size())));
  }
  bool is_all(const TrialStretch& stretch) const {
    const std::size_t outside = model_.trials()[stretch.trial].blocks.size() - (stretch.last - stretch.first);
    return outside < fewest_blocks(stretch.trial);
  }
  /// Whether something was told right, in some trial: what hangs in all of them is the arm's own.
  bool leaves_some(const std::vector<TrialStretch>& where) const {
    std::vector<bool> all = is_all_in_;
    for (const TrialStretch& stretch : where) all[stretch.trial] = is_all(stretch);
    return std::find(all.begin(), all.end(), false) != all.end();
  }
  FoundPayload found(std::vector<TrialStretch> where, std::optional<double> exchanged_kg = {}) const {
    FoundPayload one;
    one.payload.where = std::move(where);
    one.payload.exchanged_kg = exchanged_kg;
    weigh(span_of(one.payload, model_, usual_kg_), one);
    return one;
  }
  /// Nothing is gained by one that cannot be, or makes too small a difference.
  void weigh(const Span& span, FoundPayload& one) const {
    if (!one.payload.exchanged_kg && !leaves_some(one.payload.where)) return;
    const PayloadEquations::Gain gain = equations_.gain(sums_.over(one.payload.where), span);
    if (std::abs(gain.more) * usual_kg_ >= least_kg(list_)) one.gain = gain;
  }
  /// Of one trial what gains most: another payload in all of it, or in all of it that was told the same, or
  /// there from some time on, or up to one.
  FoundPayload in_one_trial(std::size_t t) const {
    const std::size_t fewest = fewest_blocks(t);
    FoundPayload whole, part;
    for (const TrialStretch& told : told_the_same(t)) {
      if (told.last - told.first < fewest) continue;
      const Span span = span_of({{told}}, model_, usual_kg_);
      take_better(found({told}), whole);
      for (std::size_t k = 1; k + fewest <= told.last - told.first; ++k) {
        for (const TrialStretch& stretch :
             {TrialStretch{t, told.first + k, told.last}, {t, told.first, told.last - k}}) {
          FoundPayload one{{{stretch}}, {}};
          weigh(span, one);
          take_better(std::move(one), part);
        }
      }
    }
    // A time at which it changed is a number more.
    const double more = part.gain.fall - whole.gain.fall;
    return equations_.z(more, part.gain.fall) < kPolicy.told.least_z ? whole : part;
  }
  /// Stretches of a trial in which one payload was told, or nearly: that of a load cell flickers.
  std::vector<TrialStretch> told_the_same(std::size_t t) const {
    std::vector<TrialStretch> stretches;
    const model::TrialData& trial = model_.trials()[t];
    ToldIn here;
    for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
      const ToldIn told = told_in({t, k, k + 1}, trial);
      here.least = std::min(here.least, told.least);
      here.most = std::max(here.most, told.most);
      if (k > 0 && here.most - here.least <= kPolicy.told.settled * usual_kg_) {
        stretches.back().last = k + 1;
      } else {
        stretches.push_back({t, k, k + 1});
        here = told;
      }
    }
    return stretches;
  }
  /// Trials that were told one payload all along, and are not spoken for, by what was told.
  std::map<double, std::vector<TrialStretch>> told_alike() const {
    std::map<double, std::vector<TrialStretch>> groups;
    for (std::size_t t = 0; t < is_in_.size(); ++t) {
      const model::TrialData& trial = model_.trials()[t];
      const VectorXd& told_kg = trial.series.payload_kg;
      if (!is_in_[t] && told_kg.minCoeff() == told_kg.maxCoeff())
        groups[told_kg[0]].push_back({t, 0, trial.blocks.size()});
    }
    return groups;
  }
  /// Of those the two payloads that gain most where they have been exchanged, of all that were told them or
  /// of one trial each.
  FoundPayload exchanged_among(const std::map<double, std::vector<TrialStretch>>& groups) const {
    FoundPayload best;
    for (auto light = groups.begin(); light != groups.end(); ++light) {
      for (auto heavy = std::next(light); heavy != groups.end(); ++heavy) {
        const double kg = heavy->first - light->first;
        take_better(found_exchanged(light->second, heavy->second, kg), best);
        for (const TrialStretch& of_light : light->second)
          for (const TrialStretch& of_heavy : heavy->second)
            take_better(found_exchanged({of_light}, {of_heavy}, kg), best);
      }
    }
    return best;
  }
  /// Sets of two trials and more, the smallest first; of very many only all.
  static std::vector<std::vector<TrialStretch>> several_of(const std::vector<TrialStretch>& trials) {
    if (trials.size() > kMostSets) return {trials};
    std::vector<std::vector<TrialStretch>> sets;
    for (std::size_t set = 1; set < std::size_t{1} << trials.size(); ++set) {
      std::vector<TrialStretch> some;
      for (std::size_t i = 0; i < trials.size(); ++i)
        if ((set >> i & 1U) != 0) some.push_back(trials[i]);
      if (some.size() > 1) sets.push_back(std::move(some));
    }
    std::stable_sort(sets.begin(), sets.end(),
                     [](const auto& a, const auto& b) { return a.size() < b.size(); });
    return sets;
  }
  /// Both have to say so.
  FoundPayload found_exchanged(const std::vector<TrialStretch>& light, std::vector<TrialStretch> heavy,
                               double kg) const {
    for (TrialStretch& stretch : heavy) stretch.sign = -1.0;
    std::vector<TrialStretch> where = light;
    where.insert(where.end(), heavy.begin(), heavy.end());
    FoundPayload both = found(std::move(where), kg);
    const double one = std::max(found(light, kg).gain.fall, found(std::move(heavy), kg).gain.fall);
    if (equations_.z(both.gain.fall - one, both.gain.fall) < kPolicy.told.least_z) return {};
    return both;
  }
  static void take_better(FoundPayload other, FoundPayload& best) {
    if (other.gain.fall > best.gain.fall) best = std::move(other);
  }

  static constexpr std::size_t kMostSets = 8;  // trials, of which all sets are looked at: 247
  const JointModel& model_;
  const double usual_kg_;
  const PayloadSumsOf sums_;
  PayloadEquations equations_;
  std::vector<bool> is_in_, is_all_in_;  ///< trials; all of which hangs as no other was told
  std::vector<OtherPayload> list_;
};

}  // namespace

ToldIn told_in(const TrialStretch& stretch, const model::TrialData& trial) {
  ToldIn told;
  double frames = 0.0;
  for (const bool with_hand : {false, true}) {
    for (std::size_t k = stretch.first; k < stretch.last; ++k) {
      const model::Block& block = trial.blocks[k];
      if (block.set_aside && !with_hand) continue;
      const auto of_block = trial.series.payload_kg.segment(static_cast<Index>(block.first),
                                                            static_cast<Index>(block.last - block.first));
      told.least = std::min(told.least, of_block.minCoeff());
      told.most = std::max(told.most, of_block.maxCoeff());
      told.mean += of_block.sum();
      frames += static_cast<double>(of_block.size());
    }
    if (frames > 0.0) break;  // else a hand was on it all the time
  }
  told.mean /= std::max(1.0, frames);
  return told;
}

double usual_payload_kg(const arm::Arm& arm, const std::vector<model::TrialData>& trials) {
  double heaviest = 0.0;
  for (const model::TrialData& trial : trials)
    heaviest = std::max(heaviest, trial.series.payload_kg.maxCoeff());
  return heaviest > 0.0 ? heaviest : kPolicy.experiment.payload_share * mass_kg(arm);
}

bool is_settled(const std::vector<OtherPayload>& before, const std::vector<OtherPayload>& after,
                double usual_kg) {
  if (after.size() != before.size()) return false;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double small_kg = std::max(kPolicy.told.settled * std::max(usual_kg, std::abs(after[i].more_kg)),
                                     kPolicy.told.settled_sd * after[i].sd_kg);
    if (std::abs(after[i].more_kg - before[i].more_kg) > small_kg) return false;
  }
  return true;
}

OtherPayloads other_payloads(JointModel& model, const Linearised& at, const std::vector<OtherPayload>& known,
                             double usual_kg) {
  // One trial alone says nothing that its own constants would not.
  if (model.trials().size() < 2 || !(usual_kg > 0.0)) return {};
  PayloadSearch search(model, at, usual_kg);
  for (const OtherPayload& payload : known) search.add(payload, 0.0);
  OtherPayloads found = search.all();
  if (is_settled(known, found.list, usual_kg)) {
    while (const std::optional<FoundPayload> next = search.next()) {
      search.add(next->payload, next->gain.more);
      OtherPayloads with = search.all();
      if (with.list.size() < search.size()) break;  // beside it one of them is next to nothing
      found = std::move(with);
    }
  }
  found.offset_m += offset_in(at);
  return found;
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
