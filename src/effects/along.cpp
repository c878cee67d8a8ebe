#include "along.h"

#include <algorithm>

namespace softarm::effects {
namespace {

using Eigen::Vector3d;

double width(const model::Piece& piece) {
  return piece.s_to_m - piece.s_from_m;
}

/// Shares a length about a place between piece j and its neighbour k; beyond j, away from k, the latter's
/// share is negative.
void split(const model::FineRod& fine, double length, double centre, int j, int k, Eigen::VectorXd& shares) {
  const model::Piece &at = fine.pieces()[static_cast<std::size_t>(j)],
                     &beside = fine.pieces()[static_cast<std::size_t>(k)];
  const double part = (centre - at.middle_m()) / (beside.middle_m() - at.middle_m()) * length;
  shares[k] += part / width(beside);
  shares[j] += (length - part) / width(at);
}

Eigen::VectorXd cap(const model::FineRod& fine, double length_m, bool at_base) {
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(fine.stations());
  const int count = fine.stations(), step = at_base ? 1 : -1;
  double left = length_m;
  for (int j = at_base ? 0 : count - 1; j >= 0 && j < count && left > 0.0; j += step) {
    const model::Piece& piece = fine.pieces()[static_cast<std::size_t>(j)];
    const double part = std::min(left, width(piece));
    const int beside = j + step;
    if (part >= width(piece) || beside < 0 || beside >= count) {
      shares[j] += part / width(piece);
    } else {
      const double centre = at_base ? piece.s_from_m + 0.5 * part : piece.s_to_m - 0.5 * part;
      split(fine, part, centre, j, beside, shares);
    }
    left -= part;
  }
  return shares;
}

}  // namespace

Eigen::VectorXd cover(const model::FineRod& fine, double from_m, double to_m) {
  const int count = fine.stations();
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(count);
  for (int j = 0; j < count; ++j) {
    const model::Piece& piece = fine.pieces()[static_cast<std::size_t>(j)];
    const double from = std::max(from_m, piece.s_from_m), to = std::min(to_m, piece.s_to_m);
    if (to <= from) continue;
    const double centre = 0.5 * (from + to);
    // Towards the neighbour on its side; at the ends of the arm away from the only one.
    const bool up = centre > piece.middle_m();
    const int beside = up ? (j + 1 < count ? j + 1 : j - 1) : (j > 0 ? j - 1 : j + 1);
    split(fine, to - from, centre, j, beside, shares);
  }
  return shares;
}

Eigen::VectorXd cap_at_base(const model::FineRod& fine, double length_m) {
  return cap(fine, length_m, true);
}
Eigen::VectorXd cap_at_tip(const model::FineRod& fine, double length_m) {
  return cap(fine, length_m, false);
}

}  // namespace softarm::effects
