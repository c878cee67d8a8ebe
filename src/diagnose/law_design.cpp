#include "law_design.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "effects/learned_moment.h"
#include "law_library.h"
#include "math/parallel.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kOffsets = 4;  // moments of one trial: x, y, the same all along and rising

/// Where the bodies' and the tangents' rows of a trial's blocks begin.
struct Rows {
  std::vector<Index> bodies, tangents;
  Index all = 0;
};

Rows rows_of(const model::TrialData& trial) {
  Rows rows;
  for (const model::Block& block : trial.blocks) {
    rows.bodies.push_back(rows.all);
    rows.all += 3 * static_cast<Index>(block.bodies.size());
  }
  for (const model::Block& block : trial.blocks) {
    rows.tangents.push_back(rows.all);
    rows.all += 3 * static_cast<Index>(block.tangents.size());
  }
  return rows;
}

/// Derivatives of what a block shows by moments about x and y of the pieces, weighted as the residuals are.
MatrixXd by_moments(const JointModel& model, const Linearised& at, std::size_t t, std::size_t k,
                    const Rows& rows, const std::vector<Index>& parameters) {
  const model::Block& block = model.trials()[t].blocks[k];
  const model::Predicted& now = at.predicted[t][k];
  const auto bodies = static_cast<Index>(block.bodies.size()),
             tangents = static_cast<Index>(block.tangents.size());
  MatrixXd out = MatrixXd::Zero(3 * (bodies + tangents), static_cast<Index>(parameters.size()));
  if (!now.solved || !model.uses(t, k) || now.by_rod == nullptr) return out;
  const auto fill = [&](Index i, Index row, double sd) {
    const double weight = at.root_weight[t][row] / sd;
    for (std::size_t p = 0; p < parameters.size(); ++p)
      out.col(static_cast<Index>(p)).segment<3>(3 * i) =
          weight * now.by_rod->seen.col(parameters[p]).segment<3>(3 * i).cast<double>();
  };
  for (Index i = 0; i < bodies; ++i)
    fill(i, rows.bodies[k] + 3 * i, model.sd_m(t, k, block.bodies[static_cast<std::size_t>(i)]));
  for (Index i = 0; i < tangents; ++i)
    fill(bodies + i, rows.tangents[k] + 3 * i,
         model.sd_rad(t, k, block.tangents[static_cast<std::size_t>(i)]));
  return out;
}

/// Of the rod's parameters: moments about x and y of each piece in turn.
std::vector<Index> moment_parameters(const model::FineRod& rod) {
  std::vector<Index> list(2 * rod.pieces().size(), 0);
  for (std::size_t p = 0; p < rod.parameters().size(); ++p) {
    const rod::Parameter& one = rod.parameters()[p];
    if (one.kind == rod::ParameterKind::kMoment && one.component < 2)
      list[static_cast<std::size_t>(2 * one.index + one.component)] = static_cast<Index>(p);
  }
  return list;
}

/// Moments of the pieces in each trial's offsets, of 1 N m at most.
MatrixXd offset_moments(const model::FineRod& rod) {
  model::Values constant = model::Values::Zero(effects::LearnedMoment::kCount);
  constant[effects::LearnedMoment::kTo] = 1.0;
  MatrixXd moments(2 * rod.stations(), kOffsets);
  Index column = 0;
  for (const model::Values& values : with_rising(constant)) {
    moments.middleCols(column, 2) = unit_moments(rod, values, Eigen::Vector2d::UnitX());
    column += 2;
  }
  return moments;
}

/// Offsets whose standard deviation is 1: each moves the bodies of the trials by what is usual.
void scale_offsets(const JointModel& model, const Linearised& at, const std::vector<Rows>& rows,
                   std::vector<MatrixXd>& columns) {
  VectorXd squares = VectorXd::Zero(kOffsets);
  double bodies = 0.0;
  for (std::size_t t = 0; t < columns.size(); ++t) {
    const std::vector<model::Block>& blocks = model.trials()[t].blocks;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      for (std::size_t i = 0; i < blocks[k].bodies.size(); ++i) {
        const Index row = rows[t].bodies[k] + 3 * static_cast<Index>(i);
        if (!(at.root_weight[t][row] > 0.0)) continue;
        const double scale = model.sd_m(t, k, blocks[k].bodies[i]) / at.root_weight[t][row];
        squares += scale * scale * columns[t].block(row, 0, 3, kOffsets).colwise().squaredNorm().transpose();
        bodies += 1.0;
      }
    }
  }
  const double usual_m = kPolicy.law.trial_offset * model.arm().total_length_m();
  for (Index j = 0; j < kOffsets && bodies > 0.0; ++j) {
    const double moved_m = std::sqrt(squares[j] / bodies);
    for (MatrixXd& of_trial : columns) of_trial.col(j) *= moved_m > 0.0 ? usual_m / moved_m : 0.0;
  }
}

