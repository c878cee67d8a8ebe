#include <algorithm>
#include <thread>

#include "engine.h"
#include "interrupt.h"
#include "math/parallel.h"
#include "run_job.h"

namespace softarm::app::batch {

void run_local(const Run& run) {
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const auto count = static_cast<unsigned>(std::max<std::size_t>(1, run.jobs.size()));
  const unsigned at_a_time = std::min(count, run.at_a_time != 0 ? run.at_a_time : cores);
  const unsigned threads = run.threads != 0 ? run.threads : std::max(1U, cores / at_a_time);
  math::in_parallel(run.jobs.size(), at_a_time, [&](std::size_t i) {
    if (signal_kept() != 0) return;
    run.on_begin(i);
    const std::optional<Outcome> outcome = run_job(run.jobs[i], run.program, threads, [&] {
      run.on_tick();
      return signal_kept() != 0;
    });
    if (outcome) run.on_end(i, *outcome);
  });
}

}  // namespace softarm::app::batch
