#include "extended_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "arm/wall_memory.h"
#include "arm_rod.h"
#include "held_places.h"
#include "instant_solver.h"
#include "memories.h"
#include "softarm/arm/laws.h"
#include "tip_guess.h"

namespace softarm::model {
namespace {

using Eigen::Vector3d;

constexpr int kPasses = 2;  // at rest, then with the inertia of that path
constexpr int kModes = 4;   // in which an arm swings: two ways to bend it, in two planes
// Up to this share of its length between two shapes, and of its stiffness, an arm swings alike.
constexpr double kAlikeShape = 0.02, kAlikeStiffness = 0.03;

/// Blocks in a row without an equilibrium. What keeps an arm from one lasts, and a look in vain takes a
/// hundred times as long as another: the next one is after as many blocks as have none.
class Lost {
 public:
  bool looks() const { return (in_a_row_ & (in_a_row_ - 1)) == 0; }
  void another() { ++in_a_row_; }
  void end() { in_a_row_ = 0; }

 private:
  unsigned in_a_row_ = 0;
};

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
    instant.base_in_mocap_m = block.base_in_mocap_m;
    instant.session_s = series.session_s + instant.t_s;
    return instant;
  }

  static std::vector<Instant> instants_of(const arm::Arm& arm, const Series& series, const TrialData& trial) {
    auto walls = kept_back(arm, series, trial);
    std::vector<Instant> list;
    for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
      list.push_back(instant_of(series, trial, k));
      if (!walls.empty()) list.back().kept_back = std::move(walls[k]);
    }
    return list;
  }

  static Sluggishness sluggishness(const Dynamics& dynamics, const std::vector<Present>& effects) {
    Sluggishness all{0.0, dynamics.viscoelastic_lag_s};
    for (const Present& present : effects) {
      const Sluggishness own = present.effect->sluggishness(present.values);
      all.mass_share += own.mass_share;
      all.lag_s += own.lag_s;
    }
    return all;
  }

  static std::vector<Motion> motions(const Dynamics& dynamics, const Sluggishness& sluggish,
                                     const TrialData& trial, const Series& series,
                                     const std::vector<Predicted>& path) {
    std::vector<Rest> rest;
    for (const Predicted& block : path) rest.push_back(block.solved ? block.rest : Rest());
    return dynamics.modes != nullptr ? swing(*dynamics.modes, trial, series, sluggish, rest)
                                     : follow(trial, rest);
  }

  /// Of the rod that was made last.
  Rest rest_of(const Shape& shape, const Eigen::Quaterniond& q_tip, double t_s) const {
    Rest rest;
    rest.t_s = t_s;
    rest.q_tip = q_tip;
    rest.masses_kg = fine.station_masses_kg(rod);
    rest.lengths_m.resize(fine.stations());
    rest.compliance.resize(fine.stations());
    for (int j = 0; j < fine.stations(); ++j) {
      rest.lengths_m[j] = rod.segments[static_cast<std::size_t>(j)].length_m;
      rest.compliance[j] = rod.segments[static_cast<std::size_t>(j)].bending_compliance;
    }
    for (const rod::RodState& station : shape.stations) rest.stations.push_back(station.p);
    for (const rod::RodState& middle : shape.middles) rest.curvature.push_back(middle.u);
    return rest;
  }

  void positions(const arm::Arm& arm, const std::vector<Present>& effects, const Block& block,
                 Predicted& out) const {
    Bodies seen;
    bodies_of_solution(seen);
    observe(arm, effects, out.instant, seen);
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

  /// What follows from a shape that was found last.
  /// @param resting the equilibrium that the arm moves beyond; nullptr: this is one
  void describe(const arm::Arm& arm, const std::vector<Present>& effects, const Block& block,
                const Predicted* resting, Predicted& now) const {
    now.values = fine.values(rod);
    positions(arm, effects, block, now);
    now.rest = resting != nullptr ? resting->rest : rest_of(now.shape, now.q_tip, now.instant.t_s);
    now.rest_shape = resting != nullptr ? resting->rest_shape : std::make_shared<const Shape>(now.shape);
    if (resting != nullptr) now.inertial_m = moved_m(now, *resting);
  }

  /// By the wanted parameters, in place among all.
  Eigen::MatrixXf among_all(const Eigen::MatrixXd& by_wanted) const {
    Eigen::MatrixXf all =
        Eigen::MatrixXf::Zero(by_wanted.rows(), static_cast<Eigen::Index>(fine.parameters().size()));
    for (std::size_t c = 0; c < columns.size(); ++c)
      all.col(columns[c]) = by_wanted.col(static_cast<Eigen::Index>(c)).cast<float>();
    return all;
  }

  /// Of modes, by the parameters that are wanted, of the rod that `derivatives` solved last.
  Eigen::MatrixXf coordinates(const Modes* modes, const HeldAnswer& held) const {
    if (modes == nullptr) return {};
    Eigen::MatrixXd by =
        Eigen::MatrixXd::Zero(modes->stiffness.size(), static_cast<Eigen::Index>(columns.size()));
    for (int j = 0; j < fine.stations(); ++j)
      by.noalias() += modes->project.middleCols<3>(3 * j).lazyProduct(
          derivatives->dp(static_cast<int>(bodies.size()) + j));
    return among_all(held.added_to(by));
  }

  /// Of the rod that was made last, by the parameters that are wanted.
  bool differentiate(const Block& block, const HeldPlaces& places, const Shape& shape, const Modes* now,
                     const Modes* next, Predicted& out) {
    if (derivatives->solve(rod, out.q_tip) != rod::SolveStatus::kConverged) return false;
    Eigen::MatrixXd seen(3 * static_cast<Eigen::Index>(block.bodies.size() + block.tangents.size()),
                         static_cast<Eigen::Index>(columns.size()));
    Eigen::Index row = 0;
    const auto put = [&](const Eigen::Matrix3Xd& rows) {
      seen.middleRows<3>(row) = rows;
      row += 3;
    };
    for (const Seen& body : block.bodies)
      put(position_by_rod(bodies[static_cast<std::size_t>(body.body)], body.body, *derivatives));
    for (const SeenTangent& body : block.tangents) put(tangent_by_rod(body.body, *derivatives));
    const HeldAnswer held =
        places.answer_by(rod, shape, *derivatives, static_cast<int>(bodies.size()), columns);
    ByRod by;
    by.seen = among_all(held.added_to(seen));
    by.modes_now = coordinates(now, held);
    by.modes_next = next == now ? by.modes_now : coordinates(next, held);
    if (now != nullptr && !places.empty())
      by.held_back = (seen * held.forces * (held.answer * places.displacements(now->shape))).cast<float>();
    out.by_rod = std::make_shared<const ByRod>(std::move(by));
    return true;
  }

  std::vector<double> bodies_and_stations(const arm::Arm& arm) const {
    std::vector<double> places = body_stations(arm);
    for (int j = 0; j < fine.stations(); ++j) places.push_back(fine.station_m(j));
    return places;
  }

  /// Beside these parameters the forces on stations that places share theirs with.
  void want(const arm::Arm& arm, const HeldPlaces& places, std::vector<bool> which) {
    const Eigen::MatrixXd shares = places.shares();
    for (std::size_t j = 0; j < which.size() && !places.empty(); ++j) {
      const rod::Parameter& parameter = fine.parameters()[j];
      if (parameter.kind == rod::ParameterKind::kLoadForce &&
          (shares.row(parameter.index - FineRod::kFirstStation).array() > 0.0).any())
        which[j] = true;
    }
    if (which == wanted) return;
    wanted = which;
    columns.clear();
    std::vector<rod::Parameter> parameters;
    for (std::size_t j = 0; j < which.size(); ++j) {
      if (!which[j]) continue;
      columns.push_back(static_cast<Eigen::Index>(j));
      parameters.push_back(fine.parameters()[j]);
    }
    derivatives.emplace(fine.layout(), bodies_and_stations(arm), parameters,
                        solver_options(1e-10, kIntegrated));
  }

  /// The rod of a block, as it was made last.
  struct Made {
    std::size_t block;
    bool made;  ///< its inputs are within the laws
    const Instant& instant;
    const Shape& shape;  ///< with its motion
    const std::vector<Memory>& memories;
  };

  /// Makes the rod of each block that has a prediction, with the shapes and motions of those.
  /// @param driven_alike whether their instants are the same, too
  /// @param use called with each of them, Made
  template <typename Use>
  void walk(const arm::Arm& arm, const std::vector<Present>& effects, const Dynamics& dynamics,
            const TrialData& trial, const std::vector<Predicted>& baseline, bool driven_alike,
            const Use& use) {
    Memories memories(effects);
    memories.begin(arm, fine);
    const bool moves = std::any_of(effects.begin(), effects.end(),
                                   [](const Present& present) { return present.effect->needs_motion(); });
    const Sluggishness sluggish = sluggishness(dynamics, effects);
    const bool anew = swings_otherwise(dynamics, effects, baseline) || (moves && !has_motion(baseline));
    std::optional<Series> series;
    if (anew || !driven_alike) series = driven(arm, effects, trial.series);
    std::vector<Instant> instants;
    if (!driven_alike) instants = instants_of(arm, *series, trial);
    const std::vector<Motion> motion =
        anew ? motions(dynamics, sluggish, trial, *series, baseline) : std::vector<Motion>();
    for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
      const Predicted& base = baseline[k];
      if (!base.solved) continue;
      const Instant& instant = driven_alike ? base.instant : instants[k];
      if (k > 0 && instant.dt_s <= 0.0) memories.rest();
      std::optional<Shape> moved;
      if (anew) {
        moved = base.shape;
        moved->motion = motion[k];
      }
      const Shape& shape = moved ? *moved : base.shape;
      const bool made = make(arm, effects, memories.all(), dynamics, instant, &shape, shape.motion, rod);
      use(Made{k, made, instant, shape, memories.all()});
      memories.remember(arm, fine, instant, shape);
    }
  }

  /// Whether the arm swings in both alike.
  bool alike(const Predicted& a, const Predicted& b) const {
    if (a.instant.payload_kg != b.instant.payload_kg) return false;
    for (std::size_t j = 0; j < a.rest.stations.size(); ++j)
      if ((a.rest.stations[j] - b.rest.stations[j]).norm() > kAlikeShape * fine.length_m()) return false;
    const auto off = (a.rest.compliance - b.rest.compliance).array().abs();
    return !(off > kAlikeStiffness * a.rest.compliance.array()).any();
  }

  /// Whether between the same equilibria.
  static bool swings_otherwise(const Dynamics& dynamics, const std::vector<Present>& effects,
                               const std::vector<Predicted>& baseline) {
    const Sluggishness sluggish = sluggishness(dynamics, effects);
    return dynamics.modes != nullptr &&
           std::any_of(baseline.begin(), baseline.end(),
                       [&](const Predicted& block) { return block.solved && !(block.sluggish == sluggish); });
  }

  static bool has_motion(const std::vector<Predicted>& path) {
    return std::any_of(path.begin(), path.end(),
                       [](const Predicted& block) { return !block.shape.motion.velocity_m_s.empty(); });
  }

  /// What forces on the stations do to the rod that was made last; nothing where it has no equilibrium.
  std::optional<Flexibility> flexibility(const arm::Arm& arm, const Predicted& at) {
    const auto n = static_cast<Eigen::Index>(fine.stations()), b = static_cast<Eigen::Index>(bodies.size());
    if (!by_forces) {
      std::vector<rod::Parameter> forces;
      for (int j = 0; j < fine.stations(); ++j)
        for (const int axis : {0, 1, 2})
          forces.push_back({rod::ParameterKind::kLoadForce, FineRod::kFirstStation + j, axis});
      by_forces.emplace(fine.layout(), bodies_and_stations(arm), forces, solver_options(1e-8, kIntegrated));
    }
    if (by_forces->solve(rod, at.q_tip) != rod::SolveStatus::kConverged) return std::nullopt;
    Flexibility f;
    f.positions.resize(3 * n, 3 * n);
    f.rotations.resize(3 * n, 3 * n);
    f.bodies.resize(6 * b, 3 * n);
    for (Eigen::Index i = 0; i < b; ++i) {
      const int body = static_cast<int>(i);
      f.bodies.middleRows<3>(3 * i) = position_by_rod(bodies[static_cast<std::size_t>(i)], body, *by_forces);
      f.bodies.middleRows<3>(3 * (b + i)) = tangent_by_rod(body, *by_forces);
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      const int station = static_cast<int>(b + j);
      f.positions.middleRows<3>(3 * j) = by_forces->dp(station);
      f.rotations.middleRows<3>(3 * j) = by_forces->drotation(station);
      f.q.push_back(by_forces->station(station).q);
    }
    return f;
  }

  /// How far a block's bodies, or where none is seen all of the arm, lie from another shape of it.
  static double moved_m(const Predicted& now, const Predicted& from) {
    if (now.p.cols() > 0) return (now.p - from.p).colwise().norm().maxCoeff();
    double most_m = 0.0;
    for (std::size_t j = 0; j < now.shape.stations.size(); ++j)
      most_m = std::max(most_m, (now.shape.stations[j].p - from.shape.stations[j].p).norm());
    return most_m;
  }

  /// Where bodies of a block are seen; one column per body of the arm.
  Eigen::Matrix3Xd seen(const arm::Arm& arm, const std::vector<Present>& effects, const Instant& instant,
                        const Block& block, const Predicted& base) const {
    Bodies seen;
    seen.p = seen.u = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(bodies.size()));
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
      seen.u.col(b) = nearest->u;
    }
    observe(arm, effects, instant, seen);
    return seen.p;
  }

  std::vector<bool> wanted;
  std::vector<Eigen::Index> columns;
  std::optional<rod::Solver> derivatives;  ///< by those
  std::optional<rod::Solver> by_forces;    ///< on the stations
};

