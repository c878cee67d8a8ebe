// Frames of the last while that share bending stiffness and payload.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <vector>

#include "body_rows.h"
#include "common_errors.h"
#include "problem.h"

namespace softarm::estimate {

/// Collects what each frame's bodies say of the shared quantities z (see FrameLaw) and of the errors that
/// frames have in common (CommonErrors), and hands the next frame what all of them say together.
///
/// Frames of one posture are one measurement, see Posture; what they say is linearised anew as the shared
/// quantities move. Each time, the newest frames are compared with the rest, each by its own
/// Gauss-Newton information: where they cannot share stiffness and payload any more, the rest is forgotten.
class Window {
 public:
  /// @param changing the columns of z that a change may concern: stiffness of each segment and payload, if
  /// free
  /// @param posture_m bodies within this distance of where they were have the same posture
  Window(double length_s, std::vector<int> changing, double posture_m);

  void clear();
  int frames() const { return static_cast<int>(frames_.size()); }

  /// Forgets what is older than the window at this stamp (or newer than it: time went back).
  void advance(double stamp_s);
  /// Finds the posture of a frame with these bodies.
  /// @param passing variances of the laws' passing errors, should it be a new one
  void enter(const std::vector<Observation>& bodies, const Eigen::VectorXd& passing);

  /// What the rod of a frame stands in.
  struct Place {
    Eigen::Vector3d gravity_base = Eigen::Vector3d::Zero();
    std::optional<std::vector<arm::SegmentPrediction>> laws;
    std::optional<EffectsAt> effects;
    Eigen::Quaterniond q_tip = Eigen::Quaterniond::Identity();
  };

  struct Entry {
    double stamp_s = 0.0;
    Evidence evidence;  ///< on z, each frame's errors being its own
    BodyRows rows;
    FrameLaw law;
    Place place;
    double misfit = 1.0;  ///< chi-square of its bodies per degree of freedom
    double degrees_of_freedom = 0.0;
    Eigen::Vector3d motion = Eigen::Vector3d::Zero();  ///< as seen, and its mean square over the last swing
    Eigen::Vector3d motion_variance = Eigen::Vector3d::Zero();
  };

  /// Sums over frames of one posture.
  struct Sums {
    int frames = 0;
    Eigen::VectorXd off, weight;     ///< three a block: by what bodies are off, times its weight; the weights
    Eigen::VectorXd x;               ///< as estimated
    Eigen::VectorXd centre, jitter;  ///< of FrameLaw's
    Eigen::MatrixXd shared, gains;
    Eigen::Vector3d motion = Eigen::Vector3d::Zero(), motion_variance = Eigen::Vector3d::Zero();
    void add(const Sums& more, double sign = 1.0);
    Eigen::VectorXd mean_off() const;
    /// The frames' law on average, with `like`'s information and passing errors.
    FrameLaw mean_law(const FrameLaw& like) const;
  };
  /// Where the arm was, within posture_m. Its frames count as one, their mean, linearised at one place: a
  /// measurement that is repeated says no more of what it does not determine, while linearised at another x
  /// each time it would seem to.
  struct Posture {
    int id = 0;
    std::vector<Observation> bodies;
    Eigen::VectorXd passing;
    Sums sums;
    Place place;  ///< of its last frame
    /// As last linearised. As measured: where the mean of its estimates has the bodies, and by what these
    /// were off. The mean of what was measured lies beside the curves that bodies go through.
    BodyRows rows;
    bool changed = true;                ///< since `rows` has what was measured
    int age = 0;                        ///< of the linearisation, frames
    std::optional<BodyRows> seen_from;  ///< see see_from()
  };
  /// Postures to be linearised anew at this frame: that which was entered, and of the others those that have
  /// waited longest. Their frames said what they did about a stiffness and payload of then; about others, the
  /// differences between postures would tell what they do not hold.
  std::vector<Posture*> to_linearise();

  /// What the posture that was entered says is carried to this frame's place, where both have the same
  /// derivatives: errors that are nearly the same within a posture are not exactly so, and how they change
  /// with the shape is not to tell stiffness or payload.
  void see_from(const BodyRows& own);

  /// Belief about (x - centre, b) of a frame with the posture that was entered.
  /// @param placement, posture variances of b: of what it has for good, and in one posture
  /// @param motions where b has its motions; `posture` has those of this frame
  Evidence belief(const FrameLaw& law, const Eigen::VectorXd& placement, const Eigen::VectorXd& posture,
                  Eigen::Index motions) const;

  /// Adds a frame of the posture that was entered; one that is not finite is not added.
  void add(const Entry& entry);

  /// Time between frames as last seen, s; gaps do not count. Survives clear().
  double spacing_s() const { return spacing_s_; }

  /// Compares the newest frames, this one among them, with the rest, over several numbers of newest frames.
  /// @return true if the rest was forgotten because they contradict each other
  bool forget_before_change(const Entry& newest, const Eigen::VectorXd& law_information);

 private:
  /// What stays of a frame by itself.
  struct Frame {
    double stamp_s = 0.0;
    Evidence evidence;
    double misfit = 1.0;
    double degrees_of_freedom = 0.0;
  };
  /// Frames that leave the window together.
  struct Group {
    double first_s = 0.0;
    int posture = 0;
    Sums sums;
  };
  /// A frame of which the tip's path behind it is not known yet.
  struct Recent {
    double stamp_s = 0.0;
    int posture = 0;
    Eigen::Vector3d motion, motion_variance;
  };
  static Sums sums_of(const Entry& entry);
  /// The tip's acceleration is seen when it has been: of the frames before, too.
  void look_back(const Entry& entry);
  /// Of b's motions: of their mean over the frames of a posture.
  Eigen::Vector3d variance_of_motion(const Sums& sums) const;
  /// On (z, e, b).
  Evidence common(const Posture& posture, const FrameLaw& law) const;
  Evidence sum(std::size_t from, std::size_t to) const;
  /// By what evidence counts less for the misfit of these frames beyond the noise.
  double weight_of_misfit(std::size_t from, std::size_t to) const;
  /// Number of the first frame behind a change; 0: there is none.
  std::size_t where_changed(const Eigen::VectorXd& law_information) const;
  Posture* find(int id);
  void drop(const Group& group);
  void forget_before(double stamp_s);

  double length_s_, posture_m_;
  std::vector<int> changing_;
  double changed_;  ///< likelihood ratio (chi-square) at which a change is seen
  double spacing_s_ = 1.0 / 120.0;
  std::optional<double> last_stamp_s_;
  std::deque<Frame> frames_;
  std::deque<Group> groups_;
  std::vector<Posture> postures_;
  std::deque<Recent> recent_;
  Sums newest_;      ///< the last frame that was added
  int posture_ = 0;  ///< id of the frame's
  int postures_seen_ = 0;
};

}  // namespace softarm::estimate
