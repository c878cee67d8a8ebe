// How the tables of keys are written down: one call per key.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "arm_keys.h"

namespace softarm::arm::yaml {

using Words = std::vector<std::string>;

inline KeySpec number(std::string name, std::string unit, std::string fallback, double low, double high,
                      std::string meaning) {
  return {std::move(name),   KeyKind::kNumber, std::move(fallback), std::move(unit), low, high, 1, {},
          std::move(meaning)};
}

inline KeySpec number_or(std::string name, Words words, std::string unit, std::string fallback, double low,
                         double high, std::string meaning) {
  return {std::move(name),  KeyKind::kNumberOrWord, std::move(fallback), std::move(unit), low, high, 1,
          std::move(words), std::move(meaning)};
}

inline KeySpec integer(std::string name, std::string fallback, int low, int high, std::string meaning) {
  return {std::move(name),
          KeyKind::kInteger,
          std::move(fallback),
          "",
          static_cast<double>(low),
          static_cast<double>(high),
          1,
          {},
          std::move(meaning)};
}

inline KeySpec vector(std::string name, int count, std::string unit, std::string fallback, double low,
                      double high, std::string meaning) {
  return {std::move(name),   KeyKind::kVector, std::move(fallback), std::move(unit), low, high, count, {},
          std::move(meaning)};
}

inline KeySpec word(std::string name, Words words, std::string fallback, std::string meaning) {
  return {std::move(name),  KeyKind::kWord,    std::move(fallback), "", 0, 0, 1,
          std::move(words), std::move(meaning)};
}

inline KeySpec other(std::string name, KeyKind kind, std::string fallback, std::string meaning) {
  return {std::move(name), kind, std::move(fallback), "", 0, 0, 1, {}, std::move(meaning)};
}

inline KeySpec text(std::string name, std::string fallback, std::string meaning) {
  return other(std::move(name), KeyKind::kText, std::move(fallback), std::move(meaning));
}

inline KeySpec flag(std::string name, std::string fallback, std::string meaning) {
  return other(std::move(name), KeyKind::kFlag, std::move(fallback), std::move(meaning));
}

inline KeySpec map(std::string name, std::string fallback, std::string meaning) {
  return other(std::move(name), KeyKind::kMap, std::move(fallback), std::move(meaning));
}

/// @param most entries: more than arms have, and few enough for what reads them to come to an end
inline KeySpec list(std::string name, int most, std::string fallback, std::string meaning) {
  KeySpec key = other(std::move(name), KeyKind::kList, std::move(fallback), std::move(meaning));
  key.high = static_cast<double>(most);
  return key;
}

// The time of an estimate grows with more than the square of the bodies: with 64 of them it keeps up with the
// cameras, with 200 it does some ten frames a second.
inline constexpr int kMostMeasuredBodies = 200;
inline constexpr int kMostSegments = 32;
inline constexpr int kMostInputs = 1024;   // of a kind: as many as an array may have elements
inline constexpr int kMostActuators = 64;  // of a kind, in a segment
inline constexpr int kMostOfATable = 100;  // knots, labelled markers, effects

}  // namespace softarm::arm::yaml
