// Samples of all inputs, in order of arrival, to frames. The live node and the offline program share it.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body_gate.h"
#include "input_rhythm.h"
#include "softarm/arm/arm.h"
#include "softarm/trial/trial.h"
#include "stamp.h"

namespace softarm::trial {

/// Groups body samples whose stamps agree within Inputs::body_sync_tolerance_s into one Frame and adds to it
/// the inputs and the payload that held at its stamp.
///
/// 1. Check the stamp: not zero, no lone outlier in time, no duplicate, not older than what was emitted. A
/// stamp that
///    goes back by more than a second, and is confirmed by a second message before the others have gone on
///    for a second where time was, is a time jump: everything but the payload is forgotten, `time_jumps`
///    counts it. Bodies of one message do not confirm one another.
/// 2. Gate the pose: finite, not all zero, unit quaternion, not frozen, not jumping (BodyGate).
/// 3. A frame closes when every expected body has reported at or after its stamp (each topic delivers in
/// order, so
///    nothing of that frame can still come), or when the newest stamp is Params::reorder_window_s past it. A
///    body that a frame waited for in vain is not expected again until it reports. At the start every body of
///    the arm is expected.
/// 4. It also waits for every input that is due: whose rhythm (InputRhythm) says that a value of the frame's
/// stamp or from before it may still be on its way. An input that a frame waited for in vain, for
/// Params::input_wait_s, is not expected again until it reports in time. Inputs without a rhythm are not
/// waited for, nor is the payload.
/// 5. Pressures, tensions and angles are held from the newest sample at or before the frame's stamp, no older
/// than
///    Inputs::input_max_age_s, the payload from the newest at or before it. The samples themselves go with
///    the first frame at or after them.
///
/// Time comes from stamps alone, never from a clock, so that a replayed bag gives the frames that the live
/// node saw; the order in which messages arrive does not matter within these waits.
class FrameAssembler {
 public:
  static constexpr int kBaseBody = -1;  ///< index of Base::body; bodies of Arm::bodies have theirs

  struct Params {
    double reorder_window_s = 0.25;  ///< wait at most so long (in stamps) for a body that is missing
    double time_jump_s =
        1.0;  ///< smaller steps back are late samples; larger steps forward need confirmation
    double input_wait_s = 0.25;  ///< wait at most so long (in stamps) for an input that is due; 0: never
    /// Frames close in take() only: who has many messages at hand adds them all before.
    bool close_when_taken = false;
    GateLimits gate;
  };

  /// Sees every sample as it is offered, before any check: what a recorder of samples needs.
  struct Tap {
    std::function<void(int body, double stamp_s, const Eigen::Vector3d& p_mocap,
                       const std::optional<Eigen::Quaterniond>& q_mocap)>
        body;
    std::function<void(int input, double stamp_s, double value)> input;
    std::function<void(double stamp_s, std::optional<double> kg)> payload;
  };

  explicit FrameAssembler(const arm::Arm& arm) : FrameAssembler(arm, Params()) {}
  FrameAssembler(const arm::Arm& arm, const Params& params);

  void set_tap(Tap tap) { tap_ = std::move(tap); }

  /// A message begins, which may hold several bodies: all samples until the next call are of it. Who never
  /// calls it adds samples that are messages of their own.
  /// @param reader what makes samples of it; several may read one message of a topic, one after the other
  void begin_message(const std::string& topic, const std::string& reader);
  /// Whether samples of this stamp, of the message that has begun, would be put aside because they are alone
  /// in their time: for who makes bodies of points, and must not lose track of them for a damaged stamp.
  bool is_alone_in_time(Stamp stamp) const;

