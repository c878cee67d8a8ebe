// The words of methods, unknowns and objectives.
#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "softarm/arm/arm_file.h"

namespace softarm::arm {
namespace {

template <typename Value, std::size_t kCount>
using WordTable = std::array<std::pair<Value, std::string_view>, kCount>;

constexpr WordTable<Method, 4> kMethods{{{Method::kFullPoints, "full_points"},
                                         {Method::kEndOrientation, "end_orientation"},
                                         {Method::kCcPoints, "cc_points"},
                                         {Method::kCcEndpoint, "cc_endpoint"}}};
constexpr WordTable<Unknown, 3> kUnknowns{
    {{Unknown::kStiffness, "stiffness"}, {Unknown::kPayload, "payload"}, {Unknown::kBoth, "both"}}};
constexpr WordTable<Objective, 2> kObjectives{
    {{Objective::kLeastSquares, "least_squares"}, {Objective::kSumOfDistances, "sum_of_distances"}}};
constexpr WordTable<Dynamics, 2> kDynamics{{{Dynamics::kStatic, "static"}, {Dynamics::kModal, "modal"}}};

template <typename Value, std::size_t kCount>
std::string word_of(const WordTable<Value, kCount>& table, Value value) {
  for (const auto& [candidate, word] : table) {
    if (candidate == value) return std::string(word);
  }
  throw std::logic_error("enumerator without a word");
}

template <typename Value, std::size_t kCount>
Value value_of(const WordTable<Value, kCount>& table, const std::string& word, std::string_view what) {
  std::string allowed;
  for (const auto& [candidate, name] : table) {
    if (name == word) return candidate;
    if (!allowed.empty()) allowed += ", ";
    allowed += name;
  }
  throw std::invalid_argument(fmt::format("{} '{}' is none of: {}", what, word, allowed));
}

}  // namespace

std::string to_string(Method method) {
  return word_of(kMethods, method);
}
std::string to_string(Unknown unknown) {
  return word_of(kUnknowns, unknown);
}
std::string to_string(Objective objective) {
  return word_of(kObjectives, objective);
}
std::string to_string(Dynamics dynamics) {
  return word_of(kDynamics, dynamics);
}

Method parse_method(const std::string& word) {
  return value_of(kMethods, word, "method");
}
Unknown parse_unknown(const std::string& word) {
  return value_of(kUnknowns, word, "unknown");
}
Objective parse_objective(const std::string& word) {
  return value_of(kObjectives, word, "objective");
}
Dynamics parse_dynamics(const std::string& word) {
  return value_of(kDynamics, word, "dynamics");
}

}  // namespace softarm::arm
