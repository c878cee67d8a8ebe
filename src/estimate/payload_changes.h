// What an arm feels of its payload while that is hung on or taken off.
#pragma once

#include <deque>
#include <optional>

namespace softarm::estimate {

/// A payload that changes is not what the arm feels: what is told of it comes before or after a hand hangs it
/// on, the hand holds it for a while, and when it lets go the arm swings. What the arm feels is off by as
/// much as the payload has changed, less with time (kPolicy.payload).
///
/// A payload that is not told but estimated shows by its estimates that it changes, as soon as the arm moves.
class PayloadChanges {
 public:
  /// @param arm_kg all that hangs on the base without a payload: changes small against it do not count
  /// @param follows_swings what the arm feels of its swinging is known: what the hand does remains
  PayloadChanges(double arm_kg, bool follows_swings) : arm_kg_(arm_kg), follows_swings_(follows_swings) {}
  void forget();
  /// A frame, whether or not it has an estimate. @param kg as told; absent: it is not
  void tell(double stamp_s, std::optional<double> kg);
  /// That frame's payload as estimated. @param variance_kg2 without what variance_kg2() adds
  /// @param alone from that frame alone; else from a window, which says the same again in the next frame
  void see(double kg, double variance_kg2, bool alone);

  /// Of what the arm feels, about what hangs on it, in the frame told last.
  double variance_kg2() const { return variance_kg2_; }
  /// It has changed by more than a trifle within kPolicy.payload.settles_s.
  bool settling() const { return last_s_ && *last_s_ < settles_until_s_; }

 private:
  struct Seen {
    double stamp_s, kg, variance_kg2;
  };
  void change(double from_kg, double to_kg);

  double arm_kg_;
  bool follows_swings_;
  std::optional<double> last_s_, told_kg_;
  double variance_kg2_ = 0.0;
  double hand_until_s_ = -1e300, settles_until_s_ = -1e300;
  std::deque<Seen> seen_;
};

}  // namespace softarm::estimate
