#include "convergence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>

#include "paths.h"
#include "rig/laws.h"
#include "rig/ritz_rod.h"
#include "softarm/arm/arm_file.h"
#include "softarm/arm/laws.h"
#include "softarm/rod/solver.h"

namespace softarm::rig_accuracy {
namespace {

using Options = ConvergenceOptions;

struct Pair {
  const char *scenario, *arm;
};
constexpr Pair kPairs[] = {{"demo", "online_200mm"},
                           {"semi_physical_200mm", "semi_physical_200mm"},
                           {"single_chamber_85mm", "single_chamber_85mm"},
                           {"hybrid_85mm", "hybrid_85mm"},
                           {"cable_235mm", "cable_235mm"},
                           {"two_segment", "two_segment"}};

void print(const std::string& kind, const std::string& scenario, double value, const Errors& errors) {
  fmt::print("{},{},{},{:.3g},{:.3g}\n", kind, scenario, value, errors.worst, errors.rms());
  std::fflush(stdout);
}

/// The rod of an arm without anything hidden and with its payload at the tip.
rig::RitzRodParams rod_of(const rig::Scenario& scenario, const Eigen::Vector3d& gravity_base_m_s2) {
  rig::RitzRodParams params;
  params.pieces.clear();
  for (const rig::SegmentSpec& segment : scenario.arm.segments) {
    rig::RodPiece piece;
    piece.elements = scenario.numerics.elements;
    piece.share = segment.length_m / scenario.arm.length_m();
    piece.mass_kg = segment.mass_kg;
    piece.diameter_m = segment.diameter_m;
    params.pieces.push_back(piece);
  }
  params.tip_mass_kg = scenario.arm.tip_mass_kg;
  params.gravity_base_m_s2 = gravity_base_m_s2;
  return params;
}

double largest(softarm::arm::InputKind kind) {
  switch (kind) {
    case softarm::arm::InputKind::kPressure:
      return 40e3;
    case softarm::arm::InputKind::kVacuum:
      return 0.0;
    case softarm::arm::InputKind::kTension:
      return 2.0;
    case softarm::arm::InputKind::kAngle:
      return 0.6;
  }
  return 0.0;
}

/// At rest, hanging and level, with random inputs and payloads: the rings of the two rods.
Errors against_statics(const rig::Scenario& scenario, const arm::Arm& arm, const Options& options,
                       int elements) {
  std::mt19937_64 random(options.seed);
  const auto uniform = [&](double high) {
    return high * static_cast<double>(random() >> 11) * 0x1.0p-53;  // the same on every machine
  };
  rod::Rod ours = rod::make_rod(arm);
  std::vector<double> stations;
  for (const softarm::arm::MeasuredBody& body : arm.bodies) stations.push_back(body.arclength_m);
  rod::SolverOptions tight;
  tight.position_tolerance = 1e-9;
  rod::Solver solver(ours, stations, {}, tight);
  rig::Scenario fine = scenario;
  fine.numerics.elements = elements;
  Errors errors;
  for (int i = 0; i < options.poses; ++i) {
    softarm::arm::InputValues inputs;
    rig::Acting acting;
    for (const softarm::arm::ScalarInput& input : arm.inputs.scalars) {
      const double value = uniform(largest(input.kind));
      inputs.emplace_back(value);
      if (input.kind == softarm::arm::InputKind::kPressure) acting.pressures_pa.push_back(value);
      if (input.kind == softarm::arm::InputKind::kTension) acting.tensions_n.push_back(value);
      if (input.kind == softarm::arm::InputKind::kAngle) acting.angles_rad.push_back(value);
    }
    const double payload_kg = uniform(0.1 * arm.payload.range_kg.high);
    const auto laws = softarm::arm::predict(arm, inputs);
    if (!laws) continue;
    rod::actuate(arm, *laws, ours);
    const double g = scenario.gravity_m_s2;
    ours.gravity_m_s2 = i % 2 == 0 ? Eigen::Vector3d(0.0, 0.0, g) : Eigen::Vector3d(-g, 0.0, 0.0);
    ours.loads[rod::kPayloadLoad].mass_kg = payload_kg;
    ours.loads[rod::kPayloadLoad].s_m = arm.payload.arclength_m;
    rig::RitzRod theirs(rod_of(fine, ours.gravity_m_s2));
    rig::RitzRodInputs held;
    held.pieces.clear();
    for (const rig::SegmentSpec& segment : scenario.arm.segments) {
      const rig::Actuation a = rig::apply_laws(segment, acting);
      rig::PieceInputs piece;
      piece.length_m = a.length_m;
      piece.bending_stiffness_nm2 = a.bending_stiffness_nm2;
      piece.torsional_stiffness_nm2 = a.torsional_stiffness_nm2;
      piece.moment_section_nm = {-a.moment_nm.y(), a.moment_nm.x(), 0.0};
      piece.shear_stiffness_n = a.shear_stiffness_n;
      piece.axial_stiffness_n = a.axial_stiffness_n;
      held.pieces.push_back(piece);
    }
    held.payload_kg = payload_kg;
    if (solver.solve(ours) != rod::SolveStatus::kConverged || !theirs.settle(held)) continue;
    for (std::size_t k = 0; k < stations.size(); ++k)
      errors.add(theirs.pose(scenario.mocap.ring_fractions[k]).translation(),
                 solver.station(static_cast<int>(k)).p);
  }
  return errors;
}

/// @return the largest error with the scenario's own numerics, mm
double measure(const Pair& pair, const Options& options) {
  const std::string file = options.config + "/scenarios/" + pair.scenario + ".yaml";
  const rig::Scenario scenario = rig::parse_scenario(read(file), file);
  const int elements = scenario.numerics.elements;
  const double frame_s = 1.0 / scenario.mocap.rate_hz;
  const double step_s = step_of(scenario);

  double worst_mm = 0.0;
  const Path fine_in_space = rings(scenario, options.seconds, 4 * elements, step_s);
  for (const int n : {elements / 3, elements / 2, elements, 2 * elements}) {
    const Errors errors = compare(rings(scenario, options.seconds, std::max(2, n), step_s), fine_in_space);
    print("elements", pair.scenario, std::max(2, n), errors);
    if (n == elements) worst_mm += errors.worst;
  }
  const Path fine_in_time = rings(scenario, options.seconds, elements, step_s / 12.0);
  for (const double factor : {4.0, 2.0, 1.0, 0.5, 0.25}) {
    if (factor * step_s > frame_s * (1.0 + 1e-9)) continue;
    const Errors errors = compare(rings(scenario, options.seconds, elements, factor * step_s), fine_in_time);
    print("step", pair.scenario, factor * step_s, errors);
    if (factor == 1.0) worst_mm += errors.worst;
  }
  return worst_mm;
}

}  // namespace

int measure_convergence(const ConvergenceOptions& options) {
  fmt::print("kind,scenario,value,worst_mm,rms_mm\n");
  bool good = true;
  for (const Pair& pair : kPairs) {
    const double worst_mm = measure(pair, options);
    const std::string file = options.config + "/scenarios/" + pair.scenario + ".yaml";
    const rig::Scenario scenario = rig::parse_scenario(read(file), file);
    const std::string arm_file = options.config + "/arms/" + pair.arm + ".yaml";
    const arm::Arm arm = softarm::arm::parse_arm(read(arm_file), arm_file);
    double static_mm = 0.0;
    // A payload within the arm needs another cut of the rod than this program makes.
    if (scenario.payload.fraction == 1.0)
      for (const int n : {2, 3, scenario.numerics.elements, 2 * scenario.numerics.elements}) {
        const Errors errors = against_statics(scenario, arm, options, n);
        if (errors.count == 0) throw std::runtime_error(file + ": no pose could be compared");
        print("statics", pair.scenario, n, errors);
        if (n == scenario.numerics.elements) static_mm = errors.worst;
      }
    const bool met = worst_mm < kAllowed_mm && static_mm < kAllowed_mm;
    fmt::print(stderr,
               "{}  {}: {:.4f} mm at most in motion (elements and steps together), {:.4f} mm from rod/ at "
               "rest; allowed {}\n",
               met ? "PASS" : "FAIL", pair.scenario, worst_mm, static_mm, kAllowed_mm);
    good = good && met;
  }
  return good ? 0 : 1;
}

}  // namespace softarm::rig_accuracy
