#include "receipt_queue.h"

#include <utility>

namespace softarm::rig {

void ReceiptQueue::add(const Sample& sample) {
  const auto send = [this](double receipt_s, auto message) {
    on_the_way_.emplace(receipt_s, Received{receipt_s, std::move(message)});
  };
  if (sample.payload) send(sample.payload->stamp_s, *sample.payload);
  for (const InputSample& input : sample.inputs) send(input.receipt_s, input);
  for (int copy = 0; copy < sample.mocap_copies; ++copy)
    for (std::size_t i = 0; i < sample.bodies.size(); ++i)
      if (sample.bodies[i])
        send(sample.mocap_receipt_s, PoseSample{sample.mocap_stamp_s, i, *sample.bodies[i]});
}

std::optional<Received> ReceiptQueue::take(double until_s) {
  const auto first = on_the_way_.begin();
  if (first == on_the_way_.end() || first->first > until_s) return std::nullopt;
  const Received received = first->second;
  on_the_way_.erase(first);
  return received;
}

}  // namespace softarm::rig
