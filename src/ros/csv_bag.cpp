#include "csv_bag.h"

#include <utility>

namespace softarm {

CsvBag::CsvBag(const trial::CsvLayout& layout, std::string layout_text, const std::string& path,
               const std::string& called)
    : layout_(layout), layout_text_(std::move(layout_text)), writer_(path, called) {}

void CsvBag::payload(const trial::CsvRow& row) {
  if (row.payload_kg && row.payload_kg != payload_kg_) {
    payload_kg_ = row.payload_kg;
    writer_.payload(row.stamp, *row.payload_kg);
  }
  std::size_t last = next_step_;
  while (last < layout_.payload.size() && layout_.payload[last].from_s <= row.time_s) ++last;
  if (last == next_step_) return;
  // What holds when a bag begins counts from its first row on.
  const trial::CsvPayloadStep& step = layout_.payload[last - 1];
  const bool first = !last_stamp_;
  writer_.payload(first ? row.stamp : trial::Stamp(layout_.start_stamp_s).later(step.from_s), step.kg);
  next_step_ = last;
}

void CsvBag::write(const trial::CsvRow& row) {
  if (!last_stamp_) writer_.import_layout(row.stamp, layout_text_);
  payload(row);
  if (std::exchange(left_out_, false) && last_stamp_) writer_.left_out(last_stamp_->s, row.stamp.s);
  last_stamp_ = row.stamp;
  for (std::size_t i = 0; i < row.pressures_pa.size(); ++i) {
    if (row.pressures_pa[i]) writer_.pressure(layout_.pressures[i].topic, row.stamp, *row.pressures_pa[i]);
  }
  for (std::size_t i = 0; i < row.scalars.size(); ++i) {
    if (row.scalars[i]) writer_.scalar(layout_.scalars[i].topic, row.stamp, *row.scalars[i]);
  }
  for (std::size_t i = 0; i < row.bodies.size(); ++i) {
    const std::optional<trial::CsvPose>& pose = row.bodies[i];
    if (!pose) continue;
    // Drivers of single markers say by a zero quaternion that they know no orientation.
    const Eigen::Quaterniond none(0.0, 0.0, 0.0, 0.0);
    writer_.pose(layout_.bodies[i].name, row.stamp, pose->p_mocap, pose->q_mocap.value_or(none));
  }
}

}  // namespace softarm
