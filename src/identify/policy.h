// What identification decides by.
#pragma once

namespace softarm::identify {

/// Share by which the mean error on unseen trials must fall for the new constants to be better there. Frames
/// of one trial are alike: draws of other unseen trials move that error by about as much.
constexpr double kLeastGain = 0.01;

/// Mean distance over standard deviation per coordinate, of noise in three coordinates: 2 sqrt(2 / pi).
/// Errors on unseen trials below that of the stated noise, places of the bodies included, cannot get better.
constexpr double kMeanOverSd = 1.596;

}  // namespace softarm::identify