  /// All stamps are as reported: the latencies of the arm's inputs are subtracted here.
  /// @param body index into Arm::bodies or kBaseBody
  /// @param p_mocap m, @param q_mocap body to mocap, absent if the driver gives positions only
  /// @throws std::out_of_range for a body that the arm does not have
  void add_body(int body, Stamp stamp, const Eigen::Vector3d& p_mocap,
                const std::optional<Eigen::Quaterniond>& q_mocap);
  /// The driver said that it does not see the body (occluded, not tracked): the frame does not wait for it.
  /// Counted as rejected under this reason.
  /// @throws std::out_of_range for a body that the arm does not have
  void add_missing_body(int body, Stamp stamp, const std::string& reason);
  /// Counts what an adapter could not use: "ghost", "mocap".
  void count_rejected(const std::string& reason, const std::string& source, std::uint64_t count = 1);
  /// @param value in SI as the source reports it; pressures (absolute or gauge as configured) are converted
  /// to gauge or vacuum, tensions and angles counted from their zero
  /// @throws std::out_of_range for an input that the arm does not have
  void add_input(int input, Stamp stamp, double value);
  /// @param stamp when it was said; 0 or less: it has always held
  /// @param kg absent: unknown from now on
  void add_payload(Stamp stamp, std::optional<double> kg);

  /// Closed frames in order of their stamps; each is returned once. Those of before a time jump come first.
  std::vector<Frame> take();
  /// Those of before a time jump alone, where there are any: to be answered before the jump is.
  std::vector<Frame> take_before_jump();
  /// True if take() would close a frame without a body or an input that has been on time until now. Who reads
  /// several sources, and has just been busy elsewhere, may have their messages at hand a moment later.
  bool gives_up() const;
  /// Closes what is still open, at the end of a recording.
  void flush();
  /// Samples of inputs that went with no frame yet: at the end of a recording those after the last one.
  std::vector<InputSample> take_samples();
  /// Forgets all but the payload and the counters.
  void reset();

  /// True once after each time jump: the caller resets the estimator, after take_before_jump() and before
  /// take().
  bool take_time_jump();

  /// Samples rejected so far by reason ("nan", "absurd", "all_zero", "zero_quaternion", "bad_quaternion",
  /// "frozen", "jump", "late", "duplicate", "bad_stamp", "time_gap", "time_jump", "input_nan", ...) and
  /// body or input: "frozen ring_2".
  const std::map<std::string, std::uint64_t>& rejected() const { return rejected_; }
  std::uint64_t samples() const { return samples_; }
  std::uint64_t time_jumps() const { return time_jumps_; }

  /// Distinct instants at which any body reported. Each becomes one emitted frame or is counted in
  /// dropped_frames().
  std::uint64_t frames_seen() const { return frames_seen_; }
  std::uint64_t frames_open() const { return pending_.size(); }
  /// Frames that had all their bodies but waited for an input, and how often an input was given up.
  std::uint64_t frames_that_waited() const { return frames_that_waited_; }
  const std::map<std::string, std::uint64_t>& waited_in_vain() const { return waited_in_vain_; }
  /// Frames not emitted, by reason: "no_valid_body", "time_jump", "reset".
  const std::map<std::string, std::uint64_t>& dropped_frames() const { return dropped_frames_; }

  /// Newest stamp of any body; absent before the first.
  std::optional<double> newest_s() const { return newest_s_; }
  /// Stamp of the last accepted sample of a body (or kBaseBody), or of an input.
  std::optional<double> body_accepted_s(int body) const;
  std::optional<double> input_accepted_s(int input) const;
  /// Newest good pose of the base's body in the mocap frame; absent without such a body or before the first.
  std::optional<Eigen::Isometry3d> base_body_pose() const { return base_body_pose_; }
  /// Newest stamp at which any body's pose changed: far behind newest_s() the driver repeats itself.
  std::optional<double> changed_s() const;

