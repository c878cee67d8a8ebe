// An oscillator beside which dry friction slips: what a swing loses and gains in stiffness as it dies away.
#pragma once

namespace softarm::model {

/// x'' + damping x' + stiffness x + slip_stiffness z = 0, in which the spring z is stretched with x, z' = x',
/// until it slips at |z| = slip: a Jenkins element (Jenkins, J. Appl. Mech. 29, 1962). Small swings see both
/// springs and lose nothing to it, large ones see the first alone and lose 4 slip_stiffness slip (a - slip)
/// each, a being the amplitude. Exact: the motion is that of linear pieces, whose ends are found to rounding.
class SlipOscillator {
 public:
  struct Constants {
    double stiffness = 1.0;       ///< per mass, 1/s^2, above 0
    double damping = 0.0;         ///< per mass, 1/s
    double slip_stiffness = 0.0;  ///< per mass, 1/s^2; 0: no friction
    double slip = 0.0;            ///< in the unit of x
  };
  struct State {
    double x = 0.0, rate = 0.0, z = 0.0;
  };
  explicit SlipOscillator(const Constants& constants);
  /// @param dt_s above 0, of any length
  State step(State at, double dt_s) const;
  /// What the spring that slips is stretched by after a motion that was seen.
  double stretched(double z, double moved) const;

 private:
  bool slips(const State& at) const;
  /// Of one linear piece, were it to go on for so long.
  State on(const State& at, bool slipping, double dt_s) const;
  /// Until it ends, or dt_s; what is left of dt_s is returned there.
  State piece(const State& at, double& dt_s) const;

  Constants c_;
  double longest_s_;  ///< of a step: within it the rate has one zero at most
};

}  // namespace softarm::model
