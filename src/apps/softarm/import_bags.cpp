#include "import_bags.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "command.h"

namespace softarm::app {

ImportBags::ImportBags(const trial::CsvLayout& layout, const std::string& layout_text,
                       std::filesystem::path path, std::optional<double> split_every_s, Replacing replacing)
    : layout_(layout),
      layout_text_(layout_text),
      path_(std::move(path)),
      split_every_s_(split_every_s),
      replacing_(std::move(replacing)) {}

void ImportBags::enter(const trial::CsvRow& row) {
  const bool new_trial = bags_.empty() || row.trial != trial_;
  if (new_trial) {
    trial_ = row.trial;
    trial_start_s_ = row.time_s;
  }
  // A piece begins at a row; times of rows are multiples of a period only up to rounding.
  constexpr double kRoundingS = 1e-9;
  const long piece =
      split_every_s_ ? std::lround(std::floor((row.time_s - trial_start_s_ + kRoundingS) / *split_every_s_))
                     : 0;
  if (!new_trial && piece == piece_) return;
  piece_ = piece;
  close();
  std::filesystem::path path = path_;
  if (layout_.trial_column || split_every_s_) {
    std::string name = path_.stem().string();
    if (layout_.trial_column) {
      const auto fits = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
      };
      std::string word = trial_;
      std::replace(word.begin(), word.end(), '.', '_');
      if (!std::all_of(word.begin(), word.end(), fits))
        throw Failure(fmt::format("trial '{}' ({}): must be of letters, digits, _ - and . to name a bag",
                                  trial_, layout_.trial_column->key));
      name += "_" + word;
    }
    if (split_every_s_) name += fmt::format("_{}", piece);
    path.replace_filename(name + ".bag");
  }
  bags_.push_back({std::make_unique<OutputFile>(path, replacing_), 0});
  writer_ = std::make_unique<TrialBagWriter>(bags_.back().file->temporary().string());
  writer_->import_layout(row.stamp, layout_text_);
  next_step_ = 0;
  payload_kg_.reset();
  last_stamp_.reset();
  left_out_ = false;
}

void ImportBags::payload(const trial::CsvRow& row) {
  if (row.payload_kg && row.payload_kg != payload_kg_) {
    payload_kg_ = row.payload_kg;
    writer_->payload(row.stamp, *row.payload_kg);
  }
  std::size_t last = next_step_;
  while (last < layout_.payload.size() && layout_.payload[last].from_s <= row.time_s) ++last;
  if (last == next_step_) return;
  // What holds when a bag begins counts from its first row on.
  const trial::CsvPayloadStep& step = layout_.payload[last - 1];
  const bool first = !last_stamp_;
  writer_->payload(first ? row.stamp : trial::Stamp(layout_.start_stamp_s).later(step.from_s), step.kg);
  next_step_ = last;
}

void ImportBags::write(const trial::CsvRow& row) {
  enter(row);
  payload(row);
  if (left_out_ && last_stamp_) writer_->left_out(last_stamp_->s, row.stamp.s);
  left_out_ = false;
  last_stamp_ = row.stamp;
  for (std::size_t i = 0; i < row.pressures_pa.size(); ++i) {
    if (row.pressures_pa[i]) writer_->pressure(layout_.pressures[i].topic, row.stamp, *row.pressures_pa[i]);
  }
  for (std::size_t i = 0; i < row.scalars.size(); ++i) {
    if (row.scalars[i]) writer_->scalar(layout_.scalars[i].topic, row.stamp, *row.scalars[i]);
  }
  for (std::size_t i = 0; i < row.bodies.size(); ++i) {
    const std::optional<trial::CsvPose>& pose = row.bodies[i];
    if (!pose) continue;
    // Drivers of single markers say by a zero quaternion that they know no orientation.
    const Eigen::Quaterniond none(0.0, 0.0, 0.0, 0.0);
    writer_->pose(layout_.bodies[i].name, row.stamp, pose->p_mocap, pose->q_mocap.value_or(none));
  }
  bags_.back().messages = writer_->messages();
}

void ImportBags::close() {
  if (writer_) writer_->close();
  writer_.reset();
}

void ImportBags::commit() {
  for (const Bag& bag : bags_) bag.file->commit();
}

}  // namespace softarm::app
