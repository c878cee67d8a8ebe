#include "structure.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <map>
#include <vector>

#include "contribution.h"
#include "flexible.h"

namespace softarm::diagnose {
namespace {

using Eigen::VectorXd;

double two_sided(double z) {
  return 2.0 * boost::math::cdf(boost::math::complement(boost::math::normal(), std::abs(z)));
}

}  // namespace

Structure structure_of(const JointModel& model, const Linearised& at, const Unseen& unseen) {
  Structure out;
  out.chi2_per_dof = unseen.total_chi2 / std::max(1, at.rows);
  // In time: products of a body's neighbouring residuals; along the arm: of neighbouring bodies at one
  // instant. Under noise alone each has mean 0.
  double time = 0.0, time2 = 0.0, along = 0.0, along2 = 0.0;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    std::map<int, Eigen::Vector3d> last;
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      const model::Block& block = model.trials()[t].blocks[k];
      std::map<int, Eigen::Vector3d> now;
      const Eigen::Vector3d* before = nullptr;
      for (const model::Seen& seen : block.bodies) {
        if (at.root_weight[t][row] > 0.0) {
          const Eigen::Vector3d r = unseen.residual[t].segment<3>(row) / model.sd_m(t, k, seen);
          if (!block.begins && last.count(seen.body) > 0) {
            const double product = r.dot(last[seen.body]);
            time += product;
            time2 += product * product;
          }
          if (before != nullptr) {
            const double product = r.dot(*before);
            along += product;
            along2 += product * product;
          }
          before = &(now[seen.body] = r);
        }
        row += 3;
      }
      last = std::move(now);
    }
  }
  if (time2 > 0.0) out.whiteness_p = two_sided(time / std::sqrt(time2));
  if (along2 > 0.0) out.along_s_p = two_sided(along / std::sqrt(along2));

  // Residuals by what drives the arm: per stretch of a trial, the mean in the plane against the mean input.
  const Features all = features(model, at);
  std::vector<VectorXd> inputs;
  std::vector<double> errors;
  std::size_t i = 0;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    Eigen::Index row = 0;
    VectorXd sum = VectorXd::Zero(all.values.cols());
    double error = 0.0, count = 0.0, from_s = -1e9;
    const auto close = [&] {
      if (count > 0.0) {
        inputs.push_back(sum / count);
        errors.push_back(error / count);
      }
      sum.setZero();
      error = count = 0.0;
    };
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      const model::Block& block = model.trials()[t].blocks[k];
      const auto rows = 3 * static_cast<Eigen::Index>(block.bodies.size());
      if (model.uses(t, k) && at.predicted[t][k].solved) {
        const double t_s = at.predicted[t][k].instant.t_s;
        if (t_s > from_s + 2.0) {
          close();
          from_s = t_s;
        }
        if (!block.bodies.empty()) {
          const auto& seen = block.bodies.back();
          error += in_section(at.predicted[t][k],
                              model.arm().bodies[static_cast<std::size_t>(seen.body)].arclength_m,
                              unseen.residual[t].segment<3>(row + rows - 3))
                       .x();
          sum += all.values.row(static_cast<Eigen::Index>(i)).transpose();
          count += 1.0;
        }
        ++i;
      }
      row += rows;
    }
    close();
  }
  const auto n = static_cast<Eigen::Index>(errors.size());
  if (n >= 8) {
    VectorXd e = Eigen::Map<const VectorXd>(errors.data(), n);
    e.array() -= e.mean();
    for (Eigen::Index c = 0; c < all.values.cols(); ++c) {
      VectorXd x(n);
      for (Eigen::Index r = 0; r < n; ++r) x[r] = inputs[static_cast<std::size_t>(r)][c];
      x.array() -= x.mean();
      const double norm = x.norm() * e.norm();
      if (!(norm > 1e-15)) continue;
      const double r = std::clamp(x.dot(e) / norm, -0.999999, 0.999999);
      const double dof = static_cast<double>(n - 2), t = r * std::sqrt(dof / (1.0 - r * r));
      const double p =
          2.0 * boost::math::cdf(boost::math::complement(boost::math::students_t(dof), std::abs(t)));
      const std::string& name = all.names[static_cast<std::size_t>(c)];
      const auto known = out.by_input_p.find(name);
      out.by_input_p[name] = known == out.by_input_p.end() ? p : std::min(p, known->second);
    }
  }
  out.where = where_is(model, at, unseen.residual);
  return out;
}

}  // namespace softarm::diagnose
