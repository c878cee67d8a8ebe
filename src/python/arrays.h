// NumPy arrays in and out.
#pragma once

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace softarm::python {

namespace py = pybind11;
using Shape = std::vector<Py_ssize_t>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// How an array says that there is no value.
constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

/// An array that owns what the vector had; nothing is copied. Row by row.
template <typename Value>
py::array_t<Value> array_of(std::vector<Value>&& values, const Shape& shape) {
  auto* kept = new std::vector<Value>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<Value>*>(p); });
  return py::array_t<Value>(shape, kept->data(), owner);
}

inline std::string words_of(const Shape& shape) {
  std::string words;
  for (const Py_ssize_t n : shape) words += (words.empty() ? "" : ", ") + std::to_string(n);
  return "(" + words + (shape.size() == 1 ? ",)" : ")");
}

/// @throws std::invalid_argument naming both shapes. @param meaning of the axes: "frames, bodies, x y z"
inline void expect_shape(const Doubles& array, const char* name, const Shape& shape, const char* meaning) {
  const Shape given(array.shape(), array.shape() + array.ndim());
  if (given != shape)
    throw std::invalid_argument(fmt::format("{}: has the shape {}, must have {}: {}", name, words_of(given),
                                            words_of(shape), meaning));
}

/// @param absent_allowed NaN says that there is no value; infinity never does
inline void expect_numbers(const Doubles& array, const char* name, bool absent_allowed) {
  const double* values = array.data();
  for (Py_ssize_t i = 0; i < array.size(); ++i) {
    if (std::isfinite(values[i]) || (absent_allowed && std::isnan(values[i]))) continue;
    throw std::invalid_argument(fmt::format("{}: element {} of {} is {}; must be {}", name, i, array.size(),
                                            values[i],
                                            absent_allowed ? "finite, or NaN for none" : "finite"));
  }
}

/// Finite, each later than the one before.
inline void expect_increasing(const Doubles& array, const char* name) {
  expect_numbers(array, name, false);
  for (Py_ssize_t i = 1; i < array.size(); ++i)
    if (!(array.data()[i] > array.data()[i - 1]))
      throw std::invalid_argument(
          fmt::format("{}: element {} is not later than the one before; must increase", name, i));
}

inline std::optional<double> present(double value) {
  return std::isnan(value) ? std::nullopt : std::optional<double>(value);
}

inline void append(std::vector<double>& to, const std::optional<double>& value) {
  to.push_back(value.value_or(kAbsent));
}

template <typename Vector>
void put(double* at, const Vector& from) {
  std::copy(from.data(), from.data() + from.size(), at);
}

inline void append(std::vector<double>& to, const Eigen::Vector3d& p) {
  to.insert(to.end(), p.data(), p.data() + 3);
}

}  // namespace softarm::python
