#include "identify_tables.h"

#include <fmt/format.h>

#include <cstddef>

namespace softarm::app {
namespace {

using identify::BodyComparison;
using identify::FrameComparison;

std::string cells(const Eigen::Vector3d& p) {
  return fmt::format(",{:.7g},{:.7g},{:.7g}", p.x(), p.y(), p.z());
}

}  // namespace

std::string shapes_csv(const arm::Arm& before, const identify::Result& result,
                       const std::vector<trial::Trial>& trials, const identify::FrameChoice& choice) {
  std::string text = "trial,held_out,stamp,payload";
  for (const arm::ScalarInput& input : before.inputs.scalars) text += "," + input.name;
  text +=
      ",body,measured_x,measured_y,measured_z,before_x,before_y,before_z,after_x,after_y,after_z,error_"
      "before,"
      "error_after\n";
  const std::vector<FrameComparison> old_shapes = identify::compare(before, trials, choice);
  const std::vector<FrameComparison> new_shapes = identify::compare(result.arm, trials, choice);
  std::size_t i = 0;
  for (const FrameComparison& frame : new_shapes) {
    // Both lists are in the same order; either may lack frames for which its arm has no equilibrium.
    const auto earlier = [&](const FrameComparison& f) {
      return f.trial < frame.trial || (f.trial == frame.trial && f.stamp_s < frame.stamp_s);
    };
    while (i < old_shapes.size() && earlier(old_shapes[i])) ++i;
    const bool paired = i < old_shapes.size() && old_shapes[i].trial == frame.trial &&
                        old_shapes[i].stamp_s == frame.stamp_s &&
                        old_shapes[i].bodies.size() == frame.bodies.size();
    for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
      const BodyComparison& body = frame.bodies[k];
      const Eigen::Vector3d& measured = body.measured_p_base;
      text += fmt::format("{},{:d},{:.7f},{:.6g}", trials[frame.trial].name,
                          result.trials[frame.trial].held_out, frame.stamp_s, frame.payload_kg);
      for (std::size_t n = 0; n < before.inputs.scalars.size(); ++n) {
        const bool known = n < frame.inputs.size() && frame.inputs[n];
        text += known ? fmt::format(",{:.7g}", *frame.inputs[n]) : ",";
      }
      text += "," + before.bodies[static_cast<std::size_t>(body.body)].name + cells(measured);
      text += paired ? cells(old_shapes[i].bodies[k].predicted_p_base) : ",,,";
      text += cells(body.predicted_p_base);
      text +=
          paired ? fmt::format(",{:.6g}", (old_shapes[i].bodies[k].predicted_p_base - measured).norm()) : ",";
      text += fmt::format(",{:.6g}\n", (body.predicted_p_base - measured).norm());
    }
    if (paired) ++i;
  }
  return text;
}

std::string constants_csv(const identify::Result& result) {
  std::string text = "name,unit,initial,value,sd,scale,determined\n";
  for (const identify::Constant& c : result.constants)
    text += fmt::format("{},{},{:.9g},{:.9g},{:.6g},{:.6g},{:d}\n", c.name, c.unit, c.initial, c.value, c.sd,
                        c.scale, c.determined);
  return text;
}

}  // namespace softarm::app
