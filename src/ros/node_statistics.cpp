#include "softarm/ros/node_statistics.h"

#include <algorithm>

namespace softarm {

void NodeStatistics::add(const Estimate& estimate, double latency_s, double solve_time_s,
                         const std::vector<std::string>& body_names) {
  ++period.frames;
  period.latency_s.push_back(latency_s);
  period.solve_time_s.push_back(solve_time_s);
  if (estimate.status != Status::kOk) {
    ++refused[to_string(estimate.status)];
    ++period.refused[to_string(estimate.status)];
    period.refused_detail = estimate.detail;
    return;
  }
  ++estimated;
  ++period.ok;
  period.iterations += static_cast<std::uint64_t>(std::max(0, estimate.solver.iterations));
  period.warm_starts += estimate.solver.warm_start;
  period.final_cost = estimate.solver.final_cost;
  if (estimate.degrees_of_freedom > 0) period.mismatch.push_back(estimate.mismatch);
  period.rms_residual_m.push_back(estimate.rms_residual_m);
  period.tells_payload += estimate.tells_payload;
  period.tells_stiffness += std::any_of(estimate.segments.begin(), estimate.segments.end(),
                                        [](const SegmentEstimate& s) { return s.tells_stiffness; });
  period.worst_residual_m = 0.0;
  period.worst_body.clear();
  for (const BodyResidual& residual : estimate.residuals) {
    if (!residual.used) {
      ++period.outliers;
      ++period.set_aside[body_names.at(static_cast<std::size_t>(residual.body))];
    }
    const double distance = (residual.measured_base - residual.estimated_base).norm();
    if (distance > period.worst_residual_m) {
      period.worst_residual_m = distance;
      period.worst_body = body_names.at(static_cast<std::size_t>(residual.body));
    }
  }
}

std::vector<std::string> NodeStatistics::Period::mostly_set_aside() const {
  std::vector<std::string> names;
  for (const auto& [name, count] : set_aside) {
    if (2 * count > ok) names.push_back(name);
  }
  return names;
}

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(p * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::uint64_t total(const std::map<std::string, std::uint64_t>& counts) {
  std::uint64_t sum = 0;
  for (const auto& entry : counts) sum += entry.second;
  return sum;
}

}  // namespace softarm