ExtendedModel::ExtendedModel(const arm::Arm& arm) : impl_(std::make_unique<Impl>(arm)) {}
ExtendedModel::~ExtendedModel() = default;
ExtendedModel::ExtendedModel(ExtendedModel&&) noexcept = default;
const FineRod& ExtendedModel::rod() const {
  return impl_->fine;
}

void ExtendedModel::predict(const arm::Arm& arm, const std::vector<Present>& effects,
                            const Dynamics& dynamics, const TrialData& trial,
                            const std::vector<Predicted>* start, std::vector<Predicted>& out,
                            bool only_where_solved) {
  Impl& m = *impl_;
  const Series series = Impl::driven(arm, effects, trial.series);
  const std::vector<Instant> instants = Impl::instants_of(arm, series, trial);
  const bool moves = dynamics.inertia || dynamics.viscoelastic_lag_s != 0.0 ||
                     std::any_of(effects.begin(), effects.end(),
                                 [](const Present& present) { return present.effect->needs_motion(); });
  std::vector<Predicted> path, resting;
  std::vector<Motion> motions;
  const Sluggishness sluggish = Impl::sluggishness(dynamics, effects);
  const int passes = moves ? kPasses : 1;
  for (int pass = 0; pass < passes; ++pass) {
    const bool moving = pass > 0;
    if (moving) {
      resting = std::move(path);
      motions = Impl::motions(dynamics, sluggish, trial, series, resting);
    }
    path.assign(trial.blocks.size(), {});
    Memories memories(effects);
    memories.begin(arm, m.fine);
    Feedback feedback;
    TipGuess guess(start);
    Lost lost;
    const Predicted* last = nullptr;
    for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
      Predicted& now = path[k];
      now.instant = instants[k];
      if (k > 0 && now.instant.dt_s <= 0.0) {
        memories.rest();
        lost.end();
      }
      const Motion motion = moving ? motions[k] : Motion();
      const Shape* near = last != nullptr ? &last->shape : nullptr;
      if (start != nullptr && (*start)[k].solved)
        near = moving ? &(*start)[k].shape : (*start)[k].rest_shape.get();
      else if (moving && resting[k].solved)
        near = &resting[k].shape;
      const Impl::Context context{arm, memories.all(), dynamics, motion, feedback};
      const auto q_tip = guess.of(k, moving && resting[k].solved ? &resting[k] : nullptr);
      const bool tried = !only_where_solved || start == nullptr || (*start)[k].solved;
      now.solved = tried && lost.looks() && m.settle(context, effects, q_tip ? &*q_tip : nullptr, near, now);
      if (!now.solved) {
        last = nullptr;
        guess.lost();
        if (tried) lost.another();
        continue;
      }
      last = &now;
      lost.end();
      guess.found(now.q_tip);
      now.sluggish = sluggish;
      m.describe(arm, effects, trial.blocks[k], moving && resting[k].solved ? &resting[k] : nullptr, now);
      memories.remember(arm, m.fine, now.instant, now.shape);
    }
  }
  out = std::move(path);
}