 private:
  struct Slot {
    bool reported = false;  // accepted or not
    Stamp stamp;
    std::optional<BodyObservation> observation;
  };
  struct Pending {
    double reference_s = 0.0;  // stamp of the first sample to arrive
    bool waited = false;       // for an input, with all bodies there
    std::vector<Slot> slots;   // base, then Arm::bodies
  };
  /// A step in time that waits for confirmation.
  struct Candidate {
    double stamp_s = 0.0;
    std::uint64_t message = 0;
    double newest_s = 0.0;  // of all bodies when it came
  };
  struct Stream {
    std::string name;
    BodyGate gate;
    bool expected = true;
    std::optional<double> newest_s;           // last stamp of this body in the present epoch
    std::optional<double> before_jump_s;      // ... and in the one before the last time jump
    std::optional<Candidate> back_candidate;  // until this body, or time, has gone on where it was
  };
  struct Input {
    InputRhythm rhythm;
    bool expected = true;
    std::optional<double> last;  // as reported
  };
  struct Value {
    Stamp stamp;
    std::optional<double> value;
    bool given = false;  // with a frame
  };

  /// What a stamp at or before the last emitted frame belongs to.
  enum class Past { kNone, kThisBodyCame, kClosed };

  bool check_time(Stream& stream, double stamp_s);
  bool is_ahead(double stamp_s) const;
  bool confirms(const std::optional<Candidate>& candidate, double stamp_s) const;
  bool confirms_step_back(double stamp_s) const;
  void reset_time(double stamp_s);
  Pending* nearest_open(double stamp_s);
  Pending* open_frame(double stamp_s);
  Past past_of(std::size_t slot, double stamp_s) const;
  std::optional<double> changed_beside(std::size_t slot) const;
  void added();
  void close_ready();
  bool awaits_body(const Pending& frame, std::size_t i) const;
  bool awaits_input(const Pending& frame, std::size_t i) const;
  bool waited_for_bodies(const Pending& frame) const;
  bool waited_for_inputs(const Pending& frame) const;
  bool bodies_complete(const Pending& frame);
  bool inputs_complete(Pending& frame);
  void emit(const Pending& pending);
  void insert(std::deque<Value>& history, const Value& value);
  static const Value* newest_at(std::deque<Value>& history, double stamp_s);
  std::vector<InputSample> samples_until(double stamp_s);
  arm::InputValues inputs_at(double stamp_s);
  std::optional<double> payload_at(double stamp_s);
  void reject(const std::string& reason, const std::string& source) { ++rejected_[reason + (" " + source)]; }
  /// Checks and books the stamp. @return the slot to fill, or null if the sample is of no use
  Slot* slot_for(std::size_t index, Stamp stamp, bool repeats);

  Params params_;
  Tap tap_;
  bool has_base_body_;
  double body_latency_s_;
  double tolerance_s_;
  arm::Range payload_range_kg_;
  double ambient_pa_;
  double input_max_age_s_;
  std::vector<arm::ScalarInput> scalars_;

  std::vector<Stream> streams_;  // base, then Arm::bodies
  std::deque<Pending> pending_;  // by reference stamp
  std::optional<Pending> last_emitted_;
  std::optional<double> newest_s_, newest_before_jump_s_, input_changed_s_;
  std::optional<Candidate> ahead_candidate_;
  double step_s_ = 0.0;        // between the last two instants; the pace stays, whatever the time
  std::uint64_t message_ = 0;  // number of the one whose samples come
  std::string message_topic_;  // empty: nobody says where messages begin
  std::vector<std::string> message_readers_;
  std::vector<std::deque<Value>> inputs_;
  std::vector<Input> input_streams_;
  std::deque<Value> payload_;
  std::vector<Frame> before_jump_, closed_;  // to be fetched

  std::optional<Eigen::Isometry3d> base_body_pose_;
  bool time_jump_ = false;
  std::map<std::string, std::uint64_t> rejected_, dropped_frames_, waited_in_vain_;
  std::uint64_t samples_ = 0, frames_seen_ = 0, frames_that_waited_ = 0, time_jumps_ = 0;
};

}  // namespace softarm::trial
