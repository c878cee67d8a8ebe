// The paper's fit of its laws to three ground truths.
#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pull.h"

namespace softarm::published {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

double minimum(const std::vector<double>& list) {
  return *std::min_element(list.begin(), list.end());
}

double rms(const VectorXd& v) {
  return std::sqrt(v.squaredNorm() / static_cast<double>(v.size()));
}

}  // namespace

ThreeTruths fit_three_truths(const arm::Arm& arm, const std::vector<Pull>& pulls, LoadLaw law,
                             bool by_statics) {
  const arm::Segment& segment = arm.segments.front();
  const bool fits = arm.segments.size() == 1 && !segment.chambers.empty() && segment.tendons.empty() &&
                    segment.cables.empty() && !segment.central_chamber;
  if (!fits)
    throw std::invalid_argument("the three ground truths are of an arm of one segment with chambers alone");
  std::vector<const Pull*> used;
  std::vector<double> stiffness;
  for (const Pull& pull : pulls) {
    const auto& value = by_statics                 ? pull.stiffness_exact_nm2
                        : law == LoadLaw::kPrinted ? pull.stiffness_printed_nm2
                                                   : pull.stiffness_circles_nm2;
    if (!value) continue;
    used.push_back(&pull);
    stiffness.push_back(*value);
  }
  const auto rows = static_cast<Eigen::Index>(used.size());
  const auto chambers = static_cast<Eigen::Index>(segment.chambers.size());
  if (rows < chambers + 1 || rows < 3)
    throw std::invalid_argument(fmt::format("{} pulls identify a stiffness; the laws need {}", rows,
                                            std::max<Eigen::Index>(chambers + 1, 3)));
  const auto input = [&](const Pull& pull, const std::string& name) {
    for (std::size_t i = 0; i < arm.inputs.scalars.size() && i < pull.inputs.size(); ++i) {
      if (arm.inputs.scalars[i].name == name) return pull.inputs[i].value_or(0.0);
    }
    return 0.0;
  };
  MatrixXd pressures(rows, chambers), laws(rows, 3), gains(2 * rows, chambers);
  VectorXd lengths(rows), stiffnesses(rows), moments(2 * rows);
  const double weight_n = segment.mass_per_length_kg_m * segment.length_m * arm.gravity_m_s2.norm();
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Pull& pull = *used[static_cast<std::size_t>(i)];
    std::vector<double> p;
    double sum = 0.0;
    for (Eigen::Index k = 0; k < chambers; ++k) {
      const arm::Chamber& chamber = segment.chambers[static_cast<std::size_t>(k)];
      p.push_back(input(pull, chamber.input));
      sum += p.back();
      pressures(i, k) = p.back();
      gains(2 * i, k) = p.back() * std::cos(chamber.bending_direction_rad);
      gains(2 * i + 1, k) = p.back() * std::sin(chamber.bending_direction_rad);
    }
    const double vacuum = segment.jamming_input ? input(pull, *segment.jamming_input) : 0.0;
    laws.row(i) << 1.0, minimum(p), vacuum + sum / static_cast<double>(chambers);
    lengths[i] = pull.before.length_m - segment.length_m;
    stiffnesses[i] = stiffness[static_cast<std::size_t>(i)];
    // The moment that bends the arm to its circle, less what the loads there do. Hanging: down is along z.
    const double sign = pull.hanging ? -1.0 : 1.0;
    const double load =
        weight_turn_times_stiffness(pull.before, weight_n, law) +
        force_turn_times_stiffness(pull.before, pull.payload_before_kg * arm.gravity_m_s2.norm(), law);
    const double moment =
        (stiffnesses[i] * pull.before.angle_rad - (pull.upright ? sign * load : 0.0)) / pull.before.length_m;
    moments[2 * i] = moment * std::cos(pull.before.direction_rad);
    moments[2 * i + 1] = moment * std::sin(pull.before.direction_rad);
  }
  if (!segment.jamming_input) laws.col(2).setZero();
  const auto solve = [](const MatrixXd& a, const VectorXd& b, double* left) {
    // Columns differ by five orders of magnitude.
    const VectorXd size = a.colwise().norm().cwiseMax(1e-300);
    const VectorXd x = (a * size.cwiseInverse().asDiagonal()).completeOrthogonalDecomposition().solve(b);
    const VectorXd unscaled = x.cwiseQuotient(size);
    *left = rms(a * unscaled - b);
    return unscaled;
  };
  ThreeTruths result;
  result.arm = arm;
  result.pulls = used.size();
  const VectorXd a = solve(pressures, lengths, &result.length_rms_m);
  const VectorXd b = solve(laws, stiffnesses, &result.stiffness_rms_nm2);
  const VectorXd c = solve(gains, moments, &result.moment_rms_nm);
  arm::Segment& fitted = result.arm.segments.front();
  for (std::size_t k = 0; k < fitted.chambers.size(); ++k) {
    arm::Chamber& chamber = fitted.chambers[k];
    chamber.near_elongation_m_per_pa = a[static_cast<Eigen::Index>(k)] - chamber.far_elongation_m_per_pa;
    chamber.moment_gain_nm_per_pa = c[static_cast<Eigen::Index>(k)];
    // The paper's laws have none of these.
    chamber.saturation_per_pa.reset();
    chamber.stiffness_gain_nm2_per_pa.reset();
  }
  fitted.saturation.chambers_per_pa.reset();
  fitted.bending_stiffness.per_mean_pressure_nm2_per_pa.reset();
  fitted.bending_stiffness.base_nm2 = b[0];
  fitted.bending_stiffness.per_min_pressure_nm2_per_pa = b[1];
  fitted.bending_stiffness.per_jamming_pressure_nm2_per_pa = b[2];
  return result;
}

}  // namespace softarm::published