ExtendedModel::Varied ExtendedModel::vary(const arm::Arm& arm, const std::vector<Present>& effects,
                                          const Dynamics& dynamics, const TrialData& trial,
                                          const std::vector<Predicted>& baseline, bool driven_alike) {
  Impl& m = *impl_;
  Varied varied;
  varied.values.resize(static_cast<Eigen::Index>(m.fine.parameters().size()),
                       static_cast<Eigen::Index>(trial.blocks.size()));
  std::vector<Eigen::Index> begins;
  Eigen::Index bodies = 0;
  for (const Block& block : trial.blocks) {
    begins.push_back(bodies);
    bodies += static_cast<Eigen::Index>(block.bodies.size());
  }
  varied.seen = Eigen::MatrixXd::Zero(3, bodies);
  for (std::size_t k = 0; k < baseline.size(); ++k)
    if (!baseline[k].solved) varied.values.col(static_cast<Eigen::Index>(k)).setZero();
  varied.swings = Impl::swings_otherwise(dynamics, effects, baseline);
  const bool observed = std::any_of(effects.begin(), effects.end(),
                                    [](const Present& present) { return present.effect->observes(); });
  const auto use = [&](const Impl::Made& now) {
    const std::size_t k = now.block;
    const Block& block = trial.blocks[k];
    const Predicted& base = baseline[k];
    // What drives the arm beyond what the laws bear changes nothing.
    auto values = varied.values.col(static_cast<Eigen::Index>(k));
    if (now.made)
      m.fine.values(m.rod, values);
    else
      values = base.values;
    if (!observed) return;
    const Eigen::Matrix3Xd seen = m.seen(arm, effects, now.instant, block, base);
    for (std::size_t i = 0; i < block.bodies.size(); ++i)
      varied.seen.col(begins[k] + static_cast<Eigen::Index>(i)) =
          seen.col(block.bodies[i].body) - base.p.col(static_cast<Eigen::Index>(i));
  };
  m.walk(arm, effects, dynamics, trial, baseline, driven_alike, use);
  return varied;
}

