#include "extended_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "arm/wall_memory.h"
#include "arm_rod.h"
#include "instant_solver.h"
#include "memories.h"
#include "softarm/arm/laws.h"

namespace softarm::model {
namespace {

using Eigen::Vector3d;

constexpr int kPasses = 2;  // at rest, then with the inertia of that path
}  // namespace

struct ExtendedModel::Impl : InstantSolver {
  explicit Impl(const arm::Arm& arm) : InstantSolver(arm) {}

  static Series driven(const arm::Arm& arm, const std::vector<Present>& effects, const Series& series) {
    Series out = series;
    drive(arm, effects, out);
    return out;
  }

  /// What the walls keep back in each block, mean over its frames; empty where no segment has a wall.
  static std::vector<std::vector<Vector3d>> kept_back(const arm::Arm& arm, const Series& series,
                                                      const TrialData& trial) {
    std::vector<std::vector<Vector3d>> list;
    arm::LawMemory memory(arm);
    if (memory.empty()) return list;
    std::vector<std::vector<Vector3d>> at;  // of the frames
    for (Eigen::Index i = 0; i < series.t_s.size(); ++i) {
      const Eigen::VectorXd moving = series.moment_inputs.col(i);
      const arm::InputValues inputs(moving.data(), moving.data() + moving.size());
      auto predictions = softarm::arm::predict(arm, inputs);
      if (predictions) memory.follow(series.t_s[i], inputs, *predictions);
      at.push_back(memory.kept_back());
    }
    for (const Block& block : trial.blocks) {
      std::vector<Vector3d> mean(arm.segments.size(), Vector3d::Zero());
      for (std::size_t i = block.first; i < block.last; ++i) {
        for (std::size_t s = 0; s < mean.size(); ++s)
          mean[s] += at[i][s] / static_cast<double>(block.last - block.first);
      }
      list.push_back(std::move(mean));
    }
    return list;
  }

  static Instant instant_of(const Series& series, const TrialData& trial, std::size_t k) {
    const Block& block = trial.blocks[k];
    const auto first = static_cast<Eigen::Index>(block.first);
    const auto count = static_cast<Eigen::Index>(block.last - block.first);
    Instant instant;
    instant.t_s = series.t_s.segment(first, count).mean();
    if (k > 0 && !block.begins) {
      const Block& before = trial.blocks[k - 1];
      instant.dt_s = instant.t_s - series.t_s
                                       .segment(static_cast<Eigen::Index>(before.first),
                                                static_cast<Eigen::Index>(before.last - before.first))
                                       .mean();
    }
    instant.inputs = series.inputs.middleCols(first, count).rowwise().mean();
    instant.moment_inputs = series.moment_inputs.middleCols(first, count).rowwise().mean();
    instant.payload_kg = series.payload_kg.segment(first, count).mean();
    instant.gravity_base = block.gravity_base;
    instant.q_base_mocap = block.q_base_mocap;
    instant.session_s = trial.session_s + instant.t_s;
    return instant;
  }

  /// How the arm moves at an instant of a path of equilibria.
  Motion motion_of(const std::vector<Predicted>& path, std::size_t k) const {
    Motion motion;
    if (k == 0 || k + 1 >= path.size()) return motion;
    const Predicted &before = path[k - 1], &now = path[k], &after = path[k + 1];
    if (!before.solved || !now.solved || !after.solved || now.instant.dt_s <= 0.0 ||
        after.instant.dt_s <= 0.0)
      return motion;
    const double a = now.instant.dt_s, b = after.instant.dt_s;
    const auto second = [&](const Vector3d& x0, const Vector3d& x1, const Vector3d& x2) {
      return Vector3d(2.0 * ((x2 - x1) / b - (x1 - x0) / a) / (a + b));
    };
    const auto first = [&](const Vector3d& x0, const Vector3d& x1, const Vector3d& x2) {
      return Vector3d((a * (x2 - x1) / b + b * (x1 - x0) / a) / (a + b));
    };
    for (std::size_t j = 0; j < static_cast<std::size_t>(fine.stations()); ++j) {
      const Vector3d &x0 = before.shape.stations[j].p, &x1 = now.shape.stations[j].p,
                     &x2 = after.shape.stations[j].p;
      motion.velocity_m_s.push_back(first(x0, x1, x2));
      motion.acceleration_m_s2.push_back(second(x0, x1, x2));
      motion.curvature_rate.push_back(
          first(before.shape.middles[j].u, now.shape.middles[j].u, after.shape.middles[j].u));
    }
    return motion;
  }

