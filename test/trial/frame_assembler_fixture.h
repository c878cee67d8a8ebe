// An arm with a base and three rings, and samples of it.
#pragma once

#include <cmath>
#include <random>

#include "trial/frame_assembler.h"

namespace softarm::testing_assembler {

constexpr double kRate = 240.0;

inline arm::Arm three_ring_arm() {
  arm::Arm arm;
  arm.name = "three_rings";
  arm.base.body = "base";
  arm.segments.resize(1);
  arm.segments[0].length_m = 0.2;
  for (int i = 0; i < 3; ++i) {
    arm::MeasuredBody body;
    body.name = "ring_" + std::to_string(i + 1);
    body.arclength_m = 0.2 * (i + 1) / 3.0;
    body.position_sd_m = 2e-4;
    body.orientation_sd_rad = 0.01;
    body.orientation_usable = i == 2;
    arm.bodies.push_back(body);
  }
  for (const char* name : {"chamber_1", "vacuum"}) {
    arm::ScalarInput input;
    input.name = name;
    input.topic = std::string("/pressure/") + name;
    input.type = "sensor_msgs/FluidPressure";
    if (input.name == "vacuum") input.kind = arm::InputKind::kVacuum;
    arm.inputs.scalars.push_back(input);
  }
  return arm;
}

/// For tests of bodies: frames close without waiting for the inputs, which never come.
inline trial::FrameAssembler::Params without_waiting() {
  trial::FrameAssembler::Params params;
  params.input_wait_s = 0.0;
  return params;
}

/// Feeds slowly moving bodies with noise, each sample a function of body and index alone.
class Feeder {
 public:
  explicit Feeder(trial::FrameAssembler& assembler, double start_s = 1000.0)
      : assembler_(assembler), start_s_(start_s) {}

  double stamp(double k) const { return start_s_ + k / kRate; }

  Eigen::Vector3d position(int body, int k) const {
    std::mt19937 random(static_cast<unsigned>(k * 16 + body + 1));
    std::normal_distribution<double> noise(0.0, 2e-4);
    const double swing = body < 0 ? 0.0 : 0.05 * body * std::sin(2.0 * k / kRate);
    return {0.3 + swing + noise(random), 0.1 + noise(random), 1.0 - 0.07 * (body + 1) + noise(random)};
  }

  void body_at(int body, double stamp_s, int k, double sign = 1.0) {
    const double angle = 0.1 * std::sin(2.0 * k / kRate);
    Eigen::Quaterniond q(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
    q.coeffs() *= sign;
    assembler_.add_body(body, stamp_s, position(body, k), q);
  }
  void body(int body, int k, double sign = 1.0) { body_at(body, stamp(k), k, sign); }
  void frames(int from, int to) {
    for (int k = from; k < to; ++k) {
      for (int b = -1; b < 3; ++b) body(b, k);
    }
  }

 private:
  trial::FrameAssembler& assembler_;
  double start_s_;
};

}  // namespace softarm::testing_assembler
