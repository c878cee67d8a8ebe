// Data and equations of RitzRod: private to the rig.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include "backbone_kinematics.h"
#include "ritz_rod.h"
#include "rod_mesh.h"

namespace softarm::rig {

/// v = (a0 x + a1 x_n + a2 x_(n-1) + a3 x_(n-2)) / dt: backward differences of order one to three.
struct Differences {
  double dt = 0.0;  ///< 0: statics, no rates at all
  double a0 = 0.0, a1 = 0.0, a2 = 0.0, a3 = 0.0;

  static Differences of_order(int order, double dt_s) {
    if (order == 1) return {dt_s, 1.0, -1.0, 0.0, 0.0};
    if (order == 2) return {dt_s, 1.5, -2.0, 0.5, 0.0};
    return {dt_s, 11.0 / 6.0, -3.0, 1.5, -1.0 / 3.0};
  }
  double rate() const { return dt > 0.0 ? a0 / dt : 0.0; }
  /// Of what is `now` and was at the three instants before, the latest first.
  template <typename Derived>
  Derived apply(const Derived& now, const Derived& last, const Derived& before, const Derived& oldest) const {
    return (a0 * now + a1 * last + a2 * before + a3 * oldest) / dt;
  }
};

/// Position and two section directors of a station, with their rates.
struct Station {
  Eigen::Matrix3d x = Eigen::Matrix3d::Zero();  ///< columns: position (m), d1, d2
  Eigen::Matrix3d v = Eigen::Matrix3d::Zero();
};

constexpr int kMostEvenSteps = 3;  ///< further back nothing is looked at

/// Everything that is remembered of an instant.
struct State {
  Eigen::VectorXd q;  ///< turn of the base (rad), coefficients of L u
  Eigen::VectorXd u;  ///< turn of the base (rad), coefficients of u (1/m)
  std::vector<Station> stations;
  Eigen::Matrix<double, 3, 2> payload = Eigen::Matrix<double, 3, 2>::Zero();  ///< off the axis: x, v
  std::vector<double> memory;                                                 ///< of the section laws
  std::vector<double> stretch_memory;                                         ///< of pieces as a whole
  std::vector<double> core_stiffness_nm2;                                     ///< per piece
};

/// The coefficients of one component of one piece's curvature: every third, as the three components take
/// turns.
struct Coefficients {
  Eigen::Index first;
  Eigen::Index count;

  using Stride = Eigen::InnerStride<3>;
  Eigen::Map<Eigen::VectorXd, 0, Stride> of(Eigen::VectorXd& all) const {
    return {all.data() + first, count, Stride()};
  }
  Eigen::Map<const Eigen::VectorXd, 0, Stride> of(const Eigen::VectorXd& all) const {
    return {all.data() + first, count, Stride()};
  }
  /// Their rows and columns.
  auto square_of(Eigen::MatrixXd& all) const {
    using Both = Eigen::Stride<Eigen::Dynamic, 3>;
    return Eigen::Map<Eigen::MatrixXd, 0, Both>(&all(first, first), count, count,
                                                Both(3 * all.outerStride(), 3));
  }
};

/// A Lobatto point of a piece whose sections differ or have laws.
struct SectionNode {
  std::size_t piece = 0;
  int first_function = 0;
  LocalBasis basis{};
  double weight = 0.0;  ///< of the piece
  SectionRatios ratios;
  std::size_t first_memory = 0;
};

/// A piece that answers as a whole.
struct RodStretch {
  std::size_t piece = 0;
  SectionRatios ratios;  ///< their means
  std::size_t first_memory = 0;
  SectionResponse response = {};  ///< of the last evaluation
};

struct RitzRod::Impl {
  explicit Impl(const RitzRodParams& rod_params);

  /// Takes inputs over: what follows from them at every station and node.
  void set_inputs(const RitzRodInputs& to);

  /// Stiffness of a piece against its component of u.
  double stiffness(std::size_t piece, int component) const {
    const PieceInputs& p = inputs.pieces[piece];
    return component == 2 ? p.torsional_stiffness_nm2 : p.bending_stiffness_nm2;
  }
  Coefficients coefficients_of(std::size_t piece, int component) const {
    const RodMesh::Piece& p = mesh.pieces()[piece];
    return {3 * p.first_function + component, p.basis.functions()};
  }
  bool base_yields() const { return mesh.leading_functions() > 0; }
  /// Of the base's damper; the turn about the tangent is held at 0 by a stiffness of no meaning.
  Eigen::Vector3d base_stiffness() const {
    const double k = params.base_stiffness_nm_per_rad.value_or(1.0);
    return {k, k, 1.0};
  }
  /// The base's spring at a turn: moment, its derivative, energy.
  struct BaseSpring {
    Eigen::Vector3d moment;
    Eigen::Matrix3d stiffness;
    double energy;
  };
  BaseSpring base_spring(const Eigen::Vector3d& turn) const;

  /// Whether the sections of a piece are all alike and linear.
  bool is_plain(std::size_t piece) const {
    return !params.pieces[piece].sections && params.pieces[piece].laws.empty();
  }
  void make_section_nodes();
  /// Elasticity, viscosity and actuation of the pieces that are not plain; takes their memory along.
  void add_sections(const Differences& d, double load);
  void factorise_sections(const Differences& d);
  double section_energy() const;

