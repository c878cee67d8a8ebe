// Another package's program: estimates a frame of an arm and diagnoses trials of it, by the public headers
// alone.
//
//   estimate_and_diagnose <arm file>
#include <cmath>
#include <cstdio>
#include <exception>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "softarm/arm/arm_file.h"
#include "softarm/arm/laws.h"
#include "softarm/check/check.h"
#include "softarm/diagnose/diagnose.h"
#include "softarm/effects/arm_effects.h"
#include "softarm/estimate/estimator.h"
#include "softarm/identify/identify.h"
#include "softarm/monitor/mismatch_monitor.h"
#include "softarm/report/report.h"
#include "softarm/rod/solver.h"
#include "softarm/trial/trial.h"

using namespace softarm;

namespace {

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

std::vector<double> stations_of(const arm::Arm& arm) {
  std::vector<double> stations;
  for (const arm::MeasuredBody& body : arm.bodies) stations.push_back(body.arclength_m);
  return stations;
}

/// Hangs the arm by its base, and says where its bodies are at these inputs (Pa, one per chamber) and
/// payload.
class HangingArm {
 public:
  explicit HangingArm(const arm::Arm& arm)
      : arm_(arm), rod_(rod::make_rod(arm)), solver_(rod_, stations_of(arm), {}) {
    rod_.q_base = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
  }

  trial::Frame frame(double stamp_s, const arm::InputValues& inputs, double payload_kg) {
    const auto predictions = arm::predict(arm_, inputs);
    require(predictions.has_value(), "the laws say nothing at these inputs");
    rod::actuate(arm_, *predictions, rod_);
    rod_.loads[rod::kPayloadLoad].mass_kg = payload_kg;
    require(solver_.solve(rod_) == rod::SolveStatus::kConverged, "the rod was not solved");

    trial::Frame frame;
    frame.stamp_ns = trial::to_nanoseconds(stamp_s);
    frame.inputs = inputs;
    frame.payload_kg = payload_kg;
    frame.base_body = Eigen::Isometry3d(rod_.q_base);
    for (int i = 0; i < solver_.stations(); ++i)
      frame.bodies.push_back({i, solver_.station(i).p, solver_.station(i).q});
    return frame;
  }

 private:
  arm::Arm arm_;
  rod::Rod rod_;
  rod::Solver solver_;
};

/// Slow turns through all directions, seen with the noise that the arm file states.
trial::Trial turning(const arm::Arm& arm, unsigned number) {
  std::mt19937 random(number);
  HangingArm hanging(arm);
  trial::Trial trial{"trial_" + std::to_string(number), {}};
  for (int k = 0; k < 900; ++k) {
    const double t = k / 30.0, level = 2.0e4 + 5.0e3 * std::sin(0.3 * t + number);
    arm::InputValues inputs;
    for (int chamber = 0; chamber < 3; ++chamber)
      inputs.push_back(level * (1.0 + std::sin(0.5 * t + number + 2.0 * M_PI / 3.0 * chamber)));
    trial::Frame frame = hanging.frame(100.0 * number + t, inputs, number % 2 == 0 ? 0.1 : 0.0);
    for (trial::BodyObservation& body : frame.bodies) {
      std::normal_distribution<double> noise(0.0,
                                             arm.bodies[static_cast<std::size_t>(body.body)].position_sd_m);
      for (int axis = 0; axis < 3; ++axis) body.p_mocap[axis] += noise(random);
    }
    trial.frames.push_back(frame);
  }
  return trial;
}

void estimate_a_frame(const arm::Arm& arm) {
  const arm::InputValues inputs = {3.0e4, 1.0e4, 0.0};
  estimate::Estimator estimator(arm);
  const estimate::Estimate& e = estimator.estimate(HangingArm(arm).frame(1.0, inputs, 0.1));
  require(e.status == estimate::Status::kOk, "no estimate");
  const estimate::SegmentEstimate& segment = e.segments.at(0);
  const double truth = arm::predict(arm, inputs)->at(0).bending_stiffness_nm2;
  require(segment.sd_bending_stiffness_nm2.has_value(), "the stiffness is not determined");
  std::printf("%s: EI %.4f N m^2 (sd %.4f), truth %.4f\n", to_string(e.status).c_str(),
              *segment.bending_stiffness_nm2, *segment.sd_bending_stiffness_nm2, truth);
  require(std::abs(*segment.bending_stiffness_nm2 - truth) < *segment.sd_bending_stiffness_nm2,
          "a wrong stiffness");
}

void diagnose_trials(const arm::Arm& arm) {
  const std::vector<trial::Trial> trials = {turning(arm, 1), turning(arm, 2), turning(arm, 3),
                                            turning(arm, 4)};
  const diagnose::Diagnosis d = diagnose::diagnose(arm, trials);
  std::printf("%s\n", report::describe(d).c_str());
  require(d.verdict == diagnose::Verdict::kConsistent && d.effects.empty(),
          "nothing was hidden, something was found");
}

}  // namespace

int main(int argc, char** argv) try {
  require(argc == 2, "usage: estimate_and_diagnose <arm file>");
  const arm::Arm arm = arm::load_arm_file(argv[1]);
  estimate_a_frame(arm);
  diagnose_trials(arm);
  try {
    arm::load_arm_file("no_such_arm");
    require(false, "an arm that is not there was loaded");
  } catch (const arm::ArmError& e) {  // its type crosses the library's border
    std::printf("%s\n", e.what());
  }
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
