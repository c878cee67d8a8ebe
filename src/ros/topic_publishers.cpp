#include "topic_publishers.h"

#include <algorithm>

namespace softarm {
namespace {

constexpr std::uint32_t kLargestLoss = 10000;  // a larger step is no loss: its publisher counts afresh
constexpr std::size_t kMostPublishers = 100;   // that are remembered: `rostopic pub` has ever new names
constexpr int kAlternate = 2;                  // changes back: one may be a driver that is started again

}  // namespace

std::uint32_t TopicPublishers::add(const std::string& publisher, std::optional<std::uint32_t> sequence) {
  if (!last_.empty() && publisher != last_) {
    changes_ += sequences_.count(publisher) > 0;  // back to one that has sent before
    other_ = last_;
  }
  last_ = publisher;
  if (sequences_.size() >= kMostPublishers && sequences_.count(publisher) == 0) sequences_.clear();
  std::optional<std::uint32_t>& before = sequences_[publisher];
  std::uint32_t lost = 0;
  if (before && sequence && *sequence > *before && *sequence - *before < kLargestLoss)
    lost = *sequence - *before - 1;
  before = sequence;
  return lost;
}

void TopicPublishers::end_period() {
  if (changes_ == changes_before_) changes_ = 0;
  changes_before_ = changes_;
}

std::optional<std::pair<std::string, std::string>> TopicPublishers::two() const {
  if (changes_ < kAlternate) return std::nullopt;
  return std::make_pair(std::min(last_, other_), std::max(last_, other_));
}

}  // namespace softarm
