#include "law_departures.h"

#include <algorithm>
#include <cmath>

namespace softarm::rig {
namespace {

/// ln(1 + e^x), without overflow.
double softplus(double x) {
  return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x)));
}

/// 0 at 0, 1 at the reference.
double shape(const LawSpec::GainNonlinearity& law, double pressure_pa) {
  const double x = std::abs(pressure_pa) / law.reference_pa;
  return law.saturating ? std::expm1(-x) / std::expm1(-1.0) : x;
}

}  // namespace

double beyond_dead_zone(const LawSpec::DeadZone& zone, double pressure_pa) {
  const double p = std::abs(pressure_pa), p0 = zone.pressure_pa;
  const double width = 0.25 * p0;
  const double beyond =
      zone.smooth ? width * (softplus((p - p0) / width) - softplus(-p0 / width)) : std::max(0.0, p - p0);
  return std::copysign(beyond, pressure_pa);
}

LawDepartures::LawDepartures(const SegmentSpec& segment, const Acting& acting, const LawSpec& hidden)
    : segment_(segment), acting_(acting), hidden_(hidden) {
  const double count = static_cast<double>(segment.chambers.size()) + (segment.central_chamber ? 1.0 : 0.0);
  for (const ChamberSpec& chamber : segment.chambers) mean_pa_ += pressure(chamber.input) / count;
  if (segment.central_chamber) mean_pa_ += pressure(segment.central_chamber->input) / count;
}

double LawDepartures::moment_pressure_pa(const ChamberSpec& chamber) const {
  double p = pressure(chamber.input);
  if (hidden_.dead_zone && hidden_.dead_zone->chamber < 0) p = beyond_dead_zone(*hidden_.dead_zone, p);
  if (const auto& law = hidden_.gain_nonlinearity) p *= 1.0 + law->share * shape(*law, p);
  if (const auto& bulge = hidden_.chamber_bulge) {
    double others_pa = 0.0;
    for (const ChamberSpec& other : segment_.chambers)
      if (other.input != chamber.input) others_pa += pressure(other.input);
    const double q = others_pa / bulge->reference_pa;
    p *= 1.0 + bulge->share * (bulge->saturating && q > 0.0 ? 2.0 * q / (1.0 + q) : q);
  }
  const auto mismatch = hidden_.chamber_gain_share.find(chamber.input);
  return mismatch == hidden_.chamber_gain_share.end() ? p : p * (1.0 + mismatch->second);
}

double LawDepartures::pulling_rad(double angle_rad) const {
  const auto& slack = hidden_.cable_slack;
  if (!slack || slack->angle_rad <= 0.0) return angle_rad;
  const double size = std::abs(angle_rad), s = slack->angle_rad;
  return std::copysign(slack->sags ? size + s * std::expm1(-size / s) : std::max(0.0, size - s), angle_rad);
}

double LawDepartures::shortens_m(const CableSpec& cable, double wound_m) const {
  const auto& through = hidden_.cables_through;
  if (!through) return wound_m;
  const double azimuth = azimuth_rad(cable.azimuth_rad);
  const double towards_rad =
      acting_.bent_before_rad.dot(Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth)));
  const double left_m = wound_m - through->share * cable.lever_m * towards_rad;
  return through->slackens ? std::max(std::min(0.0, wound_m), left_m) : left_m;
}

double LawDepartures::gain() const {
  double factor = acting_.gain_scale * (1.0 + hidden_.gain_share_per_rad * acting_.bend_rad);
  if (const auto& law = hidden_.vacuum_gain)
    factor *= 1.0 - law->share * acting_.vacuum_pa / law->reference_pa;
  return factor;
}

double LawDepartures::bending() const {
  double factor = acting_.stiffness_scale;
  if (const auto& law = hidden_.pressure_stiffening) {
    const double x = mean_pa_ / law->reference_pa;
    factor *= 1.0 + law->share * (law->quadratic ? x * x : x);
  }
  if (const auto& law = hidden_.radial_expansion)
    factor *= std::pow(1.0 + law->share * mean_pa_ / law->reference_pa, law->power);
  return factor;
}

double LawDepartures::torsion() const {
  double factor = acting_.stiffness_scale;
  if (const auto& law = hidden_.radial_expansion)
    factor *= std::pow(1.0 + law->share * mean_pa_ / law->reference_pa, law->power);
  return factor;
}

double LawDepartures::length() const {
  double factor = acting_.length_scale;
  if (const auto& law = hidden_.pressure_elongation)
    factor *= 1.0 + law->share * mean_pa_ / law->reference_pa;
  if (const auto& law = hidden_.vacuum_shortening)
    factor *= 1.0 - law->share * acting_.vacuum_pa / law->reference_pa;
  return factor;
}

double LawDepartures::jamming_pa() const {
  const double vacuum_pa = acting_.jamming_pa;
  const auto& law = hidden_.jamming_law;
  if (!law) return vacuum_pa;
  const double v = std::max(0.0, vacuum_pa);
  return law->reference_pa *
         (law->power ? std::pow(v / law->reference_pa, law->exponent)
                     : std::expm1(-v / law->scale_pa) / std::expm1(-law->reference_pa / law->scale_pa));
}

Eigen::Vector2d LawDepartures::rest_curvature_per_m() const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const LawSpec::RestCurvature& rest : hidden_.rest_curvature)
    if (rest.segment < 0 || rest.segment == acting_.segment)
      sum += rest.curvature_per_m * Eigen::Vector2d(std::cos(rest.azimuth_rad), std::sin(rest.azimuth_rad));
  return sum;
}

double LawDepartures::twist_rad() const {
  double twist = 0.0;
  if (const auto& law = hidden_.twist_with_pressure) twist += law->angle_rad * mean_pa_ / law->reference;
  if (const auto& law = hidden_.twist_with_tension)
    for (const TendonSpec& tendon : segment_.tendons)
      twist += law->angle_rad * acting_.tensions_n.at(static_cast<std::size_t>(tendon.input)) /
               law->reference / static_cast<double>(segment_.tendons.size());
  return twist;
}

}  // namespace softarm::rig