  void positions(const arm::Arm& arm, const std::vector<Present>& effects, const Block& block,
                 Predicted& out) const {
    Bodies seen;
    bodies_of_solution(seen);
    for (const Present& present : effects) present.effect->observe(arm, present.values, out.instant, seen);
    out.p.resize(3, static_cast<Eigen::Index>(block.bodies.size()));
    for (std::size_t i = 0; i < block.bodies.size(); ++i)
      out.p.col(static_cast<Eigen::Index>(i)) = seen.p.col(block.bodies[i].body);
    out.tangents.resize(3, static_cast<Eigen::Index>(block.tangents.size()));
    out.q_tangents.clear();
    for (std::size_t i = 0; i < block.tangents.size(); ++i) {
      out.q_tangents.push_back(seen.q[static_cast<std::size_t>(block.tangents[i].body)]);
      out.tangents.col(static_cast<Eigen::Index>(i)) = out.q_tangents.back() * Vector3d::UnitZ();
    }
  }

  /// Of the rod that was made last, by the parameters that are wanted.
  bool differentiate(const Block& block, Predicted& out) {
    if (derivatives->solve(rod, out.q_tip) != rod::SolveStatus::kConverged) return false;
    out.by_rod.setZero(3 * static_cast<Eigen::Index>(block.bodies.size() + block.tangents.size()),
                       static_cast<Eigen::Index>(fine.parameters().size()));
    Eigen::Index row = 0;
    const auto put = [&](const Eigen::Matrix3Xd& rows) {
      for (std::size_t j = 0; j < columns.size(); ++j)
        out.by_rod.block<3, 1>(row, columns[j]) = rows.col(static_cast<Eigen::Index>(j));
      row += 3;
    };
    for (const Seen& seen : block.bodies)
      put(position_by_rod(bodies[static_cast<std::size_t>(seen.body)], seen.body, *derivatives));
    for (const SeenTangent& seen : block.tangents) put(tangent_by_rod(seen.body, *derivatives));
    return true;
  }

  void want(const arm::Arm& arm, const std::vector<bool>& which) {
    if (which == wanted) return;
    wanted = which;
    columns.clear();
    std::vector<rod::Parameter> parameters;
    for (std::size_t j = 0; j < which.size(); ++j) {
      if (!which[j]) continue;
      columns.push_back(static_cast<Eigen::Index>(j));
      parameters.push_back(fine.parameters()[j]);
    }
    derivatives.emplace(fine.layout(), body_stations(arm), parameters, solver_options(1e-10));
  }

  /// Makes the rod of each block that has a prediction, with the shapes and motions of those.
  /// @param use called with the block, its instant, and whether there is such a rod
  template <typename Use>
  void walk(const arm::Arm& arm, const std::vector<Present>& effects, const Dynamics& dynamics,
            const TrialData& trial, const std::vector<Predicted>& baseline, const Use& use) {
    const Series series = driven(arm, effects, trial.series);
    const auto walls = kept_back(arm, series, trial);
    Memories memories(effects);
    memories.begin(arm, fine);
    const bool moves = std::any_of(effects.begin(), effects.end(),
                                   [](const Present& present) { return present.effect->needs_motion(); });
    for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
      const Predicted& base = baseline[k];
      if (!base.solved) continue;
      Instant instant = instant_of(series, trial, k);
      if (!walls.empty()) instant.kept_back = walls[k];
      if (k > 0 && instant.dt_s <= 0.0) memories.rest();
      Shape shape = base.shape;
      if (shape.motion.velocity_m_s.empty() && moves) shape.motion = motion_of(baseline, k);
      use(k, instant, make(arm, effects, memories.all(), dynamics, instant, &shape, shape.motion, rod));
      memories.remember(arm, fine, instant, shape);
    }
  }

  /// Where bodies of a block are seen; one column per body of the arm.
  Eigen::Matrix3Xd seen(const arm::Arm& arm, const std::vector<Present>& effects, const Instant& instant,
                        const Block& block, const Predicted& base) const {
    Bodies seen;
    seen.p = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(bodies.size()));
    seen.q.assign(bodies.size(), Eigen::Quaterniond::Identity());
    for (std::size_t i = 0; i < block.bodies.size(); ++i) {
      const int b = block.bodies[i].body;
      const double s_m = bodies[static_cast<std::size_t>(b)].arclength_m;
      seen.p.col(b) = base.p.col(static_cast<Eigen::Index>(i));
      const auto nearest = std::min_element(base.shape.stations.begin(), base.shape.stations.end(),
                                            [&](const rod::RodState& x, const rod::RodState& y) {
                                              return std::abs(x.s_m - s_m) < std::abs(y.s_m - s_m);
                                            });
      seen.q[static_cast<std::size_t>(b)] = nearest->q;
    }
    for (const Present& present : effects) present.effect->observe(arm, present.values, instant, seen);
    return seen.p;
  }

  std::vector<bool> wanted;
  std::vector<Eigen::Index> columns;
  std::optional<rod::Solver> derivatives;  ///< by those
};

