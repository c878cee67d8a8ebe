#include <algorithm>

#include "choose_frames.h"
#include "compare_frames.h"
#include "law_model.h"
#include "math/statistics.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {

std::vector<FrameComparison> compare_frames(const arm::Arm& arm,
                                            const std::vector<trial::StaticFrame>& frames,
                                            const std::map<std::size_t, Eigen::VectorXd>& starts) {
  LawModel model(arm, {});
  model.set(Eigen::VectorXd());
  for (const auto& [trial, start] : starts) model.set_start(trial, start);
  std::vector<FrameComparison> list;
  Prediction predicted;
  for (const trial::StaticFrame& frame : frames) {
    // Each from nothing: the shape that the arm takes when it is loaded, whatever frame came before.
    std::optional<model::Equilibrium> equilibrium;
    if (!model.predict(frame, equilibrium, predicted)) continue;
    FrameComparison made;
    made.trial = frame.trial;
    made.stamp_s = frame.stamp_s;
    made.payload_kg = frame.payload_kg;
    made.inputs = frame.inputs;
    for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
      const trial::SeenBody& seen = frame.bodies[k];
      if (!seen.used) continue;
      made.bodies.push_back({seen.body, seen.p_base, predicted.p.col(static_cast<int>(k))});
      made.error_m += (made.bodies.back().measured_p_base - made.bodies.back().predicted_p_base).norm();
    }
    if (made.bodies.empty()) continue;
    made.error_m /= static_cast<double>(made.bodies.size());
    list.push_back(std::move(made));
  }
  return list;
}

std::vector<FrameComparison> compare(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                                     const FrameChoice& choice) {
  return compare_frames(arm, choose_frames(arm, trials, choice).frames);
}

ShapeError summarise(const std::vector<FrameComparison>& frames, double length_m) {
  ShapeError error;
  error.length_m = length_m;
  error.frames = frames.size();
  if (frames.empty()) return error;
  std::vector<double> all;
  for (const FrameComparison& frame : frames) all.push_back(frame.error_m);
  error.mean_m = math::mean(all);
  error.median_m = math::median(all);
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  error.maximum_m = *most;
  error.minimum_m = *least;
  return error;
}

ShapeError shape_error(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                       const FrameChoice& choice) {
  return summarise(compare(arm, trials, choice), arm.total_length_m());
}

}  // namespace softarm::identify
