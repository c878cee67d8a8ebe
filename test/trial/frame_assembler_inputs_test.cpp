// What held at a frame's stamp does not depend on the order in which messages of one instant arrive.
#include <gtest/gtest.h>

#include "softarm/trial/frame_assembler.h"

namespace softarm {
namespace {

Arm one_ring_arm() {
  Arm arm;
  Segment segment;
  segment.length_m = 0.2;
  arm.segments.push_back(segment);
  MeasuredBody ring;
  ring.name = "ring_1";
  ring.arclength_m = 0.2;
  arm.bodies.push_back(ring);
  ScalarInput pressure;
  pressure.name = "chamber_1";
  arm.inputs.scalars.push_back(pressure);
  return arm;
}

std::vector<std::optional<double>> pressures(bool pressure_first) {
  const Arm arm = one_ring_arm();
  FrameAssembler assembler(arm);
  std::vector<std::optional<double>> values;
  for (int i = 0; i < 20; ++i) {
    const double stamp_s = 100.0 + 0.01 * i;
    const auto add_pressure = [&] {
      assembler.add_input(0, stamp_s, arm.inputs.ambient_pressure_pa + 1000.0 * i);
    };
    if (pressure_first) add_pressure();
    assembler.add_body(0, stamp_s, {0.01 * i, 0.001 * i, 0.2}, std::nullopt);
    if (!pressure_first) add_pressure();
    for (const Frame& frame : assembler.take()) values.push_back(frame.inputs.at(0));
  }
  assembler.flush();
  for (const Frame& frame : assembler.take()) values.push_back(frame.inputs.at(0));
  return values;
}

TEST(FrameInputs, AreTheSameWhateverArrivesFirst) {
  const auto first = pressures(true), last = pressures(false);
  ASSERT_EQ(first.size(), 20u);
  ASSERT_EQ(last.size(), 20u);
  for (std::size_t i = 0; i < 20; ++i) {
    ASSERT_EQ(first[i].has_value(), i > 0) << i;
    ASSERT_EQ(last[i].has_value(), i > 0) << i;
    if (i == 0) continue;
    EXPECT_NEAR(*first[i], 1000.0 * (static_cast<double>(i) - 1.0), 1e-6) << i;
    EXPECT_EQ(*first[i], *last[i]) << i;
  }
}

}  // namespace
}  // namespace softarm
