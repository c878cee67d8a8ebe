// Where in its swing an arm is, frame by frame, from what was seen of it so far.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "model/vibration.h"
#include "problem.h"
#include "softarm/arm/arm.h"
#include "white_noise.h"

namespace softarm::estimate {

/// A Kalman filter over the modes of vibration of lowest frequency. Of each mode it has where the arm is, s,
/// as its bodies show it, how fast it goes there, and where it would come to rest, g: d = s - g is what it is
/// beyond its equilibrium. Between frames modes swing exactly (model::Oscillator), and g goes with the inputs
/// as the laws say; by what else it moves is a random walk. What no swing explains, as when a hand lets go,
/// makes g unknown, and the next part of a second tells it anew.
///
/// By d'Alembert the arm is at rest under another gravity: that which would displace its modes so. At rest it
/// is none.
class SwingFilter {
 public:
  explicit SwingFilter(const arm::Arm& arm);

  void forget();
  bool has_modes() const { return modes_.stiffness.size() > 0; }
  /// What is known goes over into these modes. @param lag_s of the wall's bending
  void set_modes(const model::Modes& modes, double lag_s);
  /// A frame. @param moved by what the inputs have moved the equilibrium of the bodies since the frame
  /// before, m
  void add(double stamp_s, const std::vector<Observation>& bodies, const WhiteNoise& noise,
           const Eigen::Matrix3Xd& moved);

  /// It is beyond its equilibrium by more than chance, or was within half a swing, or that is not known.
  bool moving() const { return moving_; }
  /// By which gravity the arm at rest differs from the true one, m/s^2, rod's base frame.
  Eigen::Vector3d gravity() const;
  /// Standard deviations of it in independent directions, the columns of 3 x modes.
  Eigen::MatrixXd gravity_by_error() const;
  /// What these do to a body's place, and to the tangent there: 3 x modes.
  Eigen::Matrix3Xd position_by_error(int body) const;
  Eigen::Matrix3Xd tangent_by_error(int body) const;

 private:
  void begin(const Eigen::VectorXd& s);
  void predict(double dt_s, const Eigen::VectorXd& moved);
  void update(const Eigen::VectorXd& s, const Eigen::MatrixXd& variance);
  void judge(double stamp_s);
  /// In modes, of displacements of bodies; those that are not finite are not seen.
  struct InModes {
    Eigen::VectorXd s;
    Eigen::MatrixXd variance;
  };
  std::optional<InModes> in_modes(const Eigen::Matrix3Xd& displaced, const WhiteNoise* noise) const;
  /// Of what is seen of a frame, from the reference.
  Eigen::Matrix3Xd displaced(const std::vector<Observation>& bodies);
  Eigen::MatrixXd covariance_beyond() const;
  Eigen::VectorXd beyond() const;
  /// The same as an estimate: nearer to none, the less sure it is that there is any (James and Stein 1961).
  Eigen::VectorXd most_probable() const;
  /// Square root of the covariance of d.
  Eigen::MatrixXd root_beyond() const;
  double largest_m(Eigen::Index mode) const;

  const double length_m_;
  const std::size_t bodies_;
  model::Modes modes_;
  Eigen::VectorXd damping_;
  Eigen::MatrixXd by_gravity_;  ///< modes x 3: displacement at rest
  Eigen::Matrix3Xd reference_;  ///< of the bodies, where s is 0
  Eigen::Matrix3Xd last_;       ///< of the bodies as last displaced; not finite: not seen
  std::optional<double> last_s_;
  bool known_ = false;     ///< state_ is
  Eigen::VectorXd state_;  ///< s, its rate, g
  Eigen::MatrixXd covariance_;
  double moving_until_s_ = -1e300;
  bool moving_ = false;
};

}  // namespace softarm::estimate
