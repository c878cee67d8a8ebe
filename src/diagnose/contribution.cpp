#include "contribution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "flexible.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using model::Block;
using model::Predicted;

const rod::RodState& nearest(const model::Shape& shape, double s_m) {
  const rod::RodState* best = &shape.stations.front();
  for (const rod::RodState& state : shape.stations) {
    if (std::abs(state.s_m - s_m) < std::abs(best->s_m - s_m)) best = &state;
  }
  return *best;
}

/// Squares by axis and body, and per block.
struct Squares {
  Vector3d axes = Vector3d::Zero();
  VectorXd bodies, counts;
  std::vector<double> block;  ///< rms, in the order of Features
};

Squares squares_of(const JointModel& model, const Linearised& at, const std::vector<VectorXd>& moved) {
  Squares out;
  out.bodies = out.counts = VectorXd::Zero(static_cast<Eigen::Index>(model.arm().bodies.size()));
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      const Block& block = model.trials()[t].blocks[k];
      const bool used = model.uses(t, k) && at.predicted[t][k].solved;
      double sum = 0.0;
      for (const model::Seen& seen : block.bodies) {
        if (used) {
          const Vector3d v = moved[t].segment<3>(row);
          const double s = model.arm().bodies[static_cast<std::size_t>(seen.body)].arclength_m;
          out.axes += in_section(at.predicted[t][k], s, v).cwiseAbs2();
          out.bodies[seen.body] += v.squaredNorm();
          out.counts[seen.body] += 1.0;
          sum += v.squaredNorm();
        }
        row += 3;
      }
      if (used) out.block.push_back(std::sqrt(sum / std::max<std::size_t>(1, block.bodies.size())));
    }
  }
  return out;
}

double correlation(const VectorXd& a, const VectorXd& b) {
  const VectorXd x = a.array() - a.mean(), y = b.array() - b.mean();
  const double norm = x.norm() * y.norm();
  return norm > 0.0 ? x.dot(y) / norm : 0.0;
}

Where common(const JointModel& model, const Linearised& at, const Squares& squares) {
  Where where;
  Eigen::Index axis = 0;
  squares.axes.maxCoeff(&axis);
  where.axis = axis == 0 ? "in_plane" : axis == 1 ? "out_of_plane" : "axial";
  const VectorXd size =
      Eigen::Map<const VectorXd>(squares.block.data(), static_cast<Eigen::Index>(squares.block.size()));
  if (size.size() < kPolicy.place.fewest_blocks) return where;
  const Features all = features(model, at);
  double best = kPolicy.place.goes_with;
  for (Eigen::Index c = 0; c < all.values.cols(); ++c) {
    const std::string& name = all.names[static_cast<std::size_t>(c)];
    VectorXd x = all.values.col(c);
    if (name.rfind("speed of", 0) == 0 || name.rfind("past of", 0) == 0) x = x.cwiseAbs();
    if (x.size() != size.size()) break;
    const double r = std::abs(correlation(x, size));
    if (r > best) {
      best = r;
      where.input = name;
    }
  }
  const double most = size.maxCoeff();
  const double on = static_cast<double>((size.array() > kPolicy.place.on_share * most).count()) /
                    static_cast<double>(size.size());
  where.when = on < kPolicy.place.seldom ? fmt::format("in {:.0f} % of the time", 100.0 * on) : "always";
  return where;
}

}  // namespace

Vector3d in_section(const Predicted& predicted, double s_m, const Vector3d& v_base) {
  const rod::RodState& section = nearest(predicted.shape, s_m);
  const Vector3d tangent = section.q * Vector3d::UnitZ();
  const Vector3d& tip = predicted.shape.stations.back().p;
  Vector3d lateral(tip.x(), tip.y(), 0.0);
  if (lateral.norm() < kPolicy.place.straight * tip.norm()) lateral = Vector3d::UnitX();
  const Vector3d normal = Vector3d::UnitZ().cross(lateral).normalized();  // of the plane of bending
  const Vector3d inside = normal.cross(tangent).normalized();
  return {v_base.dot(inside), v_base.dot(normal), v_base.dot(tangent)};
}

std::vector<VectorXd> contribution(JointModel& model, const Linearised& at, std::size_t effect) {
  JointParameters without = at.at;
  without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  std::vector<VectorXd> moved;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    VectorXd d = model.signatures(at, t, {without}, {-1.0}).col(0);
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      for (const model::Seen& seen : model.trials()[t].blocks[k].bodies) {
        d.segment<3>(row) *= model.sd_m(t, k, seen);
        row += 3;
      }
    }
    moved.push_back(std::move(d));
  }
  return moved;
}

Where where_is(const JointModel& model, const Linearised& at, const model::Present& effect,
               const std::vector<VectorXd>& moved) {
  Where where = common(model, at, squares_of(model, at, moved));
  if (const auto place = effect.effect->place(model.arm(), effect.values)) {
    where.s_from_m = place->first;
    where.s_to_m = place->second;
  }
  return where;
}

Where where_is(const JointModel& model, const Linearised& at, const std::vector<VectorXd>& residual) {
  const Squares squares = squares_of(model, at, residual);
  Where where = common(model, at, squares);
  // The shortest run of bodies that has most of it.
  const auto& bodies = model.arm().bodies;
  const VectorXd mean = squares.bodies.cwiseQuotient(squares.counts.cwiseMax(1.0));
  const double all = mean.sum();
  const std::size_t count = bodies.size();
  for (std::size_t length = 1; length < count && all > 0.0; ++length) {
    double best = 0.0;
    std::size_t begin = 0;
    for (std::size_t i = 0; i + length <= count; ++i) {
      const double part = mean.segment(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(length)).sum();
      if (part > best) {
        best = part;
        begin = i;
      }
    }
    if (best < kPolicy.place.mostly * all) continue;
    where.s_from_m = begin > 0 ? bodies[begin - 1].arclength_m : 0.0;
    where.s_to_m = bodies[begin + length - 1].arclength_m;
    break;
  }
  return where;
}

}  // namespace softarm::diagnose
