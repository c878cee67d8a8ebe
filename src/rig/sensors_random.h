// Random processes of the sensors: private to the rig.
#pragma once

#include <algorithm>
#include <cmath>

#include "random_stream.h"
#include "sensor_spec.h"

namespace softarm::rig {

/// What a stream of random numbers is for. A stream of its own per purpose, entry in the scenario's list and
/// body or input: switching one fault on leaves the numbers of the others alone.
enum class SensorPurpose : std::uint64_t {
  kCorrelatedNoise = 1,
  kBias,
  kJump,
  kBurst,
  kLatency,
  kStampJitter,
  kDuplicate,
  kInputNoise,
};

inline RandomStream stream_of(std::uint64_t seed, SensorPurpose purpose, std::size_t entry = 0,
                              std::size_t part = 0) {
  constexpr std::uint64_t kSensors = 0x73656e73;
  return {seed, (kSensors << 32) ^ (static_cast<std::uint64_t>(purpose) << 24) ^
                    (static_cast<std::uint64_t>(entry) << 12) ^ static_cast<std::uint64_t>(part)};
}

/// First-order Gauss-Markov noise of three numbers, exact at any step, stationary from the start.
class GaussMarkov {
 public:
  GaussMarkov(double sd, double step_s, double correlation_s)
      : sd_(sd), kept_(std::exp(-step_s / correlation_s)) {}

  Eigen::Vector3d next(RandomStream& random) {
    const Eigen::Vector3d fresh = random.normal3();
    state_ = started_ ? Eigen::Vector3d(kept_ * state_ + std::sqrt(1.0 - kept_ * kept_) * fresh) : fresh;
    started_ = true;
    return sd_ * state_;
  }

 private:
  double sd_, kept_;
  Eigen::Vector3d state_ = Eigen::Vector3d::Zero();  ///< of unit variance
  bool started_ = false;
};

/// On for stretches of geometrically distributed length: a Markov chain of two states, stationary from the
/// start.
class Telegraph {
 public:
  /// @param share of the time that it is on, up to 0.5
  Telegraph(double share, double mean_length_s, double step_s)
      : share_(share),
        to_off_(std::min(1.0, step_s / mean_length_s)),
        to_on_(share / (1.0 - share) * to_off_) {}

  bool next(RandomStream& random) {
    const double u = random.uniform();
    on_ = started_ ? (on_ ? u >= to_off_ : u < to_on_) : u < share_;
    started_ = true;
    return on_;
  }

 private:
  double share_, to_off_, to_on_;
  bool on_ = false, started_ = false;
};

/// A random direction.
inline Eigen::Vector3d direction_from(RandomStream& random) {
  return random.normal3().normalized();
}

}  // namespace softarm::rig
