// Laws that chambers, tendons and cables share: actuation that falls behind its input (arm::Saturation), and
// EI that grows with the inputs. One set of templates; a kind says what is its own:
//
//   struct Law {
//     using Item = ...;                                      // Chamber, Tendon, Cable
//     static constexpr std::vector<Item> Segment::*kItems;
//     static constexpr std::optional<double> Item::*kOwn;    // a_i
//     static constexpr std::optional<double> Saturation::*kCommon;            // b
//     static constexpr std::optional<double> Item::*kOwnGrowth;               // EI by this one alone
//     static constexpr const char* kItem, *kInputs;          // words: "chamber", "pressures"
//     static constexpr double kUsual, kMost;                 // an input that is usual; largest a_i, b
//     static double size(double input);                      // |x|, 0 where the input does nothing
//     static double acting(double input);                    // the input as it bends: 0 where slack
//     static void bend(const Item&, double input, Drive&);   // adds what it does in proportion, of any sign
//   };
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "arm/constant_spec.h"
#include "arm/yaml_section.h"

namespace softarm::arm {

constexpr double kSaturationThatMatters = 0.2;  // of the actuation, at the largest input

template <typename Law>
const typename Law::Item& item_of(const Segment& segment, int i) {
  return (segment.*Law::kItems)[static_cast<std::size_t>(i)];
}

template <typename Law>
int count_of(const Segment& segment) {
  return static_cast<int>((segment.*Law::kItems).size());
}

template <typename Law>
const std::string& input_of(const Segment& segment, int i) {
  return item_of<Law>(segment, i).input;
}

/// sum_j |x_j|. @return nothing where one of them is absent
template <typename Law>
std::optional<double> sum_of_sizes(const Segment& segment, const InputReader& inputs) {
  double sum = 0.0;
  for (const typename Law::Item& one : segment.*Law::kItems) {
    const std::optional<double> value = inputs(one.input);
    if (!value) return std::nullopt;
    sum += Law::size(*value);
  }
  return sum;
}

/// 1 + a_i |x_i| + b sum_j |x_j|: what the actuation is divided by.
template <typename Law>
double divisor(const Segment& segment, const typename Law::Item& item, double value, double sum) {
  return 1.0 + (item.*Law::kOwn).value_or(0.0) * Law::size(value) +
         (segment.saturation.*Law::kCommon).value_or(0.0) * sum;
}

/// Over the frames, the largest sum of sizes; what is usual where there is none.
template <typename Law>
double largest_sum(const Segment& segment, const RecordedInputs& recorded) {
  std::vector<double> sums;
  for (const typename Law::Item& one : segment.*Law::kItems) {
    const std::vector<double> values = recorded.values(one.input);
    sums.resize(std::max(sums.size(), values.size()), 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) sums[k] += Law::size(values[k]);
  }
  const double most = sums.empty() ? 0.0 : *std::max_element(sums.begin(), sums.end());
  return most > 0.0 ? most : Law::kUsual;
}

/// a_i
template <typename Law>
ConstantSpec own_saturation(ConstantKind kind, const char* name, const char* unit) {
  ConstantSpec c{kind, ConstantRole::kSaturation, name, unit, Law::kItem, input_of<Law>};
  c.count = count_of<Law>;
  c.stated = [](const Segment& s, int i) { return (item_of<Law>(s, i).*Law::kOwn).has_value(); };
  c.value = [](const Segment& s, int i) { return (item_of<Law>(s, i).*Law::kOwn).value_or(0.0); };
  c.set = [](Segment& s, int i, double value) {
    (s.*Law::kItems)[static_cast<std::size_t>(i)].*Law::kOwn = value;
  };
  c.allowed = [](const Segment&, int) { return Range{0.0, Law::kMost}; };
  c.change = [](const Segment& s, int i, const InputReader& inputs, Change& change) {
    const typename Law::Item& item = item_of<Law>(s, i);
    const std::optional<double> value = inputs(item.input), sum = sum_of_sizes<Law>(s, inputs);
    if (!value || !sum) return false;
    const double by = divisor<Law>(s, item, *value, *sum);
    Law::bend(item, -Law::acting(*value) * Law::size(*value) / (by * by), change.drive);
    return true;
  };
  c.scale = [](const Segment& s, int i, const RecordedInputs& recorded) {
    return kSaturationThatMatters / largest_or(recorded, input_of<Law>(s, i), Law::kUsual);
  };
  c.advice = [](const Segment& s, int i, const RecordedInputs&) {
    return fmt::format("record trials with small and large values of {}, the other {} at rest",
                       input_words(s, Law::kItem, input_of<Law>(s, i), i), Law::kInputs);
  };
  return c;
}

/// b
template <typename Law>
ConstantSpec common_saturation(ConstantKind kind, const char* name, const char* unit) {
  ConstantSpec c{kind, ConstantRole::kSaturation, name, unit};
  c.count = [](const Segment& s) { return (s.*Law::kItems).empty() ? 0 : 1; };
  c.stated = [](const Segment& s, int) { return (s.saturation.*Law::kCommon).has_value(); };
  c.value = [](const Segment& s, int) { return (s.saturation.*Law::kCommon).value_or(0.0); };
  c.set = [](Segment& s, int, double value) { s.saturation.*Law::kCommon = value; };
  c.allowed = [](const Segment&, int) { return Range{0.0, Law::kMost}; };
  c.change = [](const Segment& s, int, const InputReader& inputs, Change& change) {
    const std::optional<double> sum = sum_of_sizes<Law>(s, inputs);
    if (!sum) return false;
    for (const typename Law::Item& item : s.*Law::kItems) {
      const double value = *inputs(item.input), by = divisor<Law>(s, item, value, *sum);
      Law::bend(item, -Law::acting(value) * *sum / (by * by), change.drive);
    }
    return true;
  };
  c.scale = [](const Segment& s, int, const RecordedInputs& recorded) {
    return kSaturationThatMatters / largest_sum<Law>(s, recorded);
  };
  c.advice = [](const Segment& s, int, const RecordedInputs&) {
    return fmt::format("record trials of {} with all {} low and all high, and in changing mixtures", s.name,
                       Law::kInputs);
  };
  return c;
}

/// Over the frames: of the lowest size, the largest.
template <typename Law>
double largest_minimum(const Segment& segment, const RecordedInputs& recorded) {
  std::vector<double> lowest;
  for (const typename Law::Item& one : segment.*Law::kItems) {
    const std::vector<double> values = recorded.values(one.input);
    if (lowest.empty()) lowest.assign(values.size(), std::numeric_limits<double>::max());
    for (std::size_t k = 0; k < values.size() && k < lowest.size(); ++k)
      lowest[k] = std::min(lowest[k], Law::size(values[k]));
  }
  return lowest.empty() ? 0.0 : *std::max_element(lowest.begin(), lowest.end());
}

/// What is common to the constants by which EI grows.
template <typename Law>
ConstantSpec growth_constant(ConstantKind kind, const char* name, const char* unit) {
  ConstantSpec c{kind, ConstantRole::kBendingStiffnessSlope, name, unit};
  c.allowed = [](const Segment&, int) { return Range{0.0, Law::kMostGrowth}; };
  return c;
}

/// EI by one item alone.
template <typename Law>
struct OwnGrowth {
  static double added_nm2(const typename Law::Item& item, double value) {
    return (item.*Law::kOwnGrowth).value_or(0.0) * Law::size(value);
  }
  static bool stiffens(const Segment& segment) {
    const auto& items = segment.*Law::kItems;
    return std::any_of(items.begin(), items.end(), [](const typename Law::Item& one) {
      return (one.*Law::kOwnGrowth).value_or(0.0) != 0.0;
    });
  }

