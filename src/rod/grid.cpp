#include "grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "arm/stiffness_profile.h"

namespace softarm::rod {
namespace {

// To begin with: an eighth-order step over a third of a bent rod mostly errs by less than a millionth of the
// rod's length, and where it does not, the embedded estimate asks for shorter ones.
constexpr double kLongestStep = 1.0 / 3.0;
// Over a tenth a step of order 5 with half the stages errs by no more.
constexpr double kBriefStep = 0.1;
constexpr double kSamePlace = 1e-9;  // of the rod's length

}  // namespace

double flexibility_factor(const std::vector<arm::StiffnessKnot>& profile, double fraction) {
  return 1.0 / arm::stiffness_factor(profile, fraction);
}

Grid::Grid(const Rod& layout, const std::vector<double>& stations_m, int max_refinement) {
  const double length = layout.rest_length_m();
  if (layout.segments.empty() || !(length > 0.0)) throw std::invalid_argument("rod: it has no length");
  const auto check = [&](double s, const char* what) {
    if (!(s >= -kSamePlace * length && s <= length * (1.0 + kSamePlace))) {
      throw std::invalid_argument(
          fmt::format("rod: {} at s = {} m is off the rod [0, {}] m", what, s, length));
    }
  };
  std::vector<double> places = {0.0, length};
  double s0 = 0.0;
  for (const Segment& segment : layout.segments) {
    segment_start.push_back(s0);
    if (!(segment.rest_length_m > 0.0)) throw std::invalid_argument("rod: a segment has no length");
    for (const arm::StiffnessKnot& knot : segment.stiffness_profile) {
      places.push_back(s0 + knot.fraction * segment.rest_length_m);
    }
    s0 += segment.rest_length_m;
    places.push_back(s0);
  }
  for (const PointLoad& load : layout.loads) check(load.s_m, "a load"), places.push_back(load.s_m);
  for (const double s : stations_m) check(s, "a station"), places.push_back(s);
  for (double& s : places) s = std::clamp(s, 0.0, length);
  std::sort(places.rbegin(), places.rend());
  places.erase(std::unique(places.begin(), places.end(),
                           [&](double a, double b) { return std::abs(a - b) < kSamePlace * length; }),
               places.end());
  places.back() = 0.0;

  int coarse = 0;
  for (std::size_t k = 0; k + 1 < places.size(); ++k) {
    Interval interval;
    interval.s_distal = places[k];
    interval.s_proximal = places[k + 1];
    const double middle = 0.5 * (places[k] + places[k + 1]);
    double end = 0.0;
    for (std::size_t i = 0; i < layout.segments.size(); ++i) {
      end += layout.segments[i].rest_length_m;
      interval.segment = static_cast<int>(i);
      if (middle < end) break;
    }
    const double start = segment_start[static_cast<std::size_t>(interval.segment)];
    interval.from_joint = std::abs(interval.s_proximal - start) < kSamePlace * length;
    interval.coarse_steps = std::max(
        1, static_cast<int>(std::ceil((places[k] - places[k + 1]) / (kLongestStep * length) - 1e-6)));
    interval.brief = places[k] - places[k + 1] <= kBriefStep * length;
    coarse += interval.coarse_steps;
    intervals.push_back(interval);
  }
  steps.resize(static_cast<std::size_t>(coarse * max_refinement));

  const auto breakpoint_at = [&](double s) {
    int best = 0;
    for (int k = 0; k < breakpoints(); ++k) {
      if (std::abs(this->s(k) - s) < std::abs(this->s(best) - s)) best = k;
    }
    return best;
  };
  loads_at.resize(static_cast<std::size_t>(breakpoints()));
  for (std::size_t i = 0; i < layout.loads.size(); ++i) {
    loads_at[static_cast<std::size_t>(breakpoint_at(layout.loads[i].s_m))].push_back(static_cast<int>(i));
  }
  for (const double s : stations_m) station_breakpoint.push_back(breakpoint_at(s));
}

void Grid::refine(const Rod& layout, int refinement, const std::vector<kernel::Section>& sections) {
  int next = 0;
  for (Interval& interval : intervals) {
    interval.first_step = next;
    const std::size_t seg = static_cast<std::size_t>(interval.segment);
    const Segment& segment = layout.segments[seg];
    const int count = interval.coarse_steps * refinement;
    const double h = (interval.s_proximal - interval.s_distal) / count;
    for (int k = 0; k < count; ++k) {
      kernel::Step& step = steps[static_cast<std::size_t>(next++)];
      step.section = &sections[seg];
      step.s_distal = interval.s_distal + k * h;
      step.h = h;
      step.brief = interval.brief;
      const auto flex_at = [&](double share) {
        return flexibility_factor(segment.stiffness_profile,
                                  (step.s_distal + share * h - segment_start[seg]) / segment.rest_length_m);
      };
      for (int i = 0; i < step.stages(); ++i) step.flex[i] = flex_at(step.place(i));
      step.flex_proximal = flex_at(1.0);
    }
  }
}

}  // namespace softarm::rod