/// Rows of bodies and of tangents: first one and number.
using Stretch = std::array<std::pair<Index, Index>, 2>;

/// The trial whole, or its stretches.
std::vector<Stretch> stretches(const JointModel& model, const Linearised& at, std::size_t trial,
                               const Rows& rows) {
  if (model.trials().size() >= kPolicy.law.few_trials) return {Stretch{{{0, rows.all}, {0, 0}}}};
  std::vector<Stretch> list;
  Index body = 0, tangent = rows.tangents.empty() ? 0 : rows.tangents.front();
  for (const TimeStretch& stretch : at.stretches) {
    if (stretch.trial != trial) continue;
    list.push_back({{{body, stretch.all_rows}, {tangent, stretch.tangent_rows}}});
    body += stretch.all_rows;
    tangent += stretch.tangent_rows;
  }
  return list;
}

/// Priors, and the products of the columns by unit.
void add_sums(const JointModel& model, const Linearised& at, const std::vector<Rows>& rows, unsigned jobs,
              LawDesign& design) {
  LawSums& sums = design.sums;
  const double misfit = std::max(1.0, at.square / std::max(1, at.rows));
  sums.precision = VectorXd::Constant(kOffsets + sums.unknowns, misfit);
  for (Index j = 0; j < sums.unknowns; ++j)
    sums.precision[kOffsets + j] = misfit / std::pow(at.columns[static_cast<std::size_t>(j)].prior_sd, 2);
  sums.size_precision = misfit / std::pow(kPolicy.fit.size_sd, 2);
  std::vector<std::vector<MatrixXd>> of(design.columns.size());
  math::in_parallel(design.columns.size(), jobs, [&](std::size_t t) {
    for (const Stretch& stretch : stretches(model, at, t, rows[t])) {
      MatrixXd products = MatrixXd::Zero(design.columns[t].cols(), design.columns[t].cols());
      for (const auto& [first, count] : stretch) {
        const auto part = design.columns[t].middleRows(first, count);
        products.noalias() += part.transpose() * part;
      }
      of[t].push_back(std::move(products));
    }
  });
  for (std::size_t t = 0; t < of.size(); ++t) {
    for (MatrixXd& products : of[t]) {
      sums.trial.push_back(t);
      sums.of.push_back(std::move(products));
    }
  }
}

}  // namespace

LawDesign law_design(JointModel& model, Linearised& at, unsigned jobs) {
  model.complete(at);
  const std::vector<LibraryTerm> library = law_library(model, at, jobs);
  LawDesign design;
  for (const LibraryTerm& one : library)
    for (model::Values& values : with_rising(one.values)) design.terms.push_back(std::move(values));
  design.sums.offsets = kOffsets;
  design.sums.unknowns = static_cast<Index>(at.columns.size());
  design.sums.terms = static_cast<Index>(design.terms.size());
  const std::vector<Index> parameters = moment_parameters(model.rod());
  const MatrixXd offsets = offset_moments(model.rod());
  const double usual_nm = effects::learned_moment().info().parameters[effects::LearnedMoment::kX].usual;
  design.columns.resize(model.trials().size());
  std::vector<Rows> rows(model.trials().size());
  math::in_parallel(model.trials().size(), jobs, [&](std::size_t t) {
    rows[t] = rows_of(model.trials()[t]);
    MatrixXd& columns = design.columns[t];
    columns.setZero(rows[t].all, design.sums.first(design.sums.terms) + 1);
    columns.middleCols(kOffsets, design.sums.unknowns) = at.derivative[t];
    columns.col(columns.cols() - 1) = at.residual[t];
    MatrixXd moments(offsets.rows(), 2 * design.sums.terms);
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      if (!model.uses(t, k) || !at.predicted[t][k].solved) continue;
      for (Index j = 0; j < design.sums.terms; ++j)
        moments.middleCols(2 * j, 2) =
            usual_nm * unit_moments(model.rod(), design.terms[static_cast<std::size_t>(j)],
                                    library[static_cast<std::size_t>(j / 2)].regressor[t][k]);
      const MatrixXd d = by_moments(model, at, t, k, rows[t], parameters);
      const Index bodies = 3 * static_cast<Index>(model.trials()[t].blocks[k].bodies.size());
      for (const auto& [from, to, count] :
           {std::array<Index, 3>{0, rows[t].bodies[k], bodies},
            std::array<Index, 3>{bodies, rows[t].tangents[k], d.rows() - bodies}}) {
        columns.block(to, 0, count, kOffsets) = d.middleRows(from, count) * offsets;
        columns.block(to, design.sums.first(0), count, 2 * design.sums.terms) =
            d.middleRows(from, count) * moments;
      }
    }
  });
  scale_offsets(model, at, rows, design.columns);
  add_sums(model, at, rows, jobs, design);
  return design;
}

}  // namespace softarm::diagnose
