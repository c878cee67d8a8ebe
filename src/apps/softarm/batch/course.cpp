#include "course.h"

#include <algorithm>

namespace softarm::app::batch {
namespace {

constexpr double kMostOfRunning = 0.95;  // a job that takes longer than it should is still not done

}  // namespace

Course::Course(const std::vector<double>& weights) {
  for (const double weight : weights) jobs_.push_back({weight, std::nullopt, false});
}

void Course::begin(std::size_t job, double now_s) {
  if (!jobs_[job].begun_s) jobs_[job].begun_s = now_s;
}

void Course::end(std::size_t job, double now_s) {
  State& state = jobs_[job];
  if (state.ended) return;
  state.ended = true;
  ++ended_;
  ended_weight_ += state.weight;
  if (!state.begun_s) return;  // it was too short to be seen running
  timed_weight_ += state.weight;
  timed_s_ += now_s - *state.begun_s;
}

double Course::done(double now_s) const {
  double done = ended_weight_;
  if (timed_s_ <= 0.0) return done;
  const double s_per_weight = timed_s_ / timed_weight_;
  for (const State& state : jobs_)
    if (state.begun_s && !state.ended)
      done += std::min((now_s - *state.begun_s) / s_per_weight, kMostOfRunning * state.weight);
  return done;
}

}  // namespace softarm::app::batch
