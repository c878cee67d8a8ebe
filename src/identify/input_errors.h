// Errors in variables: what sensors of the inputs are off by, as unknowns of a fit.
//
// A frame's sensors show u = u_true + z + e: z the zero of the trial, N(0, zero_sd^2), e the noise of the
// value, N(0, noise_sd^2). To first order about the present estimates e0 and z0 the bodies of a frame are
//   f(theta, u - e - z) = f(theta, u - e0 - z0) - J (e - e0) - J (z - z0),   J = df/du,
// and minimising over e leaves the residual rho = f(theta, u - e0 - z0) - y + J e0 - J (z - z0), whose
// covariance is S = R + J diag(noise_sd^2) J^T. With e0 = diag(noise_sd^2) J^T S^-1 rho at the optimum the
// gradient by theta is that of the whole: orthogonal regression, without the attenuation that weights alone
// leave. The determinant of S belongs to a likelihood that has a distribution of u_true as well; without one
// it would bias the fit.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "law_model.h"
#include "softarm/arm/arm.h"
#include "softarm/trial/trial.h"
#include "trial/static_frame.h"

namespace softarm::identify {

/// In the order of Arm::inputs.scalars.
struct SensorErrors {
  Eigen::MatrixXd noise_sd;  ///< trials x inputs
  Eigen::VectorXd zero_sd;

  bool any() const { return noise_sd.size() > 0 && (noise_sd.any() || zero_sd.any()); }
};

/// Scatter of one input's values about the cubics through their neighbours, as of white noise. 0 for values
/// that lie on a line, as commanded ones do, and for too few.
/// @param sampled a sensor's: values that repeat are one sample that a logger repeated; else those that
/// mostly repeat may be commands, whose steps are no noise, and have none
double scatter_of(const std::vector<double>& stamp_s, const std::vector<double>& value, bool sampled);

/// Noise as stated by the arm file, else as measured in each trial by the sensor's own stamps.
SensorErrors sensor_errors(const arm::Arm& arm, const std::vector<trial::Trial>& trials);

/// The rows of a frame: 6 per body, position then tangent, over their sd; 0 where there is nothing to
/// compare.
class FrameInputs {
 public:
  /// @param recorded the frame; @param noise_sd, zero_sd of its trial
  FrameInputs(const trial::StaticFrame& recorded, Eigen::VectorXd noise_sd, const Eigen::VectorXd& zero_sd);

  /// The frame with the present estimate of its inputs.
  const trial::StaticFrame& frame() const { return frame_; }

  /// Takes over a derivative, and with it the estimate of the noise.
  /// @param off residual at frame(), over sd; @param by_inputs its derivative by all inputs
  /// @param misfit of the bodies over their sd, beside what the inputs make
  /// @param zero of the trial, over zero_sd
  void update(const Eigen::VectorXd& off, const Eigen::MatrixXd& by_inputs, double misfit,
              const Eigen::VectorXd& zero);
  /// Goes to the estimate. @return by how much of its sd the noise of an input changed at most
  double step(const trial::StaticFrame& recorded);

  /// rho, over sd. @param off residual at frame(); @param zero of the trial, over zero_sd
  Eigen::VectorXd reduced(const Eigen::VectorXd& off, const Eigen::VectorXd& zero) const;
  /// Of unit covariance times misfit^2: this times rho.
  const Eigen::MatrixXd& whitening() const { return whitening_; }
  /// Derivative of rho by the zeros over zero_sd.
  const Eigen::MatrixXd& by_zero() const { return by_zero_; }
  /// Derivative of rho's rows by the noise over noise_sd.
  const Eigen::MatrixXd& by_noise() const { return by_noise_; }

 private:
  trial::StaticFrame frame_;
  Eigen::VectorXd noise_sd_, zero_sd_;
  Eigen::VectorXd noise_, wanted_;      ///< over noise_sd: at frame(), and of the last update
  Eigen::VectorXd zero_, wanted_zero_;  ///< over zero_sd: the same
  Eigen::MatrixXd by_noise_, by_zero_, whitening_;
};

}  // namespace softarm::identify
