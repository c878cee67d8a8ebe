// A new arm as an annotated arm file, and the layout of its recordings.
#pragma once

#include <string>
#include <vector>

namespace softarm::app {

/// What drives a segment.
struct NewDrive {
  bool chambers = false, tendons = false, cables = false, central = false;

  bool bends() const { return chambers || tendons || cables; }
};

struct NewSegment {
  NewDrive drive;
  double length_m = 0.0, mass_kg = 0.0, diameter_m = 0.0;
  double stiffness_nm2 = 0.0;      ///< EI
  std::vector<double> angles_deg;  ///< azimuths of the chambers, tendons, cables: one of each kind for each
};

struct NewBody {
  std::string name;
  double arclength_m = 0.0;
};

struct NewArm {
  std::string name;
  std::string base_body;  ///< empty: fixed
  std::string attitude;   ///< of a fixed base: hanging, standing or horizontal
  std::vector<NewSegment> segments;
  std::vector<NewBody> bodies;  ///< from base to tip

  double length_m() const;
};

/// Of a segment, such that the arm file takes it.
inline constexpr double kLeastStiffnessNm2 = 1e-6, kMostStiffnessNm2 = 500.0;

/// EI of a solid rod of soft silicone (0.2 MPa) of that diameter, within these: a size to begin with.
double guessed_stiffness_nm2(double diameter_m);

/// The arm file. Each key has the meaning and the allowed range that the arm file's own table of keys gives
/// it; what nobody has measured is a guess by the diameter, and says so.
std::string arm_text(const NewArm& arm);

/// A layout whose columns are time, base, bodies and inputs, in that order.
std::string layout_text(const NewArm& arm);

}  // namespace softarm::app
