#include "covariates.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "policy.h"
#include "softarm/arm/laws.h"

namespace softarm::diagnose {
namespace {

using Eigen::Vector2d;

/// What happens at each instant, by trial.
struct Happening {
  double moment_nm = 0.0, rate_nm_s = 0.0, past_nm = 0.0, pressure_pa = 0.0, vacuum_pa = 0.0;
  Vector2d direction = Vector2d::Zero();
};

std::vector<Happening> happenings(const JointModel& model, const arm::Arm& arm, const Linearised& at,
                                  std::size_t t) {
  std::vector<Happening> list(model.trials()[t].blocks.size());
  Vector2d last = Vector2d::Zero(), past = Vector2d::Zero();
  for (std::size_t k = 0; k < list.size(); ++k) {
    const model::Instant& now = at.predicted[t][k].instant;
    Happening& h = list[k];
    int pressures = 0;
    for (Eigen::Index i = 0; i < now.inputs.size(); ++i) {
      const arm::InputKind kind = arm.inputs.scalars[static_cast<std::size_t>(i)].kind;
      if (kind == arm::InputKind::kVacuum) h.vacuum_pa = std::max(h.vacuum_pa, now.inputs[i]);
      if (kind == arm::InputKind::kPressure) {
        h.pressure_pa += now.inputs[i];
        ++pressures;
      }
    }
    if (pressures > 0) h.pressure_pa /= pressures;
    const auto laws =
        predict(arm, arm::InputValues(now.inputs.data(), now.inputs.data() + now.inputs.size()));
    if (!laws) continue;
    Vector2d moment = Vector2d::Zero();
    for (const arm::SegmentPrediction& law : *laws) moment += law.actuation_nm();
    if (now.dt_s <= 0.0) last = past = moment;
    past += (now.dt_s > 0.0 ? 1.0 - std::exp(-now.dt_s / kPolicy.place.past_s) : 1.0) * (moment - past);
    h.moment_nm = moment.norm();
    if (h.moment_nm > 0.0) h.direction = moment / h.moment_nm;
    // Growing or falling, along the direction in which the arm is bent.
    if (now.dt_s > 0.0) h.rate_nm_s = h.direction.dot(moment - last) / now.dt_s;
    h.past_nm = h.direction.dot(moment - past);
    last = moment;
  }
  return list;
}

/// Bins of about as many points each, or one for each value where those are few.
void fill_bins(Covariate& c, const std::vector<GridPoint>& points) {
  std::vector<double> values;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].fit != nullptr) values.push_back(c.x[i]);
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  const double span = values.back() - values.front(), near = 1e-3 * span;
  std::vector<double> levels;
  for (const double v : values) {
    if (levels.empty() || v - levels.back() > near) levels.push_back(v);
    if (levels.size() > Covariate::kBins) break;
  }
  std::vector<double> edges;  // lower ends of all bins but the first
  if (levels.size() <= Covariate::kBins) {
    for (std::size_t i = 1; i < levels.size(); ++i) edges.push_back(levels[i] - 0.5 * near);
  } else {
    for (std::size_t i = 1; i < Covariate::kBins; ++i) {
      const double edge = values[i * values.size() / Covariate::kBins];
      if (edge > values.front() && (edges.empty() || edge > edges.back())) edges.push_back(edge);
    }
  }
  c.bin.resize(points.size());
  std::vector<std::vector<double>> members(edges.size() + 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    c.bin[i] = static_cast<int>(std::upper_bound(edges.begin(), edges.end(), c.x[i]) - edges.begin());
    if (points[i].fit != nullptr) members[static_cast<std::size_t>(c.bin[i])].push_back(c.x[i]);
  }
  for (std::vector<double>& list : members) {
    std::sort(list.begin(), list.end());
    c.middle.push_back(list.empty() ? 0.0 : list[list.size() / 2]);
  }
}

}  // namespace

std::vector<Covariate> covariates_of(const JointModel& model, const arm::Arm& arm, const Linearised& at,
                                     const std::vector<GridPoint>& points) {
  std::vector<Covariate> list;
  const auto add = [&](const std::string& name, const std::string& unit, std::vector<double> x,
                       double least_span = 0.0) {
    if (x.empty() ||
        *std::max_element(x.begin(), x.end()) - *std::min_element(x.begin(), x.end()) < least_span)
      return;
    Covariate c;
    c.name = name;
    c.unit = unit;
    c.x = std::move(x);
    fill_bins(c, points);
    if (c.middle.size() > 1) list.push_back(std::move(c));
  };

  std::vector<std::vector<Happening>> all;
  for (std::size_t t = 0; t < model.trials().size(); ++t) all.push_back(happenings(model, arm, at, t));
  const auto by = [&](const std::function<double(const Happening&, const model::Instant&)>& value) {
    std::vector<double> x;
    for (std::size_t i = 0; i < points.size(); ++i)
      x.push_back(value(all[points[i].trial][points[i].block],
                        at.predicted[points[i].trial][points[i].block].instant));
    return x;
  };
  const auto now = [](double Happening::*value) {
    return [value](const Happening& h, const model::Instant&) { return h.*value; };
  };
  add("moment of the law", "N m", by(now(&Happening::moment_nm)));
  add("rate of the moment of the law", "N m/s", by(now(&Happening::rate_nm_s)));
  add("moment above its 8 s mean", "N m", by(now(&Happening::past_nm)));
  add("direction of bending", "rad", by([](const Happening& h, const model::Instant&) {
        return std::atan2(h.direction.y(), h.direction.x());
      }));
  add("mean pressure", "Pa", by(now(&Happening::pressure_pa)));
  add("vacuum", "Pa", by(now(&Happening::vacuum_pa)));
  add("payload", "kg", by([](const Happening&, const model::Instant& i) { return i.payload_kg; }));
  add("attitude (angle from hanging)", "rad", by([](const Happening&, const model::Instant& i) {
        return std::acos(std::clamp(i.gravity_base.normalized().z(), -1.0, 1.0));
      }),
      kPolicy.place.attitude_rad);
  add("time in the trial", "s", by([](const Happening&, const model::Instant& i) { return i.t_s; }));
  std::vector<double> order;
  for (const GridPoint& point : points) order.push_back(static_cast<double>(point.trial + 1));
  if (model.trials().size() > 2) add("number of the trial", "1", std::move(order));
  return list;
}

}  // namespace softarm::diagnose
