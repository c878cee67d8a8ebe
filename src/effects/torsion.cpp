// The arm twists: under the loads, by 1 / GJ, and with what drives it (chambers or tendons that wind about
// it).
#include "arm/actuators/actuator.h"
#include "effects.h"

namespace softarm::effects {
namespace {

// Of the inputs' mean, where the twist is `twist_rad`.
constexpr double kPressurePa = 50e3, kTensionN = 3.0, kAngleRad = 1.0;

/// Mean of what drives a segment, over those.
double drive_of(const arm::Arm& arm, const arm::Segment& segment, const Eigen::VectorXd& inputs) {
  double sum = 0.0;
  int count = 0;
  const auto add = [&](const std::string& name) {
    for (std::size_t i = 0; i < arm.inputs.scalars.size(); ++i) {
      const arm::ScalarInput& input = arm.inputs.scalars[i];
      if (input.name != name) continue;
      sum += inputs[static_cast<Eigen::Index>(i)] / (input.kind == arm::InputKind::kTension ? kTensionN
                                                     : input.kind == arm::InputKind::kAngle ? kAngleRad
                                                                                            : kPressurePa);
      ++count;
    }
  };
  const auto add_all = [&](bool gas) {
    for (const arm::ActuatorKind* kind : arm::actuator_kinds()) {
      if (!kind->traits().drives || (kind->traits().input_kind == arm::InputKind::kPressure) != gas) continue;
      for (int i = 0; i < kind->count(segment); ++i) add(kind->input(segment, i));
    }
  };
  add_all(true);
  // Tendons of an arm that has both turn with its wall.
  if (count == 0) add_all(false);
  return count > 0 ? sum / count : 0.0;
}

class Torsion : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory&, rod::Rod& rod) const override {
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const Piece& piece = fine.pieces()[j];
      const arm::Segment& segment = arm.segments[static_cast<std::size_t>(piece.segment)];
      const double twist = values[1] * drive_of(arm, segment, instant.moment_inputs);
      rod.segments[j].torsional_compliance += values[0];
      rod.segments[j].rest_curvature_per_m.z() +=
          twist * (piece.fraction_to - piece.fraction_from) / rod.segments[j].length_m;
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_torsion() {
  return std::make_unique<Torsion>(
      Info{"torsion",
           "the arm twists, under loads across its plane or with its inputs",
           "twist = T (1/GJ + compliance) + twist u / u_0, T the torque, u the mean input",
           "Saint-Venant's torsion; S. S. Antman, Nonlinear Problems of Elasticity, 2005, "
           "doi:10.1007/0-387-27649-1",
           Family::kConstitutive,
           {{"compliance_per_nm2", "1/(N m^2)", "1/GJ beyond the arm file's", 0.0, 1e4, 30.0},
            {"twist_rad", "rad",
             "of each segment at a mean pressure of 50 kPa, tension of 3 N or servo angle of 1 rad", -3.0,
             3.0, 0.05}},
           2,
           {"bending_plane_offset", "chamber_mismatch"},
           {}});
}

}  // namespace softarm::effects
