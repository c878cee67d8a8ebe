#include "laws.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "law_departures.h"

namespace softarm::rig {
namespace {

constexpr double kLeastStretch = 0.1, kMostStretch = 20.0;

Eigen::Vector2d towards(double azimuth_rad) {
  return {std::cos(azimuth_rad), std::sin(azimuth_rad)};
}

double at(const std::vector<double>& values, int input) {
  return values.at(static_cast<std::size_t>(input));
}

double interpolated(const std::vector<StiffnessAtPressure>& knots, double pressure_pa) {
  if (pressure_pa <= knots.front().pressure_pa) return knots.front().bending_stiffness_nm2;
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const StiffnessAtPressure &from = knots[i - 1], &to = knots[i];
    if (pressure_pa <= to.pressure_pa)
      return from.bending_stiffness_nm2 + (to.bending_stiffness_nm2 - from.bending_stiffness_nm2) *
                                              (pressure_pa - from.pressure_pa) /
                                              (to.pressure_pa - from.pressure_pa);
  }
  return knots.back().bending_stiffness_nm2;
}

/// Share of what an actuator would do in proportion.
double share_at(const SaturationSpec& law, double z) {
  if (!(z > 0.0)) return 1.0;
  return law.exponential ? -std::expm1(-z) / z : 1.0 / (1.0 + z);
}

double over(double x, const std::optional<double>& saturation) {
  return saturation ? x / *saturation : 0.0;
}

/// Sums of what drives a segment, each not below zero.
struct Sums {
  Sums(const SegmentSpec& segment, const Acting& acting) {
    for (const ChamberSpec& one : segment.chambers)
      pressures_pa += std::max(0.0, at(acting.pressures_pa, one.input));
    for (const TendonSpec& one : segment.tendons) tensions_n += at(acting.tensions_n, one.input);
    for (const CableSpec& one : segment.cables) angles_rad += std::abs(at(acting.angles_rad, one.input));
  }
  double pressures_pa = 0.0, tensions_n = 0.0, angles_rad = 0.0;
};

/// The sum of what `size` says of each; the lowest of them; or that of the one.
template <typename Items, typename Size>
double grows_with(const StiffnessGrowth& growth, const Items& items, const Size& size) {
  double sum = 0.0, lowest = std::numeric_limits<double>::max(), one = 0.0;
  for (const auto& item : items) {
    const double x = size(item.input);
    sum += x;
    lowest = std::min(lowest, x);
    if (item.input == growth.input) one = x;
  }
  if (growth.by == StiffnessGrowth::By::kOne) return one;
  return growth.by == StiffnessGrowth::By::kLowest ? lowest : sum;
}

double growth_nm2(const SegmentSpec& segment, const Acting& acting) {
  double sum_nm2 = 0.0;
  for (const StiffnessGrowth& growth : segment.stiffness_growth) {
    double x = 0.0;
    switch (growth.of) {
      case StiffnessGrowth::Of::kPressures:
        x = grows_with(growth, segment.chambers,
                       [&](int i) { return std::max(0.0, at(acting.pressures_pa, i)); });
        if (growth.by == StiffnessGrowth::By::kTogether) x /= static_cast<double>(segment.chambers.size());
        break;
      case StiffnessGrowth::Of::kTensions:
        x = grows_with(growth, segment.tendons, [&](int i) { return at(acting.tensions_n, i); });
        break;
      case StiffnessGrowth::Of::kAngles:
        x = grows_with(growth, segment.cables, [&](int i) { return std::abs(at(acting.angles_rad, i)); });
        break;
    }
    sum_nm2 += growth.added_nm2 * std::pow(std::max(0.0, x) / growth.at, growth.exponent);
  }
  return sum_nm2;
}

}  // namespace

std::optional<WallStretch> wall_stretch(double force_n, double axial_stiffness_n,
                                        const std::optional<MaterialSpec>& material) {
  const double strain = force_n / axial_stiffness_n;
  if (!material) return 1.0 + strain > 0.0 ? std::optional(WallStretch{1.0 + strain, 1.0}) : std::nullopt;
  const double a = material->c10_pa / (material->c10_pa + material->c01_pa) / 3.0;
  const double b = material->c01_pa / (material->c10_pa + material->c01_pa) / 3.0;
  const auto stress = [&](double x) { return (a + b / x) * (x - 1.0 / (x * x)); };
  const auto modulus = [&](double x) { return a * (1.0 + 2.0 / (x * x * x)) + 3.0 * b / (x * x * x * x); };
  // From the unstretched state outwards, as the load would grow: the stable branch ends where the modulus
  // does.
  const double step = strain < 0.0 ? 0.995 : 1.005;
  double inner = 1.0, outer = 1.0;
  while ((stress(outer) - strain) * strain < 0.0) {
    inner = outer;
    outer *= step;
    if (!(modulus(outer) > 0.0) || outer < kLeastStretch || outer > kMostStretch) return std::nullopt;
  }
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (inner + outer);
    ((stress(middle) - strain) * strain < 0.0 ? inner : outer) = middle;
  }
  return WallStretch{outer, modulus(outer)};
}

