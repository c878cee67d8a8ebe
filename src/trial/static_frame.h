// Frames made ready for identification: everything in the rod's base frame, everything known.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/trial/trial.h"

namespace softarm::trial {

/// One body of a frame, in the rod's base frame.
struct SeenBody {
  int body = 0;
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> tangent_base;  ///< where it can be trusted
  bool used = true;                             ///< false: set aside as an outlier
};

/// Inputs of all frames of a trial that have them, for walls, which remember: they go straight in between.
struct DriveRecord {
  std::vector<double> stamp_s;  ///< increasing
  std::vector<arm::InputValues> inputs;
};

/// One frame of which only the shape is not prescribed.
struct StaticFrame {
  std::size_t trial = 0;
  double stamp_s = 0.0;
  arm::InputValues inputs;
  double payload_kg = 0.0;
  Eigen::Vector3d gravity_base = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_base_mocap = Eigen::Quaterniond::Identity();  ///< turns mocap's axes into the base's
  Eigen::Vector3d base_in_mocap_m = Eigen::Vector3d::Zero();
  std::vector<SeenBody> bodies;
  /// Of its trial, up to it and beyond, its own stamp among them; null where no segment has a wall.
  std::shared_ptr<const DriveRecord> drive = nullptr;
};

/// Frames that show no body: left out; or kept, and where there are no frames at all made every
/// kBlindStep_s, as long as the inputs go on: the arm does, too.
enum class Blind { kLeaveOut, kKeep };
constexpr double kBlindStep_s = 0.02;

/// All frames of a trial whose payload, base and inputs are known, in the rod's base frame.
/// @param inputs what the trial's series say at the frames' stamps (a trial without series has what its
/// frames hold), or what the frames hold: that lags by half a sample on average, much as an arm in motion
/// lags behind statics, and it is what the estimator sees
/// @param index written into them
/// @param left_out counts the others and those that show no body, by reason
enum class InputsOf { kSeries, kFrames };
std::vector<StaticFrame> known_frames(const arm::Arm& arm, std::size_t index, const Trial& trial,
                                      std::map<std::string, std::uint64_t>& left_out,
                                      InputsOf inputs = InputsOf::kSeries, Blind blind = Blind::kLeaveOut);

}  // namespace softarm::trial