  static ConstantSpec constant(ConstantKind kind, const char* name, const char* unit) {
    ConstantSpec c = growth_constant<Law>(kind, name, unit);
    c.item = Law::kItem;
    c.input = input_of<Law>;
    c.count = count_of<Law>;
    c.stated = [](const Segment& s, int i) { return (item_of<Law>(s, i).*Law::kOwnGrowth).has_value(); };
    c.value = [](const Segment& s, int i) { return (item_of<Law>(s, i).*Law::kOwnGrowth).value_or(0.0); };
    c.set = [](Segment& s, int i, double value) {
      (s.*Law::kItems)[static_cast<std::size_t>(i)].*Law::kOwnGrowth = value;
    };
    c.change = [](const Segment& s, int i, const InputReader& inputs, Change& change) {
      const std::optional<double> value = inputs(input_of<Law>(s, i));
      change.drive.added_stiffness_nm2 = Law::size(value.value_or(0.0));
      return value.has_value();
    };
    c.scale = [](const Segment& s, int i, const RecordedInputs& recorded) {
      return kStiffnessThatMatters * unloaded_stiffness_nm2(s) /
             largest_or(recorded, input_of<Law>(s, i), Law::kUsual);
    };
    c.advice = [](const Segment& s, int i, const RecordedInputs& recorded) {
      return fmt::format("record trials with {} high and low, each with and without a payload; {}",
                         input_words(s, Law::kItem, input_of<Law>(s, i), i), recorded.load_advice());
    };
    return c;
  }
};

/// EI per the lowest of the sizes.
/// @tparam kSlope the member of StiffnessLaw: optional, or stated by every arm
template <typename Law, auto kSlope>
struct MinGrowth {
  static double added_nm2(const Segment& segment, double lowest) { return slope(segment) * lowest; }
  static bool stiffens(const Segment& segment) { return slope(segment) != 0.0; }

