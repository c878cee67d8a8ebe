// The estimates of a recording, column by column.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/estimate/estimator.h"

namespace softarm::python {

/// Rows are frames. NaN: there is no value.
class EstimateTable {
 public:
  explicit EstimateTable(const arm::Arm& arm, int backbone_points);

  void add(const estimate::Estimate& estimate);
  std::size_t frames() const { return stamp_.size(); }
  /// NumPy arrays by name; the table is empty afterwards. With Python's lock.
  pybind11::dict take();

 private:
  void add_segment(const estimate::SegmentEstimate& segment);
  void add_shape(const estimate::Estimate& estimate);

  std::size_t segments_, bodies_, points_;
  std::vector<double> stamp_, payload_, sd_payload_, theta_, tip_, residual_, chi_;
  std::vector<std::int8_t> status_, identifiable_payload_, settling_;
  std::vector<double> moment_, direction_, stiffness_, length_, sd_moment_, sd_direction_, sd_stiffness_,
      sd_length_;
  std::vector<std::int8_t> identifiable_stiffness_;
  std::vector<double> backbone_, curvature_, measured_, estimated_;
};

}  // namespace softarm::python
