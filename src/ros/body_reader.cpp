#include "body_reader.h"

namespace softarm {

std::string with_body(std::string text, const std::string& body) {
  static const std::string kPlaceholder = "<body>";
  for (std::size_t at = 0; (at = text.find(kPlaceholder, at)) != std::string::npos; at += body.size()) {
    text.replace(at, kPlaceholder.size(), body);
  }
  return text;
}

BodyReader::BodyReader(const arm::BodySource& source)
    : scaled_axes_(source.scale_to_m * source.mocap_from_driver),
      mirrored_(source.mocap_from_driver.determinant() < 0.0),
      turn_(
          Eigen::Matrix3d(mirrored_ ? Eigen::Matrix3d(-source.mocap_from_driver) : source.mocap_from_driver)),
      frame_(without_slash(source.frame)),
      stamp_(source.stamp) {}

}  // namespace softarm
