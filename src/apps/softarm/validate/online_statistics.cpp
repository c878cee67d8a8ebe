#include "online_statistics.h"

#include <algorithm>
#include <cmath>

namespace softarm::app::validate {

OnlinePick online_fit(std::size_t method, std::size_t objective) {
  return [=](const OnlineFrame& f) -> const OnlineFit& { return f.fits[method][objective]; };
}

OnlineSummary summarise(const OnlineExperiment& sets, Load load, const OnlinePick& pick,
                        const std::function<double(const OnlineFit&)>& value) {
  std::vector<double> all, maxima;
  for (std::size_t r = 0; r < sets.front().unseen.size(); ++r) {
    double largest = 0.0;
    for (const OnlineSet& set : sets) {
      for (const auto& frames : set.datasets) {
        if ((frames[r].payload_kg > 0.0) != (load == Load::kLoaded)) continue;
        const OnlineFit& fit = pick(frames[r]);
        if (!fit.ok) continue;
        all.push_back(value(fit));
        largest = std::max(largest, value(fit));
      }
    }
    maxima.push_back(largest);
  }
  return {statistics(all), statistics(maxima).mean};
}

OnlineSpread spread(const OnlineExperiment& sets, const OnlinePick& pick) {
  std::vector<double> sds, maxima, relative, bias;
  for (std::size_t r = 0; r < sets.front().unseen.size(); ++r) {
    double largest = 0.0;
    for (const OnlineSet& set : sets) {
      std::vector<double> values;
      for (const auto& frames : set.datasets) {
        const OnlineFit& fit = pick(frames[r]);
        if (frames[r].payload_kg <= 0.0 || !fit.ok || !fit.bending_stiffness_nm2) continue;
        values.push_back(*fit.bending_stiffness_nm2);
        bias.push_back(*fit.bending_stiffness_nm2 / frames[r].true_stiffness_nm2 - 1.0);
      }
      if (values.size() < 2) continue;
      const Statistics s = statistics(values);
      sds.push_back(s.sd);
      relative.push_back(s.sd / s.mean);
      largest = std::max(largest, s.sd);
    }
    maxima.push_back(largest);
  }
  return {statistics(sds), statistics(relative), statistics(maxima).mean, statistics(bias)};
}

OnlineWeighing weighing(const OnlineExperiment& sets, std::size_t objective) {
  std::vector<double> grams, shares, maxima;
  for (std::size_t r = 0; r < sets.front().unseen.size(); ++r) {
    double largest = 0.0;
    for (const OnlineSet& set : sets) {
      const OnlineFrame& frame = set.unseen[r];
      const OnlineFit& fit = frame.weighed[objective];
      if (!fit.ok || !fit.payload_kg) continue;
      const double error = 1e3 * std::abs(*fit.payload_kg - frame.payload_kg);
      grams.push_back(error);
      shares.push_back(error / (10.0 * frame.payload_kg));
      largest = std::max(largest, error);
    }
    maxima.push_back(largest);
  }
  return {{statistics(grams), statistics(maxima).mean}, statistics(shares).mean};
}

}  // namespace softarm::app::validate
