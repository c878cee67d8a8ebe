// A recording as it was made, sample by sample: what `check` looks at.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "softarm/trial/trial.h"

namespace softarm::trial {

/// One pose of a body, as its driver reports it. SI; nothing is corrected or left out, NaN included.
struct RecordedPose {
  double stamp_s = 0.0;
  double receipt_s = 0.0;                             ///< when the recorder had it
  Eigen::Vector3d p_mocap = Eigen::Vector3d::Zero();  ///< m
  std::optional<Eigen::Quaterniond> q_mocap;          ///< as reported, not normalised
};

/// One value: of an input (SI by the arm's unit; pressures still absolute or gauge, as reported) or of the
/// payload (kg).
struct RecordedValue {
  double stamp_s = 0.0;  ///< of the header; where the type has none, that of receipt
  double receipt_s = 0.0;
  double value = 0.0;
};

/// A topic of the arm, and what the recording has of it.
struct RecordedTopic {
  std::string topic;
  std::string type;        ///< that the arm expects
  std::string feeds;       ///< "ring_1", "chamber_1, chamber_2", "payload"
  std::string found_type;  ///< empty: the recording has no such topic
  std::uint64_t messages = 0;
  bool of_bodies = false, of_payload = false;
  bool is_base = false;      ///< without it there is no estimate at all
  std::uint64_t unread = 0;  ///< messages of that type by another definition than the one known here
  std::string unread_md5 = {};
  /// When those were received whose bytes do not fit their definition, s; not among `messages`.
  std::vector<double> undecodable_s = {};
};

/// Everything that was recorded for an arm.
struct CheckRecording {
  std::string name;  ///< for people: the bag
  std::vector<RecordedTopic> topics;
  std::map<std::string, std::string> other_topics;  ///< topic to type: what the arm does not use
  /// [0] is the base's body (empty where the base is fixed), then as Arm::bodies; in order of receipt.
  std::vector<std::vector<RecordedPose>> bodies;
  std::vector<std::vector<RecordedValue>> inputs;  ///< as Arm::inputs.scalars
  std::vector<RecordedValue> payload;
  std::vector<Frame> frames;  ///< as the estimator sees them, about ten a second
  std::string import_layout;  ///< text of the layout by which it was imported; empty: it was not
  std::vector<std::pair<double, double>> left_out;  ///< stamps between which the import left rows out as told
  /// What the assembler of frames rejected, by reason and source: "frozen ring_2".
  std::map<std::string, std::uint64_t> rejected;
};

}  // namespace softarm::trial
