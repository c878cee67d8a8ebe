// What the node counts, since its start and since the last look.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "softarm/estimate/estimator.h"

namespace softarm {

/// Counters of the node, and samples of the last diagnostics period.
struct NodeStatistics {
  std::uint64_t estimated = 0;                   ///< estimates published with status ok
  std::map<std::string, std::uint64_t> refused;  ///< estimates published with another status, by status
  std::map<std::string, std::uint64_t> dropped;  ///< frames without any message, by reason
  std::map<std::string, std::uint64_t> lost;  ///< messages that never arrived, by topic (gaps in header.seq)
  std::uint64_t not_finite_messages = 0;      ///< messages held back because a number was not finite

  /// Of one period.
  struct Period {
    std::uint64_t frames = 0;
    std::uint64_t ok = 0;
    std::map<std::string, std::uint64_t> refused;
    std::string refused_detail;  ///< the newest one
    std::vector<double> latency_s, solve_time_s, reduced_chi_square, rms_residual_m;
    std::uint64_t iterations = 0, warm_starts = 0, identifiable_stiffness = 0, identifiable_payload = 0,
                  outliers = 0;
    double final_cost = 0.0;
    std::map<std::string, std::uint64_t> set_aside;  ///< estimates without this body, an outlier
    std::map<std::string, double> too_far_m;  ///< bodies too far from the base to be used: how far at last
    std::string worst_body;                   ///< body with the largest residual of the newest estimate
    double worst_residual_m = 0.0;
    /// Bodies that were outliers in most of the estimates: not bad luck, but a wrong arm file or ring.
    std::vector<std::string> mostly_set_aside() const;
  } period;

  void add(const estimate::Estimate& estimate, double latency_s, double solve_time_s,
           const std::vector<std::string>& body_names);
};

std::uint64_t total(const std::map<std::string, std::uint64_t>& counts);

}  // namespace softarm
