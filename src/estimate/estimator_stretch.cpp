// Step 4b: what is not known of the axial stiffness.
#include <algorithm>
#include <cmath>

#include "estimator_impl.h"

namespace softarm::estimate {
namespace {

constexpr int kStretchPoints = 4;     // of each segment: the force is linear along it but for the payload
constexpr double kSameSpread = 0.02;  // relative change of a length's sd that is not worth another fit
constexpr int kMostRounds = 8;        // each shrinks the change by how little the laws say of the length

}  // namespace

std::vector<double> Estimator::Impl::stretch_by_loads() const {
  const rod::Rod& rod = problem.rod();
  const rod::PointLoad& payload = rod.loads[rod::kPayloadLoad];
  // Beyond its range the payload will be held at the limit.
  const double beyond_kg =
      std::clamp(payload.mass_kg, arm.payload.range_kg.low, arm.payload.range_kg.high) - payload.mass_kg;
  std::vector<double> list;
  double begin = 0.0;
  for (const rod::Segment& segment : rod.segments) {
    double sum = 0.0;
    for (int k = 0; k < kStretchPoints && segment.axial_compliance > 0.0; ++k) {
      const double s = begin + segment.rest_length_m * (k + 0.5) / kStretchPoints;
      const rod::RodState state = problem.solver().at(s);
      sum += state.v.z() - 1.0;
      if (s < payload.s_m)
        sum +=
            segment.axial_compliance * beyond_kg * rod.gravity_m_s2.dot(state.q * Eigen::Vector3d::UnitZ());
    }
    list.push_back(segment.length_m * sum / kStretchPoints);
    begin += segment.rest_length_m;
  }
  return list;
}

bool Estimator::Impl::allow_for_stretch() {
  const arm::LawPrior& prior = options.prior;
  if (!prior.enabled || is_constant_curvature(options.method)) return true;
  const auto spread = [&](double stretch) {
    return std::hypot(prior.length_sd_m, prior.axial_stiffness_sd_rel * stretch);
  };
  for (int round = 0; round < kMostRounds; ++round) {
    const std::vector<double> now = stretch_by_loads();
    bool same = true;
    for (std::size_t i = 0; i < now.size(); ++i)
      same = same && std::abs(spread(now[i]) / spread(stretch_m[i]) - 1.0) < kSameSpread;
    if (same) break;
    stretch_m = now;
    allow_for_axial_stiffness(prior, stretch_m, law);
    believe();
    problem.begin();
    if (!problem.evaluate(x) || !minimise()) {
      have_last = false;
      fail(Status::kNoConvergence, "the fit was lost when the uncertainty of EA was allowed for");
      return false;
    }
    refresh_covariance();
  }
  return true;
}

}  // namespace softarm::estimate
