#include "online_series.h"

#include <cmath>

namespace softarm::app::validate {
namespace {}  // namespace

Series online_frames_series(const std::vector<OnlineSetting>& settings,
                            const std::vector<OnlineExperiment>& experiments) {
  Series series{"online_frames",
                {"standing", "real_like", "set", "baseline_pa", "payload_kg", "tip_angle_rad", "true_EI",
                 "full_percent", "end_percent", "cc_points_percent", "cc_end_percent", "full_EI", "end_EI",
                 "full_EI_least_squares", "printed_EI", "identifiable_EI"},
                {}};
  for (std::size_t k = 0; k < experiments.size(); ++k) {
    for (std::size_t i = 0; i < experiments[k].size(); ++i) {
      for (const auto& frames : experiments[k][i].datasets) {
        for (const OnlineFrame& f : frames) {
          const auto ei = [](const OnlineFit& fit) { return fit.bending_stiffness_nm2.value_or(NAN); };
          const auto error = [&](std::size_t m) {
            return f.fits[m][kPrinted].ok ? f.fits[m][kPrinted].error_percent : NAN;
          };
          series.rows.push_back(
              {settings[k].standing ? 1.0 : 0.0, settings[k].quality == Quality::kRealLike ? 1.0 : 0.0,
               static_cast<double>(i + 1), experiments[k][i].baseline_pa, f.payload_kg, f.tip_angle_rad,
               f.true_stiffness_nm2, error(0), error(1), error(2), error(3), ei(f.fits[0][kPrinted]),
               ei(f.fits[1][kPrinted]), ei(f.fits[0][kSquares]), ei(f.printed),
               f.fits[0][kSquares].identifiable ? 1.0 : 0.0});
        }
      }
    }
  }
  return series;
}

Series online_payload_series(const std::vector<OnlineSetting>& settings,
                             const std::vector<OnlineExperiment>& experiments) {
  Series series{"online_payload",
                {"standing", "real_like", "set", "payload_kg", "estimated_kg", "least_squares_kg"},
                {}};
  for (std::size_t k = 0; k < experiments.size(); ++k) {
    for (std::size_t i = 0; i < experiments[k].size(); ++i) {
      for (const OnlineFrame& f : experiments[k][i].unseen)
        series.rows.push_back(
            {settings[k].standing ? 1.0 : 0.0, settings[k].quality == Quality::kRealLike ? 1.0 : 0.0,
             static_cast<double>(i + 1), f.payload_kg, f.weighed[kPrinted].payload_kg.value_or(NAN),
             f.weighed[kSquares].payload_kg.value_or(NAN)});
    }
  }
  return series;
}

}  // namespace softarm::app::validate
