// Frames made ready for identification: everything in the rod's base frame, everything known.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/identify/shape_error.h"

namespace softarm::identify {

/// One body of a frame, in the rod's base frame.
struct SeenBody {
  int body = 0;
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> tangent_base;  ///< where it can be trusted
  bool used = true;                             ///< false: set aside as an outlier
};

/// One frame of which only the shape is not prescribed.
struct StaticFrame {
  std::size_t trial = 0;
  double stamp_s = 0.0;
  InputValues inputs;
  double payload_kg = 0.0;
  Eigen::Vector3d gravity_base = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_base_mocap = Eigen::Quaterniond::Identity();  ///< turns mocap's axes into the base's
  std::vector<SeenBody> bodies;
};

/// Chosen frames of all trials, trial by trial, in the order of their stamps, and why the others were not.
struct FrameSet {
  std::vector<StaticFrame> frames;
  std::map<std::string, std::uint64_t> left_out;
};

/// All frames of a trial whose payload, base and inputs are known and that show a body, in the rod's base
/// frame.
/// @param trial written into them
/// @param left_out counts the others, by reason
std::vector<StaticFrame> known_frames(const Arm& arm, std::size_t trial, const std::vector<Frame>& frames,
                                      std::map<std::string, std::uint64_t>& left_out);

FrameSet choose_frames(const Arm& arm, const std::vector<Trial>& trials, const FrameChoice& choice);

}  // namespace softarm::identify
