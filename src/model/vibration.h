// How an arm swings about its equilibria: a few modes of vibration, integrated exactly along a trial.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "effect.h"
#include "prepared_trial.h"

namespace softarm::model {

/// A path of equilibria, as a swing needs it: of one block, rod's base frame.
struct Rest {
  double t_s = 0.0;
  Eigen::Quaterniond q_tip = Eigen::Quaterniond::Identity();
  std::vector<Eigen::Vector3d> stations, curvature;  ///< m; u at the pieces' middles, 1/m
  Eigen::VectorXd masses_kg;                         ///< at the stations
  Eigen::VectorXd lengths_m, compliance;             ///< of the pieces; rad/(N m) per metre
};

/// Of small motion about one equilibrium, x = x_rest + shape q, of unit modal mass:
/// d^2q/dt^2 + lag elastic dq/dt + stiffness (q - q_rest) = 0.
struct Modes {
  Eigen::MatrixXd shape;      ///< 3n x r, of the stations
  Eigen::MatrixXd project;    ///< r x 3n, shape^T M: what of a displacement is q
  Eigen::MatrixXd curvature;  ///< 3n x r, of u at the pieces' middles
  Eigen::MatrixXd bodies;     ///< 6b x r, of the arm's bodies and, below, of the tangents there
  Eigen::VectorXd stiffness;  ///< square of the angular frequency, 1/s^2
  Eigen::VectorXd elastic;    ///< the part of it that is the wall's, whose bending lags
  Eigen::VectorXd lengths_m;  ///< of the pieces

  /// Stiffness and damping per modal mass where the same shapes have other masses, lengths and compliances
  /// (Rayleigh's quotient).
  struct Springs {
    Eigen::VectorXd stiffness, damping;
  };
  Springs springs_of(const Rest& rest, const Sluggishness& sluggish) const;
  Eigen::VectorXd elastic_of(const Rest& rest) const;
};

/// One entry per block of a trial, shared by those whose equilibria hardly differ; null without one.
using TrialModes = std::vector<std::shared_ptr<const Modes>>;

/// What the stations of a rod do under forces on them: derivatives of their positions and rotations.
struct Flexibility {
  Eigen::MatrixXd positions, rotations;  ///< 3n x 3n, m/N and rad/N, rod's base frame
  Eigen::MatrixXd bodies;                ///< 6b x 3n, of the arm's bodies and, below, of the tangents there
  std::vector<Eigen::Quaterniond> q;     ///< of the stations
};

/// The modes of lowest frequency. Empty where the equilibrium is none: a direction that nothing holds.
Modes modes_of(const Flexibility& flexibility, const Rest& rest, int count);

/// How the arm moves in every block, mean over its frames: in its modes as it swings, otherwise as the
/// equilibria do; so in all where the trial begins, and after a hand was on it.
/// @param series what drives the arm, at the trial's frames
/// @param rest one per block; without stations: no equilibrium
std::vector<Motion> swing(const TrialModes& modes, const TrialData& trial, const Series& series,
                          const Sluggishness& sluggish, const std::vector<Rest>& rest);

/// The same of an arm that follows its equilibria in all its modes.
std::vector<Motion> follow(const TrialData& trial, const std::vector<Rest>& rest);

/// What the arm does in its modes beside that, because something else set it swinging before a block.
/// @return for each block from `first` on, up to where nothing is known any more, a matrix 6b x 2r: places of
/// the arm's bodies and, below, tangents there, by how far off the modes are in that block, and by how fast
std::vector<Eigen::MatrixXd> free_swing(const TrialModes& modes, const TrialData& trial,
                                        const std::vector<Rest>& rest, const Sluggishness& sluggish,
                                        std::size_t first);

/// x'' + damping x' + stiffness (x - g) = 0 over dt, while g goes from g0 to g1 along a line; exact.
class Oscillator {
 public:
  struct State {
    double x = 0.0, rate = 0.0;
  };
  Oscillator(double stiffness, double damping, double dt_s);
  State step(const State& at, double g0, double g1) const;
  /// What has followed such a line for long, at its beginning.
  State following(double g0, double g1) const;

 private:
  double dt_s_, behind_;      // s: by how much a line is followed late
  double xx_, xr_, rx_, rr_;  // of what dies away
};

/// How a small change of the equilibria of a trial arrives, if it swings in its modes; it follows them where
/// the path begins.
class SwingOfChange {
 public:
  /// @param rest of the blocks
  SwingOfChange(const TrialModes& modes, const TrialData& trial, const std::vector<Rest>& rest,
                const Sluggishness& sluggish);
  /// @param now, next change of each block's equilibrium, in its own modes and in those of the next block;
  /// one column per block, anything where it has no modes
  /// @return how far the arm is from the equilibria, in each block's own modes
  Eigen::MatrixXd beyond(const Eigen::MatrixXd& now, const Eigen::MatrixXd& next) const;

 private:
  struct Step {
    std::vector<Oscillator> to;  ///< by mode
    Eigen::MatrixXd turn;        ///< from the modes of the block before; 0 x 0: they are the same
  };
  std::vector<Step> steps_;  ///< to each block from the one before; without oscillators: none
};

}  // namespace softarm::model
