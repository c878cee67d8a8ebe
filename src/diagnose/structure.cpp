#include "structure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "contribution.h"
#include "flexible.h"
#include "math/distributions.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// In time: products of a body's neighbouring residuals; along the arm: of neighbouring bodies at one
/// instant. Under noise alone each has mean 0.
struct Products {
  double sum = 0.0, squares = 0.0;

  void add(double product) {
    sum += product;
    squares += product * product;
  }
  double p() const { return squares > 0.0 ? math::normal_two_sided(sum / std::sqrt(squares)) : 1.0; }
};

void add_products(const JointModel& model, const Linearised& at, const Unseen& unseen, std::size_t t,
                  Products& time, Products& along) {
  std::map<int, Eigen::Vector3d> last;
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
    const model::Block& block = model.trials()[t].blocks[k];
    std::map<int, Eigen::Vector3d> now;
    const Eigen::Vector3d* before = nullptr;
    for (const model::Seen& seen : block.bodies) {
      if (at.root_weight[t][row] > 0.0) {
        const Eigen::Vector3d r = unseen.residual[t].segment<3>(row) / model.sd_m(t, k, seen);
        if (!block.begins && last.count(seen.body) > 0) time.add(r.dot(last[seen.body]));
        if (before != nullptr) along.add(r.dot(*before));
        before = &(now[seen.body] = r);
      }
      row += 3;
    }
    last = std::move(now);
  }
}

/// The last body's mean residual in the plane of bending, by stretch of a trial, and what drove the arm
/// there, a row each.
struct ByStretch {
  MatrixXd features;
  VectorXd error_m;
};

ByStretch last_body_by_stretch(const JointModel& model, const Linearised& at, const Unseen& unseen,
                               const Features& all) {
  std::vector<VectorXd> drives;
  std::vector<double> errors_m;
  std::size_t i = 0;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    Eigen::Index row = 0;
    VectorXd sum = VectorXd::Zero(all.values.cols());
    double error = 0.0, count = 0.0, from_s = -1e9;
    const auto close = [&] {
      if (count > 0.0) {
        drives.push_back(sum / count);
        errors_m.push_back(error / count);
      }
      sum.setZero();
      error = count = 0.0;
    };
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      const model::Block& block = model.trials()[t].blocks[k];
      const auto rows = 3 * static_cast<Eigen::Index>(block.bodies.size());
      if (model.uses(t, k) && at.predicted[t][k].solved) {
        const double t_s = at.predicted[t][k].instant.t_s;
        if (t_s > from_s + kPolicy.fit.stretch_s) {
          close();
          from_s = t_s;
        }
        if (!block.bodies.empty()) {
          const auto body = static_cast<std::size_t>(block.bodies.back().body);
          error += in_section(at.predicted[t][k], model.arm().bodies[body].arclength_m,
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
  ByStretch out{MatrixXd(static_cast<Eigen::Index>(drives.size()), all.values.cols()),
                Eigen::Map<const VectorXd>(errors_m.data(), static_cast<Eigen::Index>(errors_m.size()))};
  for (std::size_t s = 0; s < drives.size(); ++s)
    out.features.row(static_cast<Eigen::Index>(s)) = drives[s].transpose();
  return out;
}

/// Of no correlation of two series of this length, by Student's t.
double p_of_correlation(const VectorXd& x, const VectorXd& y) {
  const double r = std::clamp(x.dot(y) / (x.norm() * y.norm()), -0.999999, 0.999999);
  const double dof = static_cast<double>(x.size() - 2), t = r * std::sqrt(dof / (1.0 - r * r));
  return math::students_t_two_sided(dof, t);
}

}  // namespace

std::map<std::string, double> p_by_name(const std::vector<std::string>& names, const MatrixXd& values,
                                        const VectorXd& error) {
  std::map<std::string, double> p;
  if (error.size() < kPolicy.structure.fewest_stretches) return p;
  const VectorXd e = error.array() - error.mean();
  std::map<std::string, int> columns;
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    const VectorXd x = values.col(c).array() - values.col(c).mean();
    if (!(x.norm() * e.norm() > 1e-15)) continue;
    const std::string& name = names[static_cast<std::size_t>(c)];
    const auto known = p.try_emplace(name, 1.0).first;
    known->second = std::min(known->second, p_of_correlation(x, e));
    ++columns[name];
  }
  for (auto& [name, least] : p) least = -std::expm1(columns.at(name) * std::log1p(-least));
  return p;
}

Structure structure_of(const JointModel& model, const Linearised& at, const Unseen& unseen) {
  Structure out;
  out.chi2_per_dof = unseen.total_chi2 / std::max(1, at.rows);
  Products time, along;
  for (std::size_t t = 0; t < model.trials().size(); ++t) add_products(model, at, unseen, t, time, along);
  out.whiteness_p = time.p();
  out.along_s_p = along.p();
  const Features all = features(model, at);
  const ByStretch stretches = last_body_by_stretch(model, at, unseen, all);
  out.by_input_p = p_by_name(all.names, stretches.features, stretches.error_m);
  out.where = where_is(model, at, unseen.residual);
  return out;
}

}  // namespace softarm::diagnose
