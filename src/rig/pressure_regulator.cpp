// Error of the regulator, stiction of its valve, limit of its flow.
#include <algorithm>
#include <cmath>
#include <limits>

#include "pressure_stages.h"

namespace softarm::rig {
namespace {

// What happens when a threshold is passed happens at its time within a step, so that the steps do not matter.

class Regulator : public PressureStage {
 public:
  explicit Regulator(const RegulatorError& spec) : spec_(spec) {}

  void start(Pressures& p) override {
    last_ = p;
    for (double& value : p) channels_.push_back({value += spec_.offset_pa, false});
  }

  void act(Pressures& p, double, double dt_s) override {
    const Pressures entered = p;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double target = p[i] + spec_.offset_pa;
      if (spec_.dead_band_pa <= 0.0)
        channels_[i].pressure_pa = target;
      else if (dt_s > 0.0)
        advance(channels_[i], last_[i] + spec_.offset_pa, target, dt_s);
      p[i] = channels_[i].pressure_pa;
    }
    last_ = entered;
  }

 private:
  struct Channel {
    double pressure_pa;
    bool working;
  };

  void advance(Channel& c, double from, double to, double dt_s) const {
    const double rate = (to - from) / dt_s;
    double left_s = dt_s;
    const auto error = [&] { return to - rate * left_s - c.pressure_pa; };
    while (left_s > 0.0) {
      const double now = error();
      if (!c.working) {
        const double beyond = std::abs(now + rate * left_s) - spec_.dead_band_pa;
        if (beyond <= 0.0) return;
        // It is outside at the end: it left the band that much before.
        left_s = std::min(left_s, rate != 0.0 ? beyond / std::abs(rate) : left_s);
        c.working = true;
      } else {
        const double speed = std::copysign(RegulatorError::kRatePaPerS, now);
        const double closing = std::abs(speed) - std::copysign(rate, rate * speed);
        const double meets_s =
            closing > 0.0 ? std::abs(now) / closing : std::numeric_limits<double>::infinity();
        const double works_s = std::min(left_s, meets_s);
        c.pressure_pa += speed * works_s;
        left_s -= works_s;
        c.working = meets_s > works_s;
        if (!c.working) c.pressure_pa = to - rate * left_s;
      }
    }
  }

  RegulatorError spec_;
  Pressures last_;
  std::vector<Channel> channels_;
};

class Stiction : public PressureStage {
 public:
  explicit Stiction(double step_pa) : step_pa_(step_pa) {}

  void start(Pressures& p) override { last_ = stuck_at_ = now_ = p; }

  void act(Pressures& p, double, double dt_s) override {
    for (std::size_t i = 0; dt_s > 0.0 && i < p.size(); ++i) {
      const double rate = (p[i] - last_[i]) / dt_s;
      double left_s = dt_s;
      // A billionth less than a step is one: sums of decimal numbers are not exact.
      while (std::abs(p[i] - stuck_at_[i]) >= step_pa_ * (1.0 - 1e-9)) {
        const double slips_at = stuck_at_[i] + std::copysign(step_pa_, p[i] - stuck_at_[i]);
        const double then_left_s = rate != 0.0 ? std::clamp((p[i] - slips_at) / rate, 0.0, left_s) : left_s;
        relax(i, left_s - then_left_s);
        left_s = then_left_s;
        stuck_at_[i] = slips_at;
      }
      relax(i, left_s);
    }
    last_ = p;
    p = now_;
  }

 private:
  void relax(std::size_t i, double for_s) {
    constexpr double kSlipS = 0.02;  // time constant of a step
    now_[i] += (stuck_at_[i] - now_[i]) * -std::expm1(-for_s / kSlipS);
  }

  double step_pa_;
  Pressures last_, stuck_at_, now_;
};

class Slew : public PressureStage {
 public:
  explicit Slew(const SlewLimit& spec) : spec_(spec) {}

  void start(Pressures& p) override { now_ = p; }

  void act(Pressures& p, double, double dt_s) override {
    double wanted = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) wanted += std::max(0.0, p[i] - now_[i]);
    const double granted = wanted > 0.0 ? std::min(1.0, spec_.rise_pa_per_s * dt_s / wanted) : 1.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double most = spec_.shared ? granted * std::max(0.0, p[i] - now_[i]) : spec_.rise_pa_per_s * dt_s;
      now_[i] = std::clamp(p[i], now_[i] - spec_.fall_pa_per_s * dt_s, now_[i] + most);
    }
    p = now_;
  }

 private:
  SlewLimit spec_;
  Pressures now_;
};

}  // namespace

void add_regulator(const Scenario& scenario, PressureStages& stages) {
  const InputPathSpec& spec = scenario.input_path;
  if (spec.regulator_error) stages.push_back(std::make_unique<Regulator>(*spec.regulator_error));
  if (spec.valve_step_pa > 0.0) stages.push_back(std::make_unique<Stiction>(spec.valve_step_pa));
  if (spec.slew_limit) stages.push_back(std::make_unique<Slew>(*spec.slew_limit));
}

}  // namespace softarm::rig