  void make_stretches();
  SectionStep step_of(const RodStretch& stretch, const Differences& d, double load) const;
  /// Pieces that answer as a whole, once the residual has their sections; takes their memory along.
  void add_stretches(const Differences& d, double load);
  void factorise_stretches();
  double stretch_energy() const;
  /// To the whole load from none, in statics.
  bool increase_load();
  /// What stretches remember of the equilibrium just found is what the next begins with. @return whether
  /// that is something else
  bool keep_stretches();

  /// Stations that a load acts on, and how much of it.
  template <typename Action>
  void for_each_loaded(const RodLoad& load, const Action& action) const {
    if (load.piece) {
      action(static_cast<std::size_t>(mesh.pieces()[*load.piece].last_station()), 1.0);
    } else {
      for (std::size_t k = 0; k < stations; ++k) action(k, arclength_m[k]);
    }
  }
  /// Forces of the loads and of a payload off the axis, at the stations.
  void add_loads(const Differences& d, double load);
  /// The moment of a payload off the axis, once the others are gathered.
  void add_payload_moment();
  void factorise_payload(double rate2);
  double load_energy() const;
  /// What a rotation of station k changes in minus the force of the whole draught on it.
  Eigen::Matrix3d draught_stiffness(std::size_t k) const;
  bool has_draught() const { return !inputs.draught_base_n_per_m.isZero(0.0); }
  bool payload_off_axis() const { return !params.payload_offset_section_m.isZero(0.0); }
  std::size_t payload_station() const {
    return static_cast<std::size_t>(
        mesh.pieces()[params.payload_piece.value_or(params.pieces.size() - 1)].last_station());
  }
  Eigen::Vector3d payload_position() const {
    const std::size_t k = payload_station();
    return kinematics.positions[k] + kinematics.rotations[k] * params.payload_offset_section_m;
  }

  Eigen::Matrix3d station_x(std::size_t k) const {
    Eigen::Matrix3d x;
    x << kinematics.positions[k], kinematics.rotations[k].leftCols<2>();
    return x;
  }

  /// The order of the differences that a step may have. The third is stable where swinging decays: not for
  /// modes with less than some 7 % of damping whose period is a few steps. Every bending mode has that where
  /// the wall lags by a step at least.
  int highest_order(double dt_s) const;
  /// now.q as it would be if it went on, where so many instants before the last are a step apart.
  void extrapolate(int even);

  /// Fills `now` from the kinematics and the instants before.
  void remember(const Differences& d);

  /// Residual of the equations of motion for now.q. @param load scale of gravity, actuation and tip force
  void evaluate(const Differences& d, double load);

  /// Adjoint of the position quadrature: forces at stations to forces on unit tangents, to moments on
  /// rotations.
  void gather_moments();

  /// Derivative of the residual, with the geometric stiffness of all forces; the second derivative of a
  /// rotation within one interval is taken at its middle, an error of higher order that only slows Newton's
  /// method a little.
  void factorise(const Differences& d);

  /// What a rotation of station k changes in minus the moment on it.
  Eigen::Matrix3d moment_stiffness(std::size_t k, double rate2) const;

  /// Newton's method on now.q from where it stands. The factors are kept as long as they serve.
  bool solve(const Differences& d, double load, bool factors_valid);

  RitzRodParams params;
  RodMesh mesh;
  BackboneKinematics kinematics;
  int n;
  std::size_t stations;
  RitzRodInputs inputs;
  std::vector<double> lengths_m;    ///< of the pieces
  std::vector<double> mass, drag;   ///< of the stations: kg, N s / m
  std::vector<double> inertia;      ///< of each of d1 and d2: that of a disc about a diameter, kg m^2
  std::vector<double> arclength_m;  ///< of the stations: what they stand for
  std::vector<double> exposed_m;    ///< likewise, of what the draught pushes in full
  std::vector<SectionNode> section_nodes;
  std::vector<SectionResponse> responses;  ///< per section node, of the last evaluation
  std::vector<double> virgin_memory;       ///< zeros
  std::vector<RodStretch> stretches;
  std::vector<double> rested_memory;            ///< of stretches, from which statics come
  std::vector<Eigen::Matrix3d> load_stiffness;  ///< per station, of the last evaluation
  Eigen::Vector3d payload_force = Eigen::Vector3d::Zero();
  State now, last, before, oldest;
  double step_s = 0.0;              ///< of the last step; 0 after settle()
  int even_steps = kMostEvenSteps;  ///< instants before the last that are a step apart, as far as they matter
  bool have_factors = false;
  double factors_rate = 0.0;  ///< of the differences that they were made with
  int iterations = 0;

  std::vector<Station> past;  ///< what the instants before add to the rates of this step
  BackboneKinematics::Vectors forces, moments;
  BackboneKinematics::Vectors tangent_forces;  ///< per node
  std::vector<Eigen::Matrix<double, 3, 2>> director_forces;
  Eigen::VectorXd residual, correction, strain_work;
  Eigen::MatrixXd matrix, scratch_a;
  Eigen::PartialPivLU<Eigen::MatrixXd> factors;
};

}  // namespace softarm::rig
