// A kind of actuator: all that the house knows of chambers, of tendons, ...; one file per kind beside this.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "arm/arm_keys.h"
#include "arm/constant_spec.h"
#include "arm/drive.h"
#include "arm/yaml_editor.h"
#include "softarm/arm/arm.h"

namespace softarm::arm {
namespace yaml {
class Section;
}

/// A number of the arm file that may be written again.
struct WrittenNumber {
  yaml::Path path;
  double before = 0.0, after = 0.0;
  /// Where the file gives this key in its place, it is multiplied.
  yaml::Path or_path = {};
  double or_factor = 1.0;
};

using VisitNumber = std::function<void(const WrittenNumber&)>;

/// Stateless. A segment may have several actuators of a kind, each with an index and one input.
class ActuatorKind {
 public:
  struct Traits {
    const char* name;   ///< of several: "tendons"
    const char* words;  ///< as a message says that a segment has some: "a central_chamber"
    InputKind input_kind;
    bool drives;   ///< bends or strains a segment; else it changes its stiffness alone
    bool strains;  ///< pulls along a segment
  };

  virtual ~ActuatorKind() = default;
  const Traits& traits() const { return traits_; }

  // What a segment has.
  virtual int count(const Segment& segment) const = 0;
  virtual const std::string& input(const Segment& segment, int i) const = 0;
  /// Whether the laws ask for the inputs: not where what they drive has no effect.
  virtual bool needs_inputs(const Segment&) const { return true; }
  /// Whether EI depends on the inputs.
  virtual bool stiffens(const Segment&) const { return false; }
  /// Azimuth towards which it bends the segment; nothing for kinds that do not bend.
  virtual std::optional<double> bending_direction_rad(const Segment&, int) const { return std::nullopt; }
  /// Where it runs in the section, m, for pictures; nothing where no arm file says so.
  virtual std::optional<Eigen::Vector2d> place_m(const Segment&, int) const { return std::nullopt; }

  /// Its law: adds what those of a segment do. Allocates nothing.
  /// @return false where an input that it needs is absent
  virtual bool drive(const Segment& segment, const InputReader& inputs, Drive& drive) const = 0;
  /// Its constants, with their derivatives.
  virtual const std::vector<ConstantSpec>& constants() const = 0;

  /// Its keys of `segments[]`, and of `bending_stiffness` there.
  virtual std::vector<yaml::KeySpec> segment_keys() const = 0;
  virtual std::vector<yaml::KeySpec> stiffness_keys() const { return {}; }
  /// Sections of its own behind those keys.
  virtual std::vector<const yaml::KeyTable*> segment_tables() const { return {}; }
  virtual std::vector<const yaml::KeyTable*> stiffness_tables() const { return {}; }
  /// @param segment whose own keys are read
  virtual void read(const yaml::Section& section, const yaml::Section& stiffness, const Inputs& inputs,
                    Segment& segment) const = 0;
  /// Every number that may be written again.
  /// @param at where the segment stands
  virtual void visit_numbers(const Segment& before, const Segment& after, const yaml::Path& at,
                             const VisitNumber& visit) const = 0;

 protected:
  explicit ActuatorKind(const Traits& traits) : traits_(traits) {}

 private:
  const Traits traits_;
};

/// All there are.
const std::vector<const ActuatorKind*>& actuator_kinds();

/// Whether anything bends or strains the segment; bends it.
bool is_driven(const Segment& segment);
bool is_bent(const Segment& segment);

inline yaml::Path operator/(yaml::Path path, const yaml::Step& step) {
  path.push_back(step);
  return path;
}

namespace yaml {

/// The input that `key` refers to, of the kind that is wanted there.
/// @param user what the section describes, for messages: "a chamber"
std::string read_input(const Section& section, const std::string& key, const Inputs& inputs, InputKind wanted,
                       const std::string& user);
/// The key `bending_direction_deg`.
double read_direction_rad(const Section& section);

}  // namespace yaml
}  // namespace softarm::arm
