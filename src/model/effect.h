// What a model may leave out: one effect of the catalogue.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fine_rod.h"
#include "softarm/arm/arm.h"
#include "softarm/model/present.h"

namespace softarm::model {

/// A number of an effect.
struct Parameter {
  std::string symbol;  ///< with its unit where it has one: "compliance_rad_per_nm"
  std::string unit;    ///< SI, as a person writes it: "rad/(N m)"; "1" for a share
  std::string description;
  double low = 0.0, high = 0.0;  ///< physically possible
  /// Of a size (see Effect::sizes): standard deviation expected before anything was measured. Else a usual
  /// value.
  double usual = 0.0;
  bool counts = false;  ///< it numbers something, and cannot be varied a little
  bool along = false;   ///< a length along the arm, as of a place from the base: no larger than the arm's
  /// Fits leave it as it is: trials tell values apart that differ much, but a small change of it changes
  /// hardly anything. Those that are worth a fit are in the grid, or Effect::like() has them.
  bool held = false;
};

/// Where an effect sits in the model; also who its natural rivals are.
enum class Family { kConstitutive, kBoundary, kLoad, kActuation, kSensor, kMemory };

struct Info {
  std::string id;  ///< stable; as in reports
  std::string
      description;     ///< what it is, for a user, beginning in lower case: "the base turns under the load"
  std::string law;     ///< as an equation; its parameters by their names, less the unit
  std::string source;  ///< where the law, or what it is made of, is from
  Family family = Family::kConstitutive;
  /// The first `sizes` are sizes: 0 where the effect is absent, and small ones act in proportion. The others
  /// (thresholds, places, time constants) say what it is like.
  std::vector<Parameter> parameters;
  int sizes = 1;
  /// Ids of what it is most easily mistaken for, and of the constants of the arm that absorb it.
  std::vector<std::string> rivals, absorbed_by;
  /// Where bodies and base are: of sizes within the arm file's placement_sd every arm has it.
  bool of_placement = false;
  /// Its one size is how far the clock of the bodies is ahead of the inputs', s.
  bool of_clocks = false;
  /// Its first size is a delay between inputs and bodies, s: small ones act alike, however they come about.
  bool delays = false;
  /// Its sizes are the rate at which the clock of the bodies gets ahead of the inputs' over the session, and
  /// by how much it is when the session begins, s.
  bool of_clock_rates = false;
};

/// A number of what a trial finds in the memory of an effect. Nobody knows it; 0 is at rest.
struct StartNumber {
  std::string name;  ///< of what: a segment and axis, an input, a tendon
  std::string unit;  ///< SI
  double sd = 0.0;   ///< standard deviation expected before anything was measured
};

/// What drives one trial, at each of its frames. Effects on inputs change it.
struct Series {
  Eigen::VectorXd t_s;     ///< by the clock of the bodies, from the trial's first frame
  Eigen::MatrixXd inputs;  ///< one row per Arm::inputs.scalars, in their units; one column per frame
  /// What the actuation's moments follow; the same as inputs unless an effect says otherwise.
  Eigen::MatrixXd moment_inputs;
  Eigen::VectorXd payload_kg;
  double session_s = 0.0;      ///< when t_s is 0, since the earliest trial began
  Eigen::VectorXd start = {};  ///< Present::start of the effect whose drive() is called
};

/// How the arm moves, rod's base frame: from the equilibria of the instants before and after. Empty where
/// there are none.
struct Motion {
  std::vector<Eigen::Vector3d> velocity_m_s, acceleration_m_s2;  ///< of the stations
  std::vector<Eigen::Vector3d> curvature_rate;                   ///< of u at the pieces' middles, 1/(m s)
};

/// What makes an arm swing otherwise than its masses and its wall do.
struct Sluggishness {
  double mass_share = 0.0;  ///< that moves along beside what is weighed, as a share of it
  double lag_s = 0.0;       ///< of the wall's bending
  bool operator==(const Sluggishness& o) const { return mass_share == o.mass_share && lag_s == o.lag_s; }
};

/// The equilibrium at one instant, in the rod's base frame.
struct Shape {
  std::vector<rod::RodState> middles;                        ///< of the pieces
  std::vector<rod::RodState> stations;                       ///< of their ends; the last is the tip
  Eigen::Vector3d base_moment_nm = Eigen::Vector3d::Zero();  ///< m of the rod at s = 0
  Eigen::Vector3d base_force_n = Eigen::Vector3d::Zero();
  Motion motion;
};

/// Position at arclength s of a shape: cubic between stations. @param rod its base is looked at
Eigen::Vector3d position_at(const FineRod& fine, const rod::Rod& rod, const Shape& shape, double s_m);
/// Its derivative, 3 x P, by the parameters of a solver of that rod: by way of the stations alone, as if the
/// base itself stayed.
/// @param first_end the solver's station at the end of the first piece; those of the others follow
Eigen::Matrix3Xd position_by_stations(const FineRod& fine, const rod::Rod& rod, const Shape& shape,
                                      double s_m, const rod::Solver& solver, int first_end);

/// One instant of a trial: means over a short time.
struct Instant {
  double t_s = 0.0;   ///< since the trial's first frame
  double dt_s = 0.0;  ///< since the instant before; 0: none, memories begin anew
  Eigen::VectorXd inputs, moment_inputs;
  double payload_kg = 0.0;
  Eigen::Vector3d gravity_base = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_base_mocap = Eigen::Quaterniond::Identity();  ///< turns mocap's axes into the base's
  Eigen::Vector3d base_in_mocap_m = Eigen::Vector3d::Zero();
  /// By the walls of the segments, of what the laws say: curvature (x, y) and length. Empty: nothing.
  std::vector<Eigen::Vector3d> kept_back = {};
  double session_s = 0.0;  ///< since the first trial's beginning where the stamps say it, else t_s
};

/// What an effect remembers within a trial, in whatever order it likes; empty at the beginning of one that
/// finds the arm at rest.
using Memory = std::vector<double>;

/// Predicted bodies, one column per Arm::bodies: positions in the rod's base frame, and the sections there.
struct Bodies {
  Eigen::Matrix3Xd p;
  std::vector<Eigen::Quaterniond> q;
  Eigen::Matrix3Xd u;  ///< curvature and twist of those sections, 1/m, in their frames
};

/// When act() is called. Effects of a later stage go by what those before make of each piece, its linear law
/// and its moment, whatever order a model has them in.
enum class Stage {
  kPieces,  ///< makes the pieces; in the order of the model
  kSides,   ///< changes compliances by where a piece is bent to, and leaves it linear
  /// Bends pieces by a law that is not linear, each by what the one before made of the curvature at the
  /// moment that acts. Such laws do not commute: they act in the order of the catalogue, whose last ones
  /// remember the curvature that comes of all.
  kLaws,
};

/// One effect. Stateless: values and memories are arguments. All hooks do nothing by default, and nothing
/// where the sizes are 0.
class Effect {
 public:
  virtual ~Effect() = default;
  virtual const Info& info() const = 0;
  /// Place in the catalogue: effects act on the inputs in this order.
  int rank() const { return rank_; }
  void set_rank(int rank) { rank_ = rank; }