  /// With one item the lowest is a law as well, but equation (7) is of antagonists: from two on.
  static ConstantSpec constant(ConstantKind kind, const char* name, const char* unit) {
    ConstantSpec c = growth_constant<Law>(kind, name, unit);
    c.count = [](const Segment& s) { return count_of<Law>(s) >= 2 ? 1 : 0; };
    c.stated = [](const Segment& s, int) { return stated(s.bending_stiffness.*kSlope); };
    c.value = [](const Segment& s, int) { return slope(s); };
    c.set = [](Segment& s, int, double value) { s.bending_stiffness.*kSlope = value; };
    c.change = [](const Segment& s, int, const InputReader& inputs, Change& change) {
      double lowest = std::numeric_limits<double>::max();
      for (const typename Law::Item& one : s.*Law::kItems) {
        const std::optional<double> value = inputs(one.input);
        if (!value) return false;
        lowest = std::min(lowest, Law::size(*value));
      }
      change.drive.added_stiffness_nm2 = lowest;
      return true;
    };
    c.scale = [](const Segment& s, int, const RecordedInputs& recorded) {
      const double lowest = largest_minimum<Law>(s, recorded);
      return kStiffnessThatMatters * unloaded_stiffness_nm2(s) / (lowest > 0.0 ? lowest : Law::kUsual);
    };
    c.advice = [](const Segment& s, int, const RecordedInputs& recorded) {
      if (!(largest_minimum<Law>(s, recorded) > 0.0))
        return fmt::format(
            "the {} of all {}s of {} are never above zero at the same time: record trials with all of them "
            "high, with and without a payload",
            Law::kInputs, Law::kItem, s.name);
      return fmt::format(
          "record trials with the {} of all {}s high and with a payload beside such with one "
          "at zero; {}",
          Law::kInputs, Law::kItem, recorded.load_advice());
    };
    return c;
  }

 private:
  static double slope(const Segment& segment) { return number(segment.bending_stiffness.*kSlope); }
  static double number(double slope) { return slope; }
  static double number(const std::optional<double>& slope) { return slope.value_or(0.0); }
  static bool stated(double) { return true; }
  static bool stated(const std::optional<double>& slope) { return slope.has_value(); }
};

/// EI per sum of the sizes, or per their mean.
/// @tparam kSlope the member of StiffnessLaw
template <typename Law, std::optional<double> StiffnessLaw::*kSlope, bool kMean>
struct Growth {
  static double added_nm2(const Segment& segment, double sum) {
    return (segment.bending_stiffness.*kSlope).value_or(0.0) * size(segment, sum);
  }
  static double size(const Segment& segment, double sum) {
    return kMean && !(segment.*Law::kItems).empty() ? sum / count_of<Law>(segment) : sum;
  }
  static bool stiffens(const Segment& segment) {
    return (segment.bending_stiffness.*kSlope).value_or(0.0) != 0.0;
  }

  static ConstantSpec constant(ConstantKind kind, const char* name, const char* unit) {
    ConstantSpec c = growth_constant<Law>(kind, name, unit);
    c.count = [](const Segment& s) { return (s.*Law::kItems).empty() ? 0 : 1; };
    c.stated = [](const Segment& s, int) { return (s.bending_stiffness.*kSlope).has_value(); };
    c.value = [](const Segment& s, int) { return (s.bending_stiffness.*kSlope).value_or(0.0); };
    c.set = [](Segment& s, int, double value) { s.bending_stiffness.*kSlope = value; };
    c.change = [](const Segment& s, int, const InputReader& inputs, Change& change) {
      const std::optional<double> sum = sum_of_sizes<Law>(s, inputs);
      if (!sum) return false;
      change.drive.added_stiffness_nm2 = size(s, *sum);
      return true;
    };
    c.scale = [](const Segment& s, int, const RecordedInputs& recorded) {
      return kStiffnessThatMatters * unloaded_stiffness_nm2(s) / size(s, largest_sum<Law>(s, recorded));
    };
    c.advice = [](const Segment& s, int, const RecordedInputs& recorded) {
      return fmt::format("record trials of {} with high and low {}, each with and without a payload; {}",
                         s.name, Law::kInputs, recorded.load_advice());
    };
    return c;
  }
};

/// A number that an arm file may leave out, and that means 0 then.
inline std::optional<double> number_if_given(const yaml::Section& section, const char* key) {
  return section.has(key) ? std::optional(section.number(key)) : std::nullopt;
}

/// The same of a number for all items of a segment, which one that has none cannot take.
/// @param section in which it stands; @param segment whose items they are
template <typename Law>
std::optional<double> number_with_items(const yaml::Section& section, const char* key,
                                        const yaml::Section& segment) {
  const std::optional<double> value = number_if_given(section, key);
  const std::string items = std::string(Law::kItem) + "s";
  if (value && !segment.has(items)) section.fail(key, "applies to segments with " + items + " only");
  return value;
}

}  // namespace softarm::arm
