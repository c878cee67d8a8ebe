#include "input_reader.h"

#include <cmath>

namespace softarm::arm {

std::optional<double> InputReader::operator()(const std::string& name) const {
  const std::size_t count = known_ != nullptr ? static_cast<std::size_t>(known_->size()) : values_->size();
  for (std::size_t i = 0; i < inputs_.scalars.size() && i < count; ++i) {
    if (inputs_.scalars[i].name != name) continue;
    const std::optional<double> value =
        known_ != nullptr ? std::optional((*known_)[static_cast<Eigen::Index>(i)]) : (*values_)[i];
    if (value && std::isfinite(*value)) return value;
  }
  return std::nullopt;
}

}  // namespace softarm::arm
