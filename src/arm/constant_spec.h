// A constant of the laws, as the file that owns it describes it.
#pragma once

#include <string>
#include <vector>

#include "drive.h"
#include "softarm/arm/constants.h"
#include "wall_memory.h"

namespace softarm::arm {

/// What trials made of the inputs, for scales and advice.
class RecordedInputs {
 public:
  virtual ~RecordedInputs() = default;
  /// Of one input in every frame, in their order; 0 where it is not known. Empty: no such input.
  virtual std::vector<double> values(const std::string& input) const = 0;
  /// One sentence: which loads the trials lack to tell moment from stiffness.
  virtual std::string load_advice() const = 0;

  double largest(const std::string& input) const;
  double range(const std::string& input) const;
};

// Sizes at which a constant is worth knowing, for its scale where its own value is zero or near it.
constexpr double kUsualPressure_pa = 50e3;
constexpr double kBendThatMatters_rad = 0.1;   // over the length
constexpr double kStiffnessThatMatters = 0.2;  // of EI at the largest pressure

/// Rod parameters beside moment, EI and length that a constant moves; may be added.
enum : unsigned {
  kMovesTwist = 1,    ///< stiffness in twist, beside the modulus
  kMovesModulus = 2,  ///< EA, and the modulus with the stretch
  kMovesRestX = 4,
  kMovesRestY = 8,
  kMovesJoint = 16,
};

/// One kind of constant. Functions take a segment that has it and, where it has several, the index.
struct ConstantSpec {
  ConstantKind kind = ConstantKind::kMomentGain;
  ConstantRole role = ConstantRole::kOther;
  const char* name = "";  ///< behind the segment's: "chamber_{}.moment_gain", {} counts from 1
  const char* unit = "";
  /// What it is one of, in words, and the input that drives that: "chamber". Null for constants of a segment.
  const char* item = nullptr;
  const std::string& (*input)(const Segment&, int) = nullptr;
  unsigned moves = 0;

  int (*count)(const Segment&) = nullptr;
  /// Whether the arm has a value for it; one that it has not is 0, and free on demand alone.
  bool (*stated)(const Segment&, int) = [](const Segment&, int) { return true; };
  bool (*free_by_default)(const Segment&) = [](const Segment&) { return true; };
  double (*value)(const Segment&, int) = nullptr;
  void (*set)(Segment&, int, double) = nullptr;
  Range (*allowed)(const Segment&, int) = nullptr;
  /// What one unit of it changes. @return false where an input that it needs is absent
  bool (*change)(const Segment&, int, const InputReader&, Change&) = nullptr;

  /// What one unit of it changes of the wall; null: nothing.
  WallChange (*wall)(const Segment&, int) = nullptr;
  /// Size at which it matters where its value is zero or near it.
  double (*scale)(const Segment&, int, const RecordedInputs&) = nullptr;
  /// One sentence: what trials lack for it, though its input was on.
  std::string (*advice)(const Segment&, int, const RecordedInputs&) = nullptr;
};

const ConstantSpec& spec_of(ConstantKind kind);

/// Those of the segment itself: its stiffness, length and shape at rest.
const std::vector<ConstantSpec>& segment_constants();

/// EI without input.
double unloaded_stiffness_nm2(const Segment& segment);
/// An input, and whose it is: "'chamber_4' (chamber 1 of segment_2)".
std::string input_words(const Segment& segment, const char* item, const std::string& input, int index);
/// The largest value of an input that was recorded, or what is usual where it was never on.
double largest_or(const RecordedInputs& recorded, const std::string& input, double usual);

}  // namespace softarm::arm
