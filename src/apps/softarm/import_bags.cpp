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
  bag_ = std::make_unique<CsvBag>(layout_, layout_text_, bags_.back().file->temporary().string(),
                                  bags_.back().file->path().string());
  left_out_ = false;
}

void ImportBags::write(const trial::CsvRow& row) {
  enter(row);
  if (std::exchange(left_out_, false)) bag_->leave_out();
  bag_->write(row);
  bags_.back().messages = bag_->messages();
}

void ImportBags::close() {
  if (bag_) bag_->close();
  bag_.reset();
}

void ImportBags::commit() {
  for (const Bag& bag : bags_) bag.file->commit();
}

}  // namespace softarm::app
