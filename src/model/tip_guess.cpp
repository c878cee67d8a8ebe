#include "tip_guess.h"

namespace softarm::model {

using Eigen::Quaterniond;

std::optional<Quaterniond> TipGuess::of(std::size_t block, const Predicted* resting) {
  const Predicted* near = nearby_ != nullptr && (*nearby_)[block].solved ? &(*nearby_)[block] : nullptr;
  if (resting != nullptr) {
    from_ = near != nullptr ? near->q_tip * near->rest.q_tip.conjugate() * resting->q_tip : resting->q_tip;
    return from_;
  }
  from_.reset();
  if (near == nullptr) return last_;
  from_ = near->rest.q_tip;
  return turn_ * *from_;
}

void TipGuess::found(const Quaterniond& q_tip) {
  if (from_) turn_ = (q_tip * from_->conjugate()).normalized();
  last_ = q_tip;
}

void TipGuess::lost() {
  turn_.setIdentity();
  last_.reset();
}

}  // namespace softarm::model
