#include "softarm/identify/shape_error.h"

#include <algorithm>

#include "compare_frames.h"
#include "law_model.h"

namespace softarm::identify {

std::vector<FrameComparison> compare_frames(const Arm& arm, const std::vector<StaticFrame>& frames) {
  LawModel model(arm, {}, Eigen::VectorXd());
  model.set(Eigen::VectorXd());
  std::vector<FrameComparison> list;
  Prediction predicted;
  for (const StaticFrame& frame : frames) {
    // Each from nothing: the shape that the arm takes when it is loaded, whatever frame came before.
    std::optional<Equilibrium> equilibrium;
    if (!model.predict(frame, equilibrium, predicted)) continue;
    FrameComparison made;
    made.trial = frame.trial;
    made.stamp_s = frame.stamp_s;
    made.payload_kg = frame.payload_kg;
    made.inputs = frame.inputs;
    for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
      const SeenBody& seen = frame.bodies[k];
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

std::vector<FrameComparison> compare(const Arm& arm, const std::vector<Trial>& trials,
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
  std::sort(all.begin(), all.end());
  for (const double e : all) error.mean_m += e / static_cast<double>(all.size());
  const std::size_t middle = all.size() / 2;
  error.median_m = all.size() % 2 == 1 ? all[middle] : 0.5 * (all[middle - 1] + all[middle]);
  error.maximum_m = all.back();
  error.minimum_m = all.front();
  return error;
}

ShapeError shape_error(const Arm& arm, const std::vector<Trial>& trials, const FrameChoice& choice) {
  return summarise(compare(arm, trials, choice), arm.total_length_m());
}

}  // namespace softarm::identify
