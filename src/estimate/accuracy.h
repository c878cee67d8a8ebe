// How well the estimator does on synthetic frames, against the best that any estimator could.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "softarm/arm/arm.h"

namespace softarm::estimate {

/// Ranges that the frames are drawn from, uniformly: the online paper's arm and protocol.
struct AccuracyProtocol {
  int frames = 10000;
  std::uint64_t seed = 1;
  double position_sd_m = 0.0005;
  double weight_kg = 0.2;
  arm::Range payload_kg{0.15, 0.24};
  arm::Range bending_stiffness_nm2{0.02, 0.06};
  arm::Range length_m{0.19, 0.22};
  arm::Range moment_nm{0.05, 0.6};
  arm::Range tip_angle_rad{0.3490658503988659, 2.6179938779914944};  // 20 ... 150 degrees
  bool warm = false;  ///< keep the last frame's solution as a start, though frames are unrelated
};

/// Results; the four parameters are M0, phi, EI, L.
struct AccuracyReport {
  static constexpr int kParameters = 4;
  int frames = 0;
  int converged = 0;
  int strong_frames = 0;  ///< those with M0 >= 0.2 N m
  /// Root mean square error over root mean Cramer-Rao variance, strong frames.
  std::array<double, kParameters> efficiency{};
  /// Median of |error| / Cramer-Rao standard deviation, all frames; 0.674 is ideal.
  std::array<double, kParameters> median_error_over_bound{};
  /// Share of 95 % intervals that cover the truth, where the parameter is identifiable in the frame.
  std::array<double, kParameters> coverage{};
  std::array<int, kParameters> identifiable{};
  int hopeless = 0;          ///< frames whose bound on EI is over 50 %
  int hopeless_claimed = 0;  ///< ... but whose estimate claims it as identifiable
  int clear = 0;             ///< frames whose bound on EI is under 15 %
  int clear_claimed = 0;
  double median_shape_error_m = 0.0;  ///< rms over the markers' true places
};

/// Draws frames of `arm` (one segment; its bodies' noise is replaced by the protocol's), half hanging and
/// half standing, estimates them by least squares with known payload and compares with truth and with the
/// Cramer-Rao bound.
/// @param progress called with the number of frames done
AccuracyReport measure_accuracy(arm::Arm arm, const AccuracyProtocol& protocol,
                                const std::function<void(int)>& progress = {});

/// A table for people.
std::string describe(const AccuracyReport& report);

}  // namespace softarm::estimate
