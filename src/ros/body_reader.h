// What turns a driver's poses and points into metres in the mocap frame.
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "softarm/arm/arm.h"
#include "trial/stamp.h"

namespace softarm {

/// A frame's name without the leading slash that tf once had.
inline std::string without_slash(const std::string& frame) {
  return frame.rfind('/', 0) == 0 ? frame.substr(1) : frame;
}

/// `text` with every "<body>" replaced.
std::string with_body(std::string text, const std::string& body);

/// Units, axes, frame and stamps as BodySource says.
class BodyReader {
 public:
  explicit BodyReader(const arm::BodySource& source);

  /// A position as the driver reports it, to m in the mocap frame. NaN stays NaN, all zero all zero.
  Eigen::Vector3d position(double x, double y, double z) const {
    return scaled_axes_ * Eigen::Vector3d(x, y, z);
  }
  /// An orientation (body to the driver's frame) to body to mocap; the norm stays as it is. Where the
  /// driver's frame is mirrored (axes of determinant -1), the body's axes are taken for mirrored likewise.
  Eigen::Quaterniond orientation(const Eigen::Quaterniond& q) const {
    return mirrored_ ? turn_ * q * turn_.conjugate() : turn_ * q;
  }
  /// Whether data in this frame are read. A message that names no frame is.
  bool reads(const std::string& frame_id) const {
    return frame_.empty() || frame_id.empty() || without_slash(frame_id) == frame_;
  }
  trial::Stamp stamp(trial::Stamp header, trial::Stamp receipt) const {
    return stamp_ == arm::StampSource::kReceipt ? receipt : header;
  }

 private:
  Eigen::Matrix3d scaled_axes_;
  bool mirrored_;
  Eigen::Quaterniond turn_;  // of the axes, or of their negative where mirrored
  std::string frame_;
  arm::StampSource stamp_;
};

}  // namespace softarm