TrialModes ExtendedModel::modes(const arm::Arm& arm, const std::vector<Present>& effects,
                                const Dynamics& dynamics, const TrialData& trial,
                                const std::vector<Predicted>& predicted) {
  Impl& m = *impl_;
  TrialModes list(trial.blocks.size());
  std::shared_ptr<const Modes> last;
  const Predicted* of_last = nullptr;
  m.walk(arm, effects, dynamics, trial, predicted, true, [&](const Impl::Made& now) {
    if (!now.made) return;
    const std::size_t k = now.block;
    if (of_last == nullptr || !m.alike(*of_last, predicted[k])) {
      const std::optional<Flexibility> flexibility = m.flexibility(arm, predicted[k]);
      if (!flexibility) return;
      Modes modes = modes_of(*flexibility, predicted[k].rest, kModes);
      if (modes.stiffness.size() == 0) return;
      last = std::make_shared<const Modes>(std::move(modes));
      of_last = &predicted[k];
    }
    list[k] = last;
  });
  return list;
}

void ExtendedModel::differentiate(const arm::Arm& arm, const std::vector<Present>& effects,
                                  const Dynamics& dynamics, const TrialData& trial,
                                  const std::vector<bool>& wanted, std::vector<Predicted>& predicted) {
  Impl& m = *impl_;
  const std::vector<Memory> nothing(effects.size());
  m.want(arm, HeldPlaces(m.fine, effects, nothing), wanted);
  m.walk(arm, effects, dynamics, trial, predicted, true, [&](const Impl::Made& now) {
    const auto modes = [&](std::size_t block) {
      return dynamics.modes != nullptr && block < dynamics.modes->size() ? (*dynamics.modes)[block].get()
                                                                         : nullptr;
    };
    const std::size_t k = now.block;
    const HeldPlaces places(m.fine, effects, now.memories);
    predicted[k].solved =
        now.made && m.differentiate(trial.blocks[k], places, now.shape, modes(k), modes(k + 1), predicted[k]);
  });
}

}  // namespace softarm::model
