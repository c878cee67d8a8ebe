// Constants to the shapes of frames: laws, then statics, with derivatives by the constants.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <vector>

#include "arm/constant_spec.h"
#include "model/arm_rod.h"
#include "softarm/identify/identify.h"
#include "softarm/rod/solver.h"
#include "trial/static_frame.h"

namespace softarm::identify {

constexpr int kLaws = 4;  ///< of a segment: moment x, y, ln EI, length

/// The predicted frame: rows 3 k to 3 k + 2 of body k (in the order of StaticFrame::bodies).
struct Prediction {
  Eigen::Matrix3Xd p;        ///< m, one column per body
  Eigen::Matrix3Xd tangent;  ///< unit, one column per body
  Eigen::MatrixXd dp;        ///< 3 bodies x constants
  Eigen::MatrixXd dtangent;
  /// By how the trial found the walls, see LawModel::start_sd(): 3 bodies x numbers.
  Eigen::MatrixXd dp_by_start, dtangent_by_start;
  /// Laws of the segments: moment x, y (N m), ln EI, length (m); and by the constants.
  Eigen::VectorXd laws;
  Eigen::MatrixXd dlaws;
  bool near_buckling = false;
};

/// Not thread-safe.
class LawModel {
 public:
  LawModel(const arm::Arm& arm, const std::vector<ConstantRef>& constants);

  void set(const Eigen::VectorXd& theta);
  const Eigen::VectorXd& theta() const { return theta_; }

  /// How far the walls of all segments may be from the laws' values when a trial begins, base to tip, see
  /// arm::WallMemory. Empty where no segment has a wall.
  const Eigen::VectorXd& start_sd() const { return start_sd_; }
  /// How they were, of one trial; zero where it was never said.
  void set_start(std::size_t trial, const Eigen::VectorXd& start);

  /// @param state this frame's last equilibrium, by the constants; empty at first; updated where there is one
  /// @return false without one, or where the laws have no value
  bool predict(const trial::StaticFrame& frame, std::optional<model::Equilibrium>& state, Prediction& out);

  /// Derivative of a predicted body by the laws of the segments (4 per segment, in the order of
  /// Prediction::laws), valid after predict().
  void derivative_by_laws(const trial::StaticFrame& frame, Eigen::MatrixXd& dp,
                          Eigen::MatrixXd& dtangent) const;

  /// Derivative of the segments' laws by the frame's inputs, over these steps to either side; a step of 0, an
  /// absent input and one that the laws do not allow give 0.
  Eigen::MatrixXd laws_by_inputs(const trial::StaticFrame& frame, const Eigen::VectorXd& steps) const;

 private:
  /// What the walls keep back at each frame of a trial's record: of all segments, one below the other.
  struct Walk {
    std::vector<Eigen::VectorXd> lag;
    std::vector<Eigen::MatrixXd> by, by_start;
  };
  /// Prediction::laws of inputs, or nothing where they have no value.
  std::optional<Eigen::VectorXd> laws_of(const arm::InputValues& inputs) const;
  bool apply(const trial::StaticFrame& frame);
  const Walk& walk(const trial::StaticFrame& frame);
  bool walk_segment(std::size_t segment, const trial::DriveRecord& record, const Eigen::VectorXd& start,
                    Eigen::Index first_start, Walk& out) const;
  /// Takes off what the walls keep back. @return false where the frame is none of its record
  bool keep_back(const trial::StaticFrame& frame);
  /// What one unit of a constant changes of the laws of one of its segments.
  std::optional<arm::SegmentDerivative> by_constant(const ConstantRef& constant, std::size_t segment,
                                                    const arm::SegmentResponse& at,
                                                    const arm::InputReader& inputs) const;
  Eigen::MatrixXd rod_by_start() const;
  /// Adds what a constant does to the laws of one of its segments.
  bool differentiate(const arm::InputReader& inputs, int column, int segment);
  /// Derivative of a parameter of the rod where its segment's laws change.
  double parameter_derivative(const rod::Parameter& which, const arm::SegmentDerivative& by) const;
  void body_derivative(int body, const Eigen::MatrixXd& rod_by_x, Eigen::Ref<Eigen::MatrixXd> dp,
                       Eigen::Ref<Eigen::MatrixXd> dtangent) const;

  std::vector<ConstantRef> constants_;
  Eigen::VectorXd theta_;
  std::vector<arm::MeasuredBody> bodies_;
  arm::Arm arm_;  ///< with theta
  std::vector<rod::Parameter> parameters_;
  rod::Rod rod_;
  rod::Solver solver_;
  std::vector<arm::SegmentResponse> responses_;  ///< of the segments
  std::vector<arm::SegmentPrediction> laws_;
  Eigen::MatrixXd rod_by_theta_;   ///< parameters x constants
  Eigen::MatrixXd laws_by_theta_;  ///< 4 segments x constants
  Eigen::VectorXd start_sd_;
  std::map<std::size_t, Eigen::VectorXd> starts_;  ///< by trial
  std::map<std::size_t, Walk> walks_;              ///< by trial, at theta and these starts
  const Walk* walked_ = nullptr;                   ///< of the frame, null without walls
  std::size_t instant_ = 0;                        ///< its place in the record
};

}  // namespace softarm::identify
