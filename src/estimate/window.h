// Frames of the last while that share bending stiffness and payload.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <vector>

#include "prior.h"

namespace softarm::estimate {

/// Collects what each frame's bodies say of the shared quantities z (see FrameLaw), and hands the next frame
/// what all of them say together.
///
/// A frame's evidence is its Gauss-Newton information at its fit. The fit itself starts from the belief of
/// the other frames, so every frame is linearised near the common optimum. Each time, the newest frames are
/// compared with the rest: where they cannot share stiffness and payload any more, the rest is forgotten.
class Window {
 public:
  /// @param changing the columns of z that a change may concern: stiffness of each segment and payload, if
  /// free
  Window(double length_s, std::vector<int> changing);

  void clear() { frames_.clear(); }
  void drop_last() { frames_.pop_back(); }
  int frames() const { return static_cast<int>(frames_.size()); }

  /// Forgets what is older than the window at this stamp (or newer than it: time went back).
  void advance(double stamp_s);

  /// Belief about z: what the laws know and what the window's frames say.
  Evidence belief(const Eigen::VectorXd& law_information) const;

  struct Entry {
    double stamp_s = 0.0;
    Eigen::VectorXd actuation_nm;  ///< of the segments by the laws, 2 each
    Eigen::Vector3d p_tip = Eigen::Vector3d::Zero();
    Evidence evidence;
    double misfit = 1.0;  ///< chi-square of its bodies per degree of freedom
    double degrees_of_freedom = 0.0;
  };
  /// Adds a frame; one that is not finite is not added.
  void add(Entry entry);

  /// Time between frames as last seen, s; gaps do not count. Survives clear().
  double spacing_s() const { return spacing_s_; }

  /// Mean actuation of the window's frames; absent without frames.
  std::optional<Eigen::VectorXd> actuation_nm() const;

  /// Acceleration of the tip over the newest quarter of a second, as far as it is more than noise, m/s^2: an
  /// arm that swings is not the static rod that is fitted to it.
  Eigen::Vector3d tip_acceleration_m_s2() const;

  /// Compares the newest frames with the rest, over several numbers of newest frames.
  /// @return true if the rest was forgotten because they contradict each other
  bool forget_before_change(const Eigen::VectorXd& law_information);

 private:
  Evidence sum(std::size_t from, std::size_t to) const;

  double length_s_;
  std::vector<int> changing_;
  double changed_;  ///< likelihood ratio (chi-square) at which a change is seen
  double spacing_s_ = 1.0 / 120.0;
  std::optional<double> last_stamp_s_;
  std::deque<Entry> frames_;
};

}  // namespace softarm::estimate
