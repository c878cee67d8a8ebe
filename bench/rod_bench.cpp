// Static solves of the paper's arm with payload, weight and the derivatives that a fit asks for.
#include <benchmark/benchmark.h>

#include <chrono>

#include "frames.h"

namespace softarm::bench {
namespace {

std::vector<rod::Parameter> fit_parameters() {
  return {{rod::ParameterKind::kMoment, 0, 0},
          {rod::ParameterKind::kMoment, 0, 1},
          {rod::ParameterKind::kBendingCompliance, 0, 0},
          {rod::ParameterKind::kLength, 0, 0}};
}

/// Solves `rods` in turn. @param warm from the last one's tip; else from nothing
void solve_all(benchmark::State& state, const std::vector<rod::Rod>& rods, bool warm,
               double position_tolerance) {
  rod::SolverOptions options;
  options.position_tolerance = position_tolerance;
  options.linear_correction_rad = 1e-4;  // as the fit has it: positions are exact to its square
  rod::Solver solver(rods[0], {0.05, 0.1, 0.15, 0.2}, fit_parameters(), options);
  if (solver.solve(rods.back()) != rod::SolveStatus::kConverged) {
    state.SkipWithError("no equilibrium");
    return;
  }
  Times times;
  double sweeps = 0.0;
  std::size_t i = 0;
  for (auto _ : state) {
    const rod::Rod& rod = rods[i];
    const auto start = std::chrono::steady_clock::now();
    const rod::SolveStatus status =
        warm ? solver.solve(rod, Eigen::Quaterniond(solver.q_tip()), &rods[i == 0 ? rods.size() - 1 : i - 1])
             : solver.solve(rod);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (status != rod::SolveStatus::kConverged) {
      state.SkipWithError("no equilibrium");
      return;
    }
    benchmark::DoNotOptimize(solver.dp(3).data());
    state.SetIterationTime(seconds);
    times.add(seconds);
    sweeps += solver.sweeps();
    i = (i + 1) % rods.size();
  }
  state.counters["median_us"] = times.quantile_us(0.5);
  state.counters["p99_us"] = times.quantile_us(0.99);
  state.counters["sweeps"] = sweeps / static_cast<double>(state.iterations());
}

std::vector<rod::Rod> random_rods() {
  const arm::Arm arm = paper_arm();
  std::mt19937_64 random(7);
  std::vector<rod::Rod> rods;
  rod::Solver solver(rod::make_rod(arm), {0.2}, {});
  while (rods.size() < 500) {
    const rod::Rod rod = rod_of(arm, random_truth(random), {0.0, 0.0, 9.81});
    if (solver.solve(rod) != rod::SolveStatus::kConverged) continue;
    if ((solver.station(0).q * Eigen::Vector3d::UnitZ()).z() < std::cos(2.6)) continue;
    rods.push_back(rod);
  }
  return rods;
}

std::vector<rod::Rod> moving_rods() {
  const arm::Arm arm = paper_arm();
  std::vector<rod::Rod> rods;
  for (int i = 0; i < 2000; ++i) rods.push_back(rod_of(arm, moving_truth(i), {0.0, 0.0, 9.81}));
  return rods;
}

/// From nothing: by continuation from the unloaded rod.
void static_solve(benchmark::State& state) {
  solve_all(state, random_rods(), false, 1e-6);
}
BENCHMARK(static_solve)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

/// Along a motion at 120 Hz.
void static_solve_warm(benchmark::State& state) {
  solve_all(state, moving_rods(), true, 1e-6);
}
BENCHMARK(static_solve_warm)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

}  // namespace
}  // namespace softarm::bench
