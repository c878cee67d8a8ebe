// The last guard before a message leaves: is every number in it finite?
#pragma once

#include <ros/duration.h>
#include <ros/serialization.h>
#include <ros/time.h>

#include <boost/array.hpp>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

namespace softarm {
namespace finite_detail {

/// A serialization stream that looks at the fields instead of writing them, so that a field added to a
/// message is checked without anyone thinking of it.
struct Visitor {
  bool finite = true;

  template <class T>
  std::enable_if_t<std::is_floating_point_v<T>> next(const T& value) {
    finite = finite && std::isfinite(value);
  }
  template <class T>
  std::enable_if_t<std::is_integral_v<T>> next(const T&) {}
  void next(const std::string&) {}
  void next(const ros::Time&) {}
  void next(const ros::Duration&) {}
  template <class T, class Allocator>
  void next(const std::vector<T, Allocator>& values) {
    for (const auto& value : values) next(value);
  }
  template <class T, std::size_t N>
  void next(const boost::array<T, N>& values) {
    for (const auto& value : values) next(value);
  }
  template <class Message>
  std::enable_if_t<ros::message_traits::IsMessage<Message>::value> next(const Message& message) {
    ros::serialization::Serializer<Message>::template allInOne<Visitor, const Message&>(*this, message);
  }
};

}  // namespace finite_detail

/// True if no float in the message, however deep, is NaN or infinite.
template <class Message>
bool all_finite(const Message& message) {
  finite_detail::Visitor visitor;
  visitor.next(message);
  return visitor.finite;
}

}  // namespace softarm