Actuation apply_laws(const SegmentSpec& segment, const Acting& acting, const LawSpec& hidden) {
  const LawDepartures departures(segment, acting, hidden);
  const Sums sums(segment, acting);
  const SaturationSpec& saturation = segment.saturation;
  Actuation actuation;
  double length_m = segment.length_m;
  double least_pa = 0.0, mean_pa = 0.0;
  for (const ChamberSpec& chamber : segment.chambers) {
    const double p = at(acting.pressures_pa, chamber.input);
    least_pa = &chamber == &segment.chambers.front() ? p : std::min(least_pa, p);
    mean_pa += p / static_cast<double>(segment.chambers.size());
    const double share = share_at(saturation, over(std::max(0.0, p), chamber.saturation_pa) +
                                                  over(sums.pressures_pa, saturation.chambers_pa));
    actuation.moment_nm += share * chamber.moment_gain_nm_per_pa * departures.moment_pressure_pa(chamber) *
                           towards(departures.azimuth_rad(chamber.direction_rad));
    length_m += (chamber.near_elongation_m_per_pa + chamber.far_elongation_m_per_pa) * p;
  }

  double force_n = 0.0, twist_stiffness_nm2 = 0.0;
  for (const TendonSpec& tendon : segment.tendons) {
    const double tension = at(acting.tensions_n, tendon.input);
    force_n -= tension;
    twist_stiffness_nm2 += tension * tendon.offset_m * tendon.offset_m;
    const double share = share_at(
        saturation, over(tension, tendon.saturation_n) + over(sums.tensions_n, saturation.tendons_n));
    const Eigen::Vector2d direction = share * towards(departures.azimuth_rad(tendon.azimuth_rad));
    actuation.moment_nm += tension * tendon.offset_m * direction;
    if (!acting.tension_change_n.empty())
      actuation.moment_change_nm += at(acting.tension_change_n, tendon.input) * tendon.offset_m * direction;
  }
  actuation.moment_nm *= departures.gain();
  actuation.moment_change_nm *= departures.gain();
  const double central_pa =
      segment.central_chamber ? at(acting.pressures_pa, segment.central_chamber->input) : 0.0;
  if (segment.central_chamber) force_n += central_pa * segment.central_chamber->area_m2;

  WallStretch wall;
  if (segment.axial_stiffness_n) {
    const std::optional<WallStretch> found =
        wall_stretch(force_n, departures.material() * *segment.axial_stiffness_n, segment.material);
    if (!found)
      throw LawError(fmt::format("an axial force of {:.4g} N leaves the wall no stable stretch", force_n));
    wall = *found;
  }
  actuation.mean_pressure_pa = std::max(0.0, segment.chambers.empty() ? central_pa : mean_pa);
  actuation.stretch = wall.stretch;
  actuation.length_m = departures.length() * wall.stretch * length_m;
  actuation.bending_stiffness_nm2 = segment.stiffness_by_pressure.empty()
                                        ? wall.modulus_ratio * segment.stiffness_base_nm2
                                        : interpolated(segment.stiffness_by_pressure, central_pa);
  actuation.bending_stiffness_nm2 +=
      growth_nm2(segment, acting) + segment.stiffness_per_min_nm2_per_pa * least_pa +
      segment.stiffness_per_jamming_nm2_per_pa * (departures.jamming_pa() + mean_pa);
  actuation.bending_stiffness_nm2 *= departures.bending();
  actuation.core_stiffness_nm2 =
      departures.bending() * segment.stiffness_per_jamming_nm2_per_pa * departures.jamming_pa();
  const double wall_torsion_nm2 = departures.torsion() * wall.modulus_ratio * segment.torsional_stiffness_nm2;
  actuation.torsional_stiffness_nm2 = wall_torsion_nm2 + twist_stiffness_nm2;
  if (segment.shear_stiffness_n)
    actuation.shear_stiffness_n =
        departures.material() * wall.modulus_ratio * *segment.shear_stiffness_n + sums.tensions_n;
  if (segment.axial_stiffness_n)
    actuation.axial_stiffness_n =
        departures.material() * wall.stretch * wall.modulus_ratio * *segment.axial_stiffness_n;
  for (const CableSpec& cable : segment.cables) {
    const double angle_rad = at(acting.angles_rad, cable.input);
    const double share = share_at(saturation, over(std::abs(angle_rad), cable.saturation_rad) +
                                                  over(sums.angles_rad, saturation.cables_rad));
    const double wound_m = share * cable.spool_radius_m * departures.pulling_rad(angle_rad);
    actuation.moment_nm += departures.gain() * actuation.bending_stiffness_nm2 *
                           departures.shortens_m(cable, wound_m) / (segment.length_m * cable.lever_m) *
                           towards(departures.azimuth_rad(cable.azimuth_rad));
  }
  actuation.moment_nm += actuation.bending_stiffness_nm2 * departures.rest_curvature_per_m();
  actuation.twist_moment_nm = wall_torsion_nm2 * departures.twist_rad() / actuation.length_m;
  // Laws with negative coefficients can be driven out of their range.
  if (!(actuation.bending_stiffness_nm2 > 0.0) || !(actuation.torsional_stiffness_nm2 > 0.0) ||
      !(actuation.length_m > 0.0))
    throw LawError(
        fmt::format("the laws give EI = {:.4g} N m^2, GJ = {:.4g} N m^2 and L = {:.4g} m, must be > 0",
                    actuation.bending_stiffness_nm2, actuation.torsional_stiffness_nm2, actuation.length_m));
  return actuation;
}

}  // namespace softarm::rig
