// Equation (7) of the online paper as printed: the sum of c_i times the distance of point i, c_i = 1 / (i L).
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <utility>

#include "frames.h"

namespace softarm::estimate::testing {
namespace {

using Point = Eigen::Vector4d;  // M0 cos(phi), M0 sin(phi), EI, L, each over a typical value
const Point kUnit(0.1, 0.1, 0.01, 0.01);

/// Equation (7) at any parameters, by the statics alone.
class PrintedCost {
 public:
  PrintedCost(const arm::Arm& arm, const trial::Frame& frame, bool weights)
      : arm_(arm), frame_(frame), weights_(weights), maker_(arm) {}

  double weight(int body) const { return weights_ ? 1.0 / ((body + 1) * arm_.total_length_m()) : 1.0; }

  double operator()(const Point& x) {
    const Point v = x.cwiseProduct(kUnit);
    if (v[2] <= 1e-3 || v[3] <= 0.05) return 1e9;
    Truth truth{{{std::hypot(v[0], v[1]), std::atan2(v[1], v[0]), v[2], v[3]}},
                *frame_.payload_kg,
                *frame_.base_body};
    const std::optional<trial::Frame> model = maker_.make(truth);
    if (!model) return 1e9;
    double sum = 0.0;
    for (const trial::BodyObservation& seen : frame_.bodies) {
      const trial::BodyObservation& there = model->bodies[static_cast<std::size_t>(seen.body)];
      sum += weight(seen.body) * (seen.p_mocap - there.p_mocap).norm();
    }
    return sum;
  }

 private:
  const arm::Arm arm_;
  const trial::Frame frame_;
  const bool weights_;
  FrameMaker maker_;
};

/// Nelder and Mead's simplex, begun again from its best point until that no longer helps. It knows no
/// derivatives and nothing of the estimator.
Point minimise(const std::function<double(const Point&)>& f, Point best) {
  double before = f(best);
  for (int restart = 0; restart < 12; ++restart) {
    std::array<std::pair<double, Point>, 5> simplex;
    for (int i = 0; i < 5; ++i) {
      Point x = best;
      if (i < 4) x[i] += restart % 2 == 0 ? 0.2 : -0.05;
      simplex[static_cast<std::size_t>(i)] = {f(x), x};
    }
    const auto less = [](const auto& a, const auto& b) { return a.first < b.first; };
    for (int step = 0; step < 400; ++step) {
      std::sort(simplex.begin(), simplex.end(), less);
      if (simplex[4].first - simplex[0].first < 1e-12) break;
      Point centre = Point::Zero();
      for (std::size_t i = 0; i < 4; ++i) centre += 0.25 * simplex[i].second;
      const auto at = [&](double t) {
        const Point x = centre + t * (simplex[4].second - centre);
        return std::pair<double, Point>(f(x), x);
      };
      const auto reflected = at(-1.0);
      if (reflected.first < simplex[0].first) {
        simplex[4] = std::min(at(-2.0), reflected, less);
      } else if (reflected.first < simplex[3].first) {
        simplex[4] = reflected;
      } else {
        const auto contracted = at(reflected.first < simplex[4].first ? -0.5 : 0.5);
        if (contracted.first < simplex[4].first) {
          simplex[4] = contracted;
        } else {
          for (std::size_t i = 1; i < 5; ++i) {
            simplex[i].second = 0.5 * (simplex[i].second + simplex[0].second);
            simplex[i].first = f(simplex[i].second);
          }
        }
      }
    }
    std::sort(simplex.begin(), simplex.end(), less);
    best = simplex[0].second;
    if (before - simplex[0].first < 1e-9) break;
    before = simplex[0].first;
  }
  return best;
}

/// What was fitted. The estimate's EI and M0 are freed of their second-order bias, EI = EI_fit / (1 + (sd /
/// EI_fit)^2), which is undone here.
Point fitted_point(const estimate::SegmentEstimate& s) {
  double fitted = *s.bending_stiffness_nm2;
  for (int i = 0; i < 100; ++i) {
    const double relative_sd = s.sd_bending_stiffness_nm2.value() / upwards(s) / fitted;
    fitted = *s.bending_stiffness_nm2 * (1.0 + relative_sd * relative_sd);
  }
  const double moment = *s.actuation_curvature_per_m * fitted;
  return Point(moment * std::cos(*s.direction_rad), moment * std::sin(*s.direction_rad), fitted, *s.length_m)
      .cwiseQuotient(kUnit);
}

TEST(SumOfDistances, IsMinimisedWithThePapersWeights) {
  const arm::Arm arm = paper_arm();
  arm::EstimatorOptions options = with_method(arm::Method::kFullPoints);
  options.objective = arm::Objective::kSumOfDistances;
  estimate::Estimator estimator(arm, options);
  std::mt19937_64 random(5);
  double shift = 0.0;
  for (int i = 0; i < 6; ++i) {
    const Truth truth{{{0.3, 0.5 + i, 0.035, 0.2}}, 0.2, i % 2 == 0 ? hanging() : standing()};
    const trial::Frame frame = with_noise(arm, make_frame(arm, truth), random);
    estimator.reset();
    const estimate::Estimate& estimate = estimator.estimate(frame);
    ASSERT_EQ(estimate.status, estimate::Status::kOk) << estimate.detail;

    PrintedCost cost(arm, frame, true);
    const Point ours = fitted_point(estimate.segments[0]);
    const SegmentTruth& t = truth.segments[0];
    const Point start = Point(t.moment_nm * std::cos(t.direction_rad),
                              t.moment_nm * std::sin(t.direction_rad), t.bending_stiffness_nm2, t.length_m)
                            .cwiseQuotient(kUnit);
    const Point theirs = minimise(std::ref(cost), start);
    // Below 0.01 mm the distance is rounded to a parabola, which costs at most that much of each.
    double rounding = 0.0;
    for (int k = 0; k < 4; ++k) rounding += cost.weight(k) * 1e-5;
    EXPECT_LE(cost(ours), cost(theirs) + rounding);
    EXPECT_LE(cost(theirs), cost(start));

    // Without the weights the optimum lies elsewhere, well beyond what that rounding explains.
    PrintedCost unweighted(arm, frame, false);
    const Point elsewhere = minimise(std::ref(unweighted), start);
    shift += (cost(elsewhere) - cost(ours)) - 2.0 * std::abs(cost(ours) - cost(theirs));
  }
  EXPECT_GT(shift, 0.0);
}

TEST(SumOfDistances, RecoversTheTruth) {
  const arm::Arm arm = precisely_measured(paper_arm());
  arm::EstimatorOptions options = with_method(arm::Method::kFullPoints);
  options.objective = arm::Objective::kSumOfDistances;
  const Truth truth{{{0.3, -1.0, 0.035, 0.2}}, 0.2, hanging()};
  estimate::Estimator estimator(arm, options);
  expect_truth(estimator.estimate(make_frame(arm, truth)), truth, 1e-3);
  options.weights = arm::Weights::kNoise;
  estimate::Estimator by_noise(arm, options);
  expect_truth(by_noise.estimate(make_frame(arm, truth)), truth, 1e-3);
}

}  // namespace
}  // namespace softarm::estimate::testing