ExtendedModel::ExtendedModel(const arm::Arm& arm) : impl_(std::make_unique<Impl>(arm)) {}
ExtendedModel::~ExtendedModel() = default;
ExtendedModel::ExtendedModel(ExtendedModel&&) noexcept = default;
const FineRod& ExtendedModel::rod() const {
  return impl_->fine;
}

void ExtendedModel::predict(const arm::Arm& arm, const std::vector<Present>& effects,
                            const Dynamics& dynamics, const TrialData& trial,
                            const std::vector<Predicted>* start, std::vector<Predicted>& out) {
  Impl& m = *impl_;
  const Series series = Impl::driven(arm, effects, trial.series);
  const auto walls = Impl::kept_back(arm, series, trial);
  const bool moves = dynamics.inertia || dynamics.viscoelastic_lag_s != 0.0 ||
                     std::any_of(effects.begin(), effects.end(),
                                 [](const Present& present) { return present.effect->needs_motion(); });
  std::vector<Predicted> path, resting;
  std::vector<Predicted> still;
  const int passes = moves ? kPasses : 1;
  for (int pass = 0; pass < passes; ++pass) {
    const bool moving = pass > 0;
    if (moving) resting = std::move(path);
    if (pass == 1) still = resting;
    path.assign(trial.blocks.size(), {});
    Memories memories(effects);
    memories.begin(arm, m.fine);
    Feedback feedback;
    const Predicted* last = nullptr;
    for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
      Predicted& now = path[k];
      now.instant = Impl::instant_of(series, trial, k);
      if (!walls.empty()) now.instant.kept_back = walls[k];
      if (k > 0 && now.instant.dt_s <= 0.0) memories.rest();
      const Motion motion = moving ? m.motion_of(resting, k) : Motion();
      if (moving && resting[k].solved) {
        last = &resting[k];
      } else if (start != nullptr && (*start)[k].solved) {
        last = &(*start)[k];
      }
      const Impl::Context context{arm, memories.all(), dynamics, motion, feedback};
      now.solved = m.settle(context, effects, last != nullptr ? &last->q_tip : nullptr,
                            last != nullptr ? &last->shape : nullptr, now);
      if (!now.solved) {
        last = nullptr;
        continue;
      }
      last = &now;
      now.values = m.fine.values(m.rod);
      m.positions(arm, effects, trial.blocks[k], now);
      if (moving && still[k].solved && now.p.cols() > 0)
        now.inertial_m = (now.p - still[k].p).colwise().norm().maxCoeff();
      memories.remember(arm, m.fine, now.instant, now.shape);
    }
  }
  out = std::move(path);
}

ExtendedModel::Varied ExtendedModel::vary(const arm::Arm& arm, const std::vector<Present>& effects,
                                          const Dynamics& dynamics, const TrialData& trial,
                                          const std::vector<Predicted>& baseline) {
  Impl& m = *impl_;
  Varied varied;
  varied.values = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(m.fine.parameters().size()),
                                        static_cast<Eigen::Index>(trial.blocks.size()));
  std::vector<Eigen::Index> begins;
  Eigen::Index bodies = 0;
  for (const Block& block : trial.blocks) {
    begins.push_back(bodies);
    bodies += static_cast<Eigen::Index>(block.bodies.size());
  }
  varied.seen = Eigen::MatrixXd::Zero(3, bodies);
  m.walk(arm, effects, dynamics, trial, baseline, [&](std::size_t k, const Instant& instant, bool made) {
    const Block& block = trial.blocks[k];
    const Predicted& base = baseline[k];
    // What drives the arm beyond what the laws bear changes nothing.
    varied.values.col(static_cast<Eigen::Index>(k)) = made ? m.fine.values(m.rod) : base.values;
    const Eigen::Matrix3Xd seen = m.seen(arm, effects, instant, block, base);
    for (std::size_t i = 0; i < block.bodies.size(); ++i)
      varied.seen.col(begins[k] + static_cast<Eigen::Index>(i)) =
          seen.col(block.bodies[i].body) - base.p.col(static_cast<Eigen::Index>(i));
  });
  return varied;
}

void ExtendedModel::differentiate(const arm::Arm& arm, const std::vector<Present>& effects,
                                  const Dynamics& dynamics, const TrialData& trial,
                                  const std::vector<bool>& wanted, std::vector<Predicted>& predicted) {
  Impl& m = *impl_;
  m.want(arm, wanted);
  m.walk(arm, effects, dynamics, trial, predicted, [&](std::size_t k, const Instant&, bool made) {
    predicted[k].solved = made && m.differentiate(trial.blocks[k], predicted[k]);
  });
}

}  // namespace softarm::model