  /// Whether the arm has what the effect acts on (tendons, a vacuum, ...).
  virtual bool applies_to(const arm::Arm&) const { return true; }
  /// Whether the arm has what one of its numbers is about: the fifth sensor of four is no unknown.
  virtual bool has_parameter(const arm::Arm&, int /*parameter*/) const { return true; }
  /// What to look for: values of the parameters that are no sizes, all combinations that differ enough to be
  /// separated; sizes 0. One entry of zeros and usual values by default.
  virtual std::vector<Values> grid(const arm::Arm& arm, const FineRod& rod) const;
  /// Its values where it does nearly what another effect does at its own: a wall and a hose that grows taut.
  /// Or what it does itself with another value of a number that fits hold. Nothing where it cannot.
  virtual std::optional<Values> like(const Effect& /*other*/, const Values& /*of_other*/,
                                     const FineRod&) const {
    return std::nullopt;
  }

  /// Whether it changes what drives a trial; only then drive() is called.
  virtual bool drives() const { return false; }
  virtual void drive(const arm::Arm&, const Values&, Series&) const {}
  /// Changes the rod of one instant, which the laws have actuated.
  /// The shape is the equilibrium: of the instant before this effect where it is looked for, of this instant
  /// with all effects where it is modelled. Only for those that need it, else nullptr
  virtual void act(const arm::Arm&, const FineRod&, const Values&, const Instant&, const Shape*,
                   const Memory&, rod::Rod&) const {}
  virtual bool needs_shape() const { return false; }
  virtual Stage stage() const { return Stage::kPieces; }
  /// Whether it holds places of the arm, each with a force that depends on where that place is, and on
  /// nothing else of the shape: a wall, a hose. It needs the shape, and act() leaves these forces out.
  virtual bool holds_places() const { return false; }
  /// Those places, m from the base: as many whatever the sizes are.
  virtual std::vector<double> held_places_m(const FineRod&, const Values&) const { return {}; }
  /// The force on one of them, N, rod's base frame.
  /// @param which of held_places_m()
  /// @param place_m where that place is, rod's base frame
  virtual Eigen::Vector3d holding_force_n(const FineRod&, const Values&, std::size_t /*which*/,
                                          const Eigen::Vector3d& /*place_m*/, const Memory&) const {
    return Eigen::Vector3d::Zero();
  }
  /// Whether fits have to take differences of whole predictions. The first order is what changes of the rod
  /// while shapes stay, times derivatives by the rod: those have the answer of forces that hold places, and
  /// of laws whose slope act() hands to the pieces. It leaves out what else act() or holding_force_n() make
  /// of a change of the shape, or of shapes that are remembered.
  virtual bool needs_whole_derivatives(const Values&) const { return needs_shape(); }
  /// Of one that needs the shape: whether what it makes of a small change of it hardly differs from one
  /// instant to the next. A stop that is suddenly reached does not.
  virtual bool answers_evenly() const { return false; }
  /// Whether act() or remember() look at Shape::middles.
  virtual bool needs_strains() const { return needs_shape() || remembers(); }
  /// Whether it changes one piece of a segment otherwise than another, or acts between their ends: then the
  /// arm is cut into many.
  virtual bool varies_along() const { return true; }
  /// Whether act() looks at Shape::motion.
  virtual bool needs_motion() const { return false; }
  /// What act() makes of motion, for the swings that it changes.
  virtual Sluggishness sluggishness(const Values&) const { return {}; }
  /// Takes notice of an instant that is over.
  virtual bool remembers() const { return false; }
  virtual void remember(const arm::Arm&, const FineRod&, const Values&, const Instant&, const Shape&,
                        Memory&) const {}
  /// What a trial may find of it that is not at rest; forgotten as its law says.
  virtual std::vector<StartNumber> starts(const arm::Arm&, const Values&) const { return {}; }
  /// The memory of one that a trial finds so; of an effect on inputs drive() has it in Series::start. Up to
  /// the first remember(), Instant::dt_s is 0.
  /// @param start one per starts(), over their sd
  virtual void begin(const arm::Arm&, const FineRod&, const Values&, const Eigen::VectorXd& /*start*/,
                     Memory&) const {}
  /// Where along the arm it sits, m from the base; nothing where it acts all along.
  virtual std::optional<std::pair<double, double>> place(const arm::Arm&, const Values&) const {
    return std::nullopt;
  }
  /// Whether it changes where bodies are seen; only then observe() is called.
  virtual bool observes() const { return false; }
  virtual void observe(const arm::Arm&, const Values&, const Instant&, Bodies&) const {}

  /// Whether drive() needs inputs from before the instant.
  virtual bool looks_back() const { return false; }
  /// Why it cannot be in a model that knows nothing of what comes later; empty: it can.
  virtual std::string live_obstacle(const Values&) const {
    return needs_motion() ? "accelerations need what comes after a frame" : "";
  }

 private:
  int rank_ = 0;
};

/// In the order in which they act on the inputs.
std::vector<Present> in_order(std::vector<Present> effects);

/// Where bodies are seen with all of these effects.
void observe(const arm::Arm& arm, const std::vector<Present>& effects, const Instant& instant,
             Bodies& bodies);

/// Of the errors of value i of a and value j of b, see Present::correlated; 0 where round-off makes one.
double correlation(const Present& a, Eigen::Index i, const Present& b, Eigen::Index j);

}  // namespace softarm::model
