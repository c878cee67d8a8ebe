// Which constants are not identifiable from the trials, what they are taken for, and which trial would help.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "arm/constant_spec.h"
#include "softarm/identify/identify.h"
#include "trial/static_frame.h"
#include "uncertainty.h"

namespace softarm::identify {

/// What the frames vary, for scales and advice.
class Conditions : public arm::RecordedInputs {
 public:
  Conditions(const arm::Arm& arm, const std::vector<trial::StaticFrame>& frames);

  /// Size at which a constant matters where its value is zero or near it.
  double reference_scale(const ConstantRef& constant) const;
  /// One sentence: what the trials lack for this constant.
  std::string advice(const ConstantRef& constant) const;
  /// The same of two that are driven alike.
  std::string advice_of_pair(const ConstantRef& a, const ConstantRef& b) const;
  /// The two are driven by inputs that always stand in the same ratio, or are one number.
  bool driven_alike(const ConstantRef& a, const ConstantRef& b) const;
  bool vacuum_seen(int segment) const;
  /// The payload differs from frame to frame, or the direction of gravity.
  bool load_varies() const;

  std::vector<double> values(const std::string& input) const override;
  std::string load_advice() const override;

 private:
  const arm::Segment& segment_of(const ConstantRef& constant) const;
  /// The saturation of a segment's only chamber, tendon or cable, and that of all together.
  bool one_number(const ConstantRef& a, const ConstantRef& b) const;
  /// Its input, and whose it is: "chamber_4 (chamber 1 of segment_2)".
  std::string input_words(const ConstantRef& constant) const;
  std::string input_of(const ConstantRef& constant) const;

  const arm::Arm& arm_;
  const std::vector<trial::StaticFrame>& frames_;
};

/// A law that the fit has made nothing of: that EI does not grow, moments do not saturate or joints do not
/// yield is common, and no failure.
bool is_none(const Constant& c);

/// Fills determined, confused_with and advice of the constants, and Result::undetermined.
/// @param near_buckling the frames are of an arm near its buckling load: without other loads EI only looks
/// determined there, as its shapes follow EI closely, and with it all that the laws leave out
/// @param scale of each constant in Result::constants, against which uncertainty is in units of
void judge(const arm::Arm& arm, const std::vector<trial::StaticFrame>& frames, const Uncertainty& uncertainty,
           const Eigen::VectorXd& scale, double determined_sd, bool near_buckling, Result& result);

}  // namespace softarm::identify
