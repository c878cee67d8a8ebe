// Delay, sag and ripple of what feeds the chambers.
#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "pressure_stages.h"
#include "random_stream.h"

namespace softarm::rig {
namespace {

constexpr std::uint64_t kRipplePurpose = 0x72697070;

class Delay : public PressureStage {
 public:
  explicit Delay(double delay_s) : delay_s_(delay_s) {}

  void start(Pressures& p) override { past_ = {{0.0, p}}; }

  void act(Pressures& p, double t_s, double dt_s) override {
    if (dt_s > 0.0) past_.push_back({t_s, p});
    const double then_s = t_s - delay_s_;
    while (past_.size() > 1 && past_[1].t_s <= then_s) past_.pop_front();
    const Instant& from = past_.front();
    p = from.p;
    if (past_.size() == 1 || then_s <= from.t_s) return;
    const Instant& to = past_[1];
    const double share = (then_s - from.t_s) / (to.t_s - from.t_s);
    for (std::size_t i = 0; i < p.size(); ++i) p[i] += share * (to.p[i] - from.p[i]);
  }

 private:
  struct Instant {
    double t_s;
    Pressures p;
  };
  double delay_s_;
  std::deque<Instant> past_;  ///< the first at or before what leaves now
};

class Droop : public PressureStage {
 public:
  explicit Droop(const SupplySag& spec) : spec_(spec) {}

  void start(Pressures& p) override { act(p, 0.0, 0.0); }

  void act(Pressures& p, double, double) override {
    const double sum = std::accumulate(p.begin(), p.end(), 0.0);
    for (double& own : p) {
      const double demand = std::max(0.0, sum - own) / spec_.reference_pa;
      own *= 1.0 - spec_.share * demand * demand / (1.0 + demand * demand);
    }
  }

 private:
  SupplySag spec_;
};

class Tank : public PressureStage {
 public:
  explicit Tank(const SupplySag& spec) : spec_(spec) {}

  void start(Pressures& p) override { last_ = p; }

  void act(Pressures& p, double, double dt_s) override {
    if (dt_s > 0.0) {
      double taken = 0.0;
      for (std::size_t i = 0; i < p.size(); ++i) taken += std::max(0.0, p[i] - last_[i]);
      missing_ = std::max(0.0, missing_ + taken - spec_.refill_pa_per_s * dt_s);
      last_ = p;
    }
    for (double& value : p) value *= 1.0 - spec_.share * std::min(1.0, missing_ / spec_.reference_pa);
  }

 private:
  SupplySag spec_;
  Pressures last_;
  double missing_ = 0.0;  ///< of the tank, Pa in sum of the chambers' pressures
};

class Ripple : public PressureStage {
 public:
  Ripple(const SupplyRipple& spec, std::uint64_t seed)
      : spec_(spec), begin_(RandomStream(seed, kRipplePurpose).uniform()) {}

  void start(Pressures& p) override { act(p, 0.0, 0.0); }

  void act(Pressures& p, double t_s, double) override {
    constexpr double kFalling = 0.8;  // of the period
    const double place = std::fmod(begin_ + t_s / spec_.period_s, 1.0);
    const double level =
        place < kFalling ? 1.0 - 2.0 * place / kFalling : -1.0 + 2.0 * (place - kFalling) / (1.0 - kFalling);
    for (double& value : p) value *= 1.0 + 0.5 * spec_.share * level;
  }

 private:
  SupplyRipple spec_;
  double begin_;  ///< of the period, where the trial begins
};

}  // namespace

void add_supply(const Scenario& scenario, PressureStages& stages) {
  const InputPathSpec& spec = scenario.input_path;
  if (spec.line_delay_s > 0.0) stages.push_back(std::make_unique<Delay>(spec.line_delay_s));
  if (spec.supply_sag && spec.supply_sag->form == SupplySag::Form::kDroop)
    stages.push_back(std::make_unique<Droop>(*spec.supply_sag));
  if (spec.supply_sag && spec.supply_sag->form == SupplySag::Form::kTank)
    stages.push_back(std::make_unique<Tank>(*spec.supply_sag));
  if (spec.supply_ripple) stages.push_back(std::make_unique<Ripple>(*spec.supply_ripple, scenario.seed));
}

}  // namespace softarm::rig
