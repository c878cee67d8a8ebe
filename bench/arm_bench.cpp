// Static solves of every arm that ships, from its inputs: the laws, then the rod from nothing with the
// derivatives that a fit asks for. One benchmark per arm file: static_solve_<arm>.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

#include "frames.h"
#include "softarm/arm/arm_file.h"
#include "softarm/arm/laws.h"

namespace softarm::bench {
namespace {

/// A value that such an input takes in the papers' experiments.
double random_value(arm::InputKind kind, std::mt19937_64& random) {
  const auto uniform = [&](double high) { return std::uniform_real_distribution<double>(0.0, high)(random); };
  switch (kind) {
    case arm::InputKind::kPressure:
      return uniform(40e3);
    case arm::InputKind::kVacuum:
      return uniform(1.0) < 0.5 ? 0.0 : 60e3;
    case arm::InputKind::kTension:
      return uniform(3.0);
    case arm::InputKind::kAngle:
      return uniform(0.7);
  }
  return 0.0;
}

/// Half of them hang, half are clamped level.
std::vector<rod::Rod> random_rods(const arm::Arm& arm) {
  std::mt19937_64 random(11);
  rod::Rod rod = rod::make_rod(arm);
  rod::Solver solver(rod, {arm.total_length_m()}, {});
  std::vector<rod::Rod> rods;
  for (int tries = 0; rods.size() < 300 && tries < 5000; ++tries) {
    arm::InputValues inputs;
    for (const arm::ScalarInput& input : arm.inputs.scalars)
      inputs.emplace_back(random_value(input.kind, random));
    const auto laws = predict(arm, inputs);
    if (!laws) continue;
    rod::actuate(arm, *laws, rod);
    rod.gravity_m_s2 = tries % 2 == 0 ? Eigen::Vector3d(0.0, 0.0, 9.81) : Eigen::Vector3d(-9.81, 0.0, 0.0);
    rod.loads[rod::kPayloadLoad].mass_kg =
        std::uniform_real_distribution<double>(0.0, 0.2 * arm.payload.range_kg.high)(random);
    if (solver.solve(rod) == rod::SolveStatus::kConverged && solver.stable()) rods.push_back(rod);
  }
  return rods;
}

void static_solve(benchmark::State& state, const arm::Arm& arm) {
  const std::vector<rod::Rod> rods = random_rods(arm);
  if (rods.size() < 100) {
    state.SkipWithError("too few equilibria");
    return;
  }
  std::vector<double> stations;
  for (const arm::MeasuredBody& body : arm.bodies) stations.push_back(body.arclength_m);
  std::vector<rod::Parameter> parameters;
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    parameters.push_back({rod::ParameterKind::kMoment, i, 0});
    parameters.push_back({rod::ParameterKind::kMoment, i, 1});
    parameters.push_back({rod::ParameterKind::kBendingCompliance, i, 0});
    parameters.push_back({rod::ParameterKind::kLength, i, 0});
  }
  rod::SolverOptions options;
  options.position_tolerance = 1e-6;
  options.linear_correction_rad = 1e-4;  // as the fit has it: positions are exact to its square
  rod::Solver solver(rods[0], stations, parameters, options);
  Times times;
  std::size_t i = 0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    const rod::SolveStatus status = solver.solve(rods[i]);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (status != rod::SolveStatus::kConverged) {
      state.SkipWithError("no equilibrium");
      return;
    }
    benchmark::DoNotOptimize(solver.dp(0).data());
    state.SetIterationTime(seconds);
    times.add(seconds);
    i = (i + 1) % rods.size();
  }
  state.counters["median_us"] = times.quantile_us(0.5);
  state.counters["p99_us"] = times.quantile_us(0.99);
}

const bool kRegistered = [] {
  const std::vector<std::string> folders{std::string(SOFTARM_SOURCE_DIR) + "/config/arms"};
  for (const std::string& name : arm::arm_names(folders)) {
    const arm::Arm arm = arm::load_arm_file(name, folders);
    benchmark::RegisterBenchmark(("static_solve_" + name).c_str(),
                                 [arm](benchmark::State& state) { static_solve(state, arm); })
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond)
        ->MinTime(0.5);
  }
  return true;
}();

}  // namespace
}  // namespace softarm::bench
