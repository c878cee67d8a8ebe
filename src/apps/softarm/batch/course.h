// How far a batch is, the jobs that run included.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace softarm::app::batch {

/// A job that runs counts by its time against that of the jobs that have ended, of its weight. Without it a
/// few jobs, several at a time, would seem to be far less done than they are.
class Course {
 public:
  /// @param weights of the jobs: what they cost goes by it
  explicit Course(const std::vector<double>& weights);

  void begin(std::size_t job, double now_s);
  void end(std::size_t job, double now_s);
  /// In the unit of the weights; none of the running jobs is ever counted as whole.
  double done(double now_s) const;
  std::size_t ended() const { return ended_; }

 private:
  struct State {
    double weight = 0.0;
    std::optional<double> begun_s;
    bool ended = false;
  };
  std::vector<State> jobs_;
  std::size_t ended_ = 0;
  double ended_weight_ = 0.0, timed_weight_ = 0.0, timed_s_ = 0.0;
};

}  // namespace softarm::app::batch
