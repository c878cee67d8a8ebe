// A trial made ready for models: what drives it at every frame, and what was seen in short means.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "effect.h"
#include "softarm/arm/arm.h"
#include "softarm/trial/trial.h"

namespace softarm::model {

/// Trials of which nothing can be compared with a model. what() says why, in one line.
class UnusableTrials : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Mean of one body over an instant, rod's base frame.
struct Seen {
  int body = 0;
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  int frames = 0;         ///< that it is the mean of
  double white_sd_m = 0;  ///< of the mean, per coordinate, as the frames' scatter says
};

/// The same of a body's tangent.
struct SeenTangent {
  int body = 0;
  Eigen::Vector3d tangent_base = Eigen::Vector3d::UnitZ();  ///< of length 1
  double white_sd_rad = 0;                                  ///< per axis across it
};

/// Frames [first, last) of the series, and the means of what was seen in them.
struct Block {
  std::size_t first = 0, last = 0;
  int means = 1;        ///< of the usual length that this one is as long as, at rest
  bool begins = false;  ///< nothing lasts over from the block before (a gap)
  /// Not to be compared: a hand was on the arm, or it swung.
  bool set_aside = false;
  Eigen::Vector3d gravity_base = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_base_mocap = Eigen::Quaterniond::Identity();  ///< turns mocap's axes into the base's
  Eigen::Vector3d base_in_mocap_m = Eigen::Vector3d::Zero();
  std::vector<Seen> bodies;           ///< none where no body was seen: the arm goes on as it is driven
  std::vector<SeenTangent> tangents;  ///< of those whose orientation can be trusted
};

struct TrialData {
  std::string name;
  double begin_s = 0.0;    ///< stamp of the first frame
  std::size_t frames = 0;  ///< in which a body was seen
  Series series;           ///< of these, and of others in between
  std::vector<Block> blocks;
};

/// Between frames, after which nothing lasts over, s.
constexpr double kLongestPause_s = 0.5;

struct Preparation {
  double block_s = 0.2;  ///< over which frames are averaged: half of it where the way of a body bends, longer
                         ///< where three frames are, or where the arm rests
  int most_blocks = 3;   ///< joined to one while the arm rests
  double before_payload_s = 0.5;  ///< of a change, and after it, nothing is compared
  double after_payload_s = 2.0;
  bool as_recorded = false;  ///< trials by when they were recorded, then by name; else as told
};

struct Prepared {
  std::vector<TrialData> trials;
  std::map<std::string, std::uint64_t> left_out;  ///< frames, by reason
  Eigen::VectorXd white_sd_m;                     ///< per body, per coordinate and frame
  Eigen::VectorXd white_sd_rad;                   ///< the same of tangents
};

/// @throws UnusableTrials where no trial has a usable frame
Prepared prepare(const arm::Arm& arm, const std::vector<trial::Trial>& trials, const Preparation& how = {});

}  // namespace softarm::model
