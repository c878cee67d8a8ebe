#include "held_inputs.h"

#include <algorithm>
#include <vector>

namespace softarm::effects {
namespace {

constexpr double kLongest = 2.5;  // in rhythms, between samples that follow one another

}  // namespace

void straighten(const Eigen::VectorXd& t_s, Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> values) {
  struct Sample {
    double t_s, value;
  };
  std::vector<Sample> samples;
  std::vector<double> between_s;
  // A new value is from some time between the frame that shows it first and the one before.
  for (Eigen::Index i = 1; i < values.size(); ++i) {
    if (values[i] == values[i - 1]) continue;
    const double at_s = 0.5 * (t_s[i - 1] + t_s[i]);
    if (!samples.empty()) between_s.push_back(at_s - samples.back().t_s);
    samples.push_back({at_s, values[i]});
  }
  if (between_s.size() < 2) return;
  const auto middle = between_s.begin() + static_cast<std::ptrdiff_t>(between_s.size() / 2);
  std::nth_element(between_s.begin(), middle, between_s.end());
  const double rhythm_s = *middle;

  double before = values[0];
  std::size_t next = 0;  // the first sample after the frame
  double begin_s = samples.front().t_s - rhythm_s;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    while (next < samples.size() && samples[next].t_s <= t_s[i]) {
      before = samples[next].value;
      begin_s = samples[next].t_s;
      ++next;
      // Held until a sample of the same value, which the frames do not show.
      if (next < samples.size() && samples[next].t_s - begin_s > kLongest * rhythm_s)
        begin_s = samples[next].t_s - rhythm_s;
    }
    if (next == samples.size() || t_s[i] <= begin_s) {
      values[i] = before;
    } else {
      const double w = (t_s[i] - begin_s) / (samples[next].t_s - begin_s);
      values[i] = before + w * (samples[next].value - before);
    }
  }
}

}  // namespace softarm::effects
