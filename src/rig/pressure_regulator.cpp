// Error of the regulator, stiction of its valve, limit of its flow.
#include <algorithm>
#include <cmath>

#include "pressure_stages.h"

namespace softarm::rig {
namespace {

class Regulator : public PressureStage {
 public:
  explicit Regulator(const RegulatorError& spec) : spec_(spec) {}

  void start(Pressures& p) override {
    for (double& value : p) channels_.push_back({value += spec_.offset_pa, false});
  }

  void act(Pressures& p, double, double dt_s) override {
    const double reach = RegulatorError::kRatePaPerS * dt_s;
    for (std::size_t i = 0; i < p.size(); ++i) {
      Channel& c = channels_[i];
      const double target = p[i] + spec_.offset_pa;
      if (spec_.dead_band_pa <= 0.0) {
        c.pressure_pa = target;
      } else if (c.working = c.working || std::abs(target - c.pressure_pa) > spec_.dead_band_pa; c.working) {
        c.working = std::abs(target - c.pressure_pa) > reach;
        c.pressure_pa = std::clamp(target, c.pressure_pa - reach, c.pressure_pa + reach);
      }
      p[i] = c.pressure_pa;
    }
  }

 private:
  struct Channel {
    double pressure_pa;
    bool working;
  };
  RegulatorError spec_;
  std::vector<Channel> channels_;
};

class Stiction : public PressureStage {
 public:
  explicit Stiction(double step_pa) : step_pa_(step_pa) {}

  void start(Pressures& p) override { stuck_at_ = now_ = p; }

  void act(Pressures& p, double, double dt_s) override {
    constexpr double kSlipS = 0.02;  // time constant of a step
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (std::abs(p[i] - stuck_at_[i]) >= step_pa_) stuck_at_[i] = p[i];
      now_[i] += (stuck_at_[i] - now_[i]) * -std::expm1(-dt_s / kSlipS);
    }
    p = now_;
  }

 private:
  double step_pa_;
  Pressures stuck_at_, now_;
};

class Slew : public PressureStage {
 public:
  explicit Slew(const SlewLimit& spec) : spec_(spec) {}

  void start(Pressures& p) override { now_ = p; }

  void act(Pressures& p, double, double dt_s) override {
    for (std::size_t i = 0; i < p.size(); ++i)
      now_[i] = std::clamp(p[i], now_[i] - spec_.fall_pa_per_s * dt_s, now_[i] + spec_.rise_pa_per_s * dt_s);
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
