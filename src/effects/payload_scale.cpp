// The scale was wrong: what is said to hang there is what hangs times 1 + share.
#include "effects.h"

namespace softarm::effects {
namespace {

class PayloadScale : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool drives() const override { return true; }
  void drive(const arm::Arm&, const Values& values, Series& series) const override {
    series.payload_kg /= 1.0 + values[0];
  }
};

}  // namespace

std::unique_ptr<Effect> make_payload_scale() {
  return std::make_unique<PayloadScale>(
      Info{"payload_scale",
           "payloads weigh less or more than stated",
           "m = m_stated / (1 + share)",
           "errors of instruments: JCGM 100:2008, doi:10.59161/JCGM100-2008E",
           Family::kLoad,
           {{"share", "1", "by which the stated payload exceeds the real one", -0.8, 4.0, 0.05}},
           1,
           {"mass_distribution", "tip_mass", "payload_offset"},
           {"bending_stiffness"}});
}

}  // namespace softarm::effects
