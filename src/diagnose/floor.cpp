#include "floor.h"

#include <cmath>
#include <cstddef>

namespace softarm::diagnose {

Floor floor_of(const JointModel& model) {
  Floor sum;
  double weight = 0.0;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      if (!model.uses(t, k)) continue;
      for (const model::Seen& seen : model.trials()[t].blocks[k].bodies) {
        const double w = 1.0 / std::pow(model.sd_m(t, k, seen), 2);
        sum.white_m2 += 3.0 * w * seen.white_sd_m * seen.white_sd_m;
        sum.motion_m2 += 3.0 * w * std::pow(model.motion_sd_m(t, k), 2);
        weight += w;
      }
    }
  }
  return weight > 0.0 ? Floor{sum.white_m2 / weight, sum.motion_m2 / weight} : Floor();
}

}  // namespace softarm::diagnose
