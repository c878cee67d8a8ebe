#include "rig_accuracy/effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <optional>
#include <stdexcept>

#include "rig_accuracy/hosts.h"
#include "rig_accuracy/paths.h"

namespace softarm::rig_accuracy {
namespace {

constexpr double kSlowest = 10.0;      // multiples of real time
constexpr double kArmMoves_mm = 0.01;  // less is nothing
constexpr double kLeastFrames = 1e-3;  // share that must differ
constexpr double kSame = 1e-5;         // of anything measured: m, rad, s, N, and of pressures per Pa
constexpr int kFinerStep = 4, kFinerElements = 2;

/// A run with the scenario's own numerics.
struct Run {
  std::vector<rig::Sample> samples;
  Path path;
  double speed = 0.0;
};

Run run(const rig::Scenario& scenario) {
  Run result;
  const std::clock_t begin = std::clock();
  rig::Simulator simulator(scenario);
  while (auto sample = simulator.next()) result.samples.push_back(std::move(*sample));
  const double busy_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  result.speed = scenario.duration_s / std::max(busy_s, 1e-6);
  for (const rig::Sample& sample : result.samples) result.path.push_back(rings_of(sample));
  return result;
}

bool same(double a, double b, double scale = 1.0) {
  return std::abs(a - b) <= kSame * scale;
}

bool same(const std::optional<rig::Pose>& a, const std::optional<rig::Pose>& b) {
  if (!a || !b) return !a && !b;
  return (a->p - b->p).norm() <= kSame && (a->q.coeffs() - b->q.coeffs()).norm() <= kSame;
}

bool same(const rig::InputSample& a, const rig::InputSample& b) {
  const bool pressure = a.kind == rig::InputKind::kChamber || a.kind == rig::InputKind::kVacuum;
  return a.kind == b.kind && a.number == b.number && same(a.stamp_s, b.stamp_s) &&
         same(a.receipt_s, b.receipt_s) && same(a.value, b.value, pressure ? 1e5 : 1.0);
}

/// Whether all that a frame sends is the same.
bool same(const rig::Sample& a, const rig::Sample& b) {
  if (a.mocap_copies != b.mocap_copies || !same(a.mocap_stamp_s, b.mocap_stamp_s) ||
      !same(a.mocap_receipt_s, b.mocap_receipt_s) || a.payload.has_value() != b.payload.has_value() ||
      (a.payload && !same(a.payload->kg, b.payload->kg)))
    return false;
  const auto equal = [](const auto& x, const auto& y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(),
                      [](const auto& one, const auto& other) { return same(one, other); });
  };
  return equal(a.bodies, b.bodies) && equal(a.inputs, b.inputs);
}

double changed(const std::vector<rig::Sample>& a, const std::vector<rig::Sample>& b) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < a.size(); ++k) count += same(a[k], b[k]) ? 0 : 1;
  return static_cast<double>(count) / static_cast<double>(a.size());
}

/// Errors of step and elements.
struct Numerics {
  Errors step, elements;
  double worst() const { return step.worst + elements.worst; }
};

Numerics numerics(const rig::Scenario& scenario, const Path& path) {
  const int n = scenario.numerics.elements;
  const double step_s = step_of(scenario), seconds = scenario.duration_s;
  return {compare(path, rings(scenario, seconds, n, step_s / kFinerStep)),
          compare(path, rings(scenario, seconds, kFinerElements * n, step_s))};
}

/// Azimuth towards which the tip is when it is farthest from the axis, deg in [0, 360).
double farthest_deg(const Path& path) {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  for (const auto& rings : path)
    if (rings.back().head<2>().norm() > tip.head<2>().norm()) tip = rings.back();
  const double deg = std::atan2(tip.y(), tip.x()) * 180.0 / M_PI;
  return deg < 0.0 ? deg + 360.0 : deg;
}

/// A scenario with nothing hidden.
struct Host {
  rig::Scenario scenario;
  Run ideal;
  double towards_deg = 0.0;
};

void print(const std::string& effect, const std::string& form, const std::string& scenario,
           const std::optional<Numerics>& errors, double arm_mm, double frames, double speed) {
  const std::string cells =
      errors ? fmt::format("{:.3g},{:.3g},{:.3g},{:.3g}", errors->step.worst, errors->step.rms(),
                           errors->elements.worst, errors->elements.rms())
             : ",,,";
  fmt::print("{},{},{},{},{:.3g},{:.3g},{:.3g}\n", effect, form, scenario, cells, arm_mm, frames, speed);
  std::fflush(stdout);
}

/// One form of an effect in the first host that takes it. @return whether all is well
bool measure(const rig::HiddenEffect& effect, const std::string& form, const std::vector<Host>& hosts) {
  for (const Host& host : hosts) {
    const auto scenario = hidden_in(host.scenario, usual_choice(effect, form, host.towards_deg));
    if (!scenario) continue;
    const Run with = run(*scenario);
    const double arm_mm = compare(with.path, host.ideal.path).worst;
    const double frames = changed(with.samples, host.ideal.samples);
    std::optional<Numerics> errors;
    if (arm_mm > 0.0) errors = numerics(*scenario, with.path);
    print(effect.id, form, scenario->name, errors, arm_mm, frames, with.speed);
    const bool acts = (arm_mm == 0.0 || arm_mm > kArmMoves_mm) && frames > kLeastFrames;
    const bool exact = !errors || errors->worst() < kAllowed_mm;
    const bool fast = with.speed >= kSlowest;
    fmt::print(stderr, "{}  {} {}: {}, error {:.4f} mm, {:.0f} x real time\n",
               acts && exact && fast ? "PASS" : "FAIL", effect.id, form,
               arm_mm > 0.0 ? fmt::format("moves the arm by {:.2f} mm", arm_mm)
                            : fmt::format("changes {:.1f} % of the frames", 100.0 * frames),
               errors ? errors->worst() : 0.0, with.speed);
    return acts && exact && fast;
  }
  throw std::runtime_error(fmt::format("effect {} {}: no scenario takes it", effect.id, form));
}

}  // namespace

int measure_effects(const EffectsOptions& options) {
  const std::vector<std::string>& only = options.only;
  for (const std::string& id : only)
    if (!rig::find_hidden_effect(id))
      throw std::invalid_argument(
          fmt::format("--only: value {}, allowed are the ids that softarm simulate --effects lists", id));
  fmt::print(
      "effect,form,scenario,step_worst_mm,step_rms_mm,elements_worst_mm,elements_rms_mm,arm_mm,frames,"
      "speed\n");
  std::vector<Host> all;
  for (const rig::Scenario& scenario : hosts(options.config, options.seconds)) {
    Host host{scenario, run(scenario), 0.0};
    host.towards_deg = farthest_deg(host.ideal.path);
    print("ideal", "", scenario.name, numerics(scenario, host.ideal.path), 0.0, 0.0, host.ideal.speed);
    all.push_back(std::move(host));
  }
  bool good = true;
  for (const rig::HiddenEffect& effect : rig::hidden_effects()) {
    if (!only.empty() && std::find(only.begin(), only.end(), effect.id) == only.end()) continue;
    const std::vector<std::string> forms = effect.forms.empty() ? std::vector<std::string>{""} : effect.forms;
    for (const std::string& form : forms) good = measure(effect, form, all) && good;
  }
  return good ? 0 : 1;
}

}  // namespace softarm::rig_accuracy
