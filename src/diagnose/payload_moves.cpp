#include "payload_moves.h"

#include <utility>

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Something more hangs where the payload does, and off its axis. No effect of the arm, and of no catalogue:
/// what was told is wrong, in one trial or another.
class MorePayload : public model::Effect {
 public:
  const model::Info& info() const override { return info_; }
  bool varies_along() const override { return false; }
  bool drives() const override { return true; }
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
                          "the payload is larger than stated",
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

constexpr double kPayloadStep = 0.02;  // of the usual payload: a difference to first order
constexpr double kOffsetStep = 0.5;    // of the length, of such a payload

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

}  // namespace

PayloadSumsTo::PayloadSumsTo(const Linearised& at, const model::TrialData& trial, std::size_t t,
                             const MatrixXd& moves, double usual_kg)
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

void PayloadSumsTo::add_between(std::size_t first, std::size_t last, double sign, PayloadSums& sums) const {
  PayloadSums stretch = to_[last];
  stretch.mixed -= to_[first].mixed;
  stretch.score -= to_[first].score;
  stretch.own -= to_[first].own;
  stretch.with_told -= to_[first].with_told;
  sums.add(sign, stretch);
}

PayloadSumsOf::PayloadSumsOf(JointModel& model, const Linearised& at, double usual_kg)
    : constants_(at.gradient.size()) {
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

PayloadSums PayloadSumsOf::over(const std::vector<TrialStretch>& where) const {
  PayloadSums sums(constants_);
  for (const TrialStretch& one : where) trials_[one.trial].add_between(one.first, one.last, one.sign, sums);
  return sums;
}

ToldSums PayloadSumsOf::told() const {
  ToldSums sums(constants_);
  for (const PayloadSumsTo& trial : trials_) {
    sums.mixed += trial.told().mixed;
    sums.score += trial.told().score;
    sums.own += trial.told().own;
  }
  return sums;
}

}  // namespace softarm::diagnose
