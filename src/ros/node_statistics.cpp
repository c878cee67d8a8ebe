#include "node_statistics.h"

#include <algorithm>

namespace softarm {

void NodeStatistics::add(const estimate::Estimate& estimate, double latency_s, double solve_time_s,
                         const std::vector<std::string>& body_names) {
  ++period.frames;
  period.latency_s.push_back(latency_s);
  period.solve_time_s.push_back(solve_time_s);
  for (const estimate::BodyTooFar& far : estimate.too_far)
    period.too_far_m[body_names.at(static_cast<std::size_t>(far.body))] = far.distance_m;
  if (estimate.status != estimate::Status::kOk) {
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
  if (estimate.degrees_of_freedom > 0) period.reduced_chi_square.push_back(estimate.reduced_chi_square);
  period.rms_residual_m.push_back(estimate.rms_residual_m);
  period.identifiable_payload += estimate.identifiable_payload;
  period.identifiable_stiffness +=
      std::any_of(estimate.segments.begin(), estimate.segments.end(),
                  [](const estimate::SegmentEstimate& s) { return s.identifiable_stiffness; });
  period.worst_residual_m = 0.0;
  period.worst_body.clear();
  for (const estimate::BodyResidual& residual : estimate.residuals) {
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

std::uint64_t total(const std::map<std::string, std::uint64_t>& counts) {
  std::uint64_t sum = 0;
  for (const auto& entry : counts) sum += entry.second;
  return sum;
}

}  // namespace softarm
