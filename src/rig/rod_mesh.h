// Pieces of a rod in series, each with its own splines: private to the rig.
#pragma once

#include <vector>

#include "strain_basis.h"

namespace softarm::rig {

/// A place on the rod: an element and the fraction of the element's piece.
struct RodPlace {
  int element = 0;
  double fraction = 0.0;
};

/// One cubic spline of the curvature per piece, independent of its neighbours', so that the curvature may
/// jump where pieces meet. Pieces share the station where they meet; functions, elements and stations are
/// numbered through the rod. Before the splines' functions there may be others (the turn of the base).
class RodMesh {
 public:
  struct Piece {
    StrainBasis basis;
    double begin = 0.0, share = 1.0;  ///< of the rod's material coordinate [0, 1]
    int first_element = 0, first_function = 0;
    int first_station() const { return StrainBasis::kIntervals * first_element; }
    int last_station() const { return first_station() + basis.stations() - 1; }
  };
  struct Element {
    int piece, local;    ///< its piece, and its number there
    int first_function;  ///< of the four splines that live in it
    double size;         ///< of the piece
  };
  /// How a piece is divided.
  struct Division {
    int elements;
    double share;  ///< of the rod; they must sum to 1
  };

  /// @throws std::invalid_argument for no piece, a piece without elements, or shares that do not sum to 1
  RodMesh(const std::vector<Division>& divisions, int leading_functions);

  const std::vector<Piece>& pieces() const { return pieces_; }
  const Element& element(int e) const { return elements_[static_cast<std::size_t>(e)]; }
  const Piece& piece_of(int e) const { return pieces_[static_cast<std::size_t>(element(e).piece)]; }
  int elements() const { return static_cast<int>(elements_.size()); }
  int stations() const { return StrainBasis::kIntervals * elements() + 1; }
  int functions() const { return functions_; }
  int leading_functions() const { return leading_functions_; }

  /// Lobatto points of an element and their integration: the same in all elements.
  const std::array<double, StrainBasis::kPoints>& points() const { return pieces_.front().basis.points(); }
  const Eigen::Matrix<double, StrainBasis::kPoints, StrainBasis::kPoints>& integration() const {
    return pieces_.front().basis.integration();
  }

  /// Where a fraction of the material coordinate lies; where pieces meet, in the distal one.
  RodPlace locate(double fraction) const;
  /// The place's coordinate in its element, 0 ... 1.
  double within_element(const RodPlace& place) const;
  LocalBasis evaluate(const RodPlace& place) const;

 private:
  std::vector<Piece> pieces_;
  std::vector<Element> elements_;
  int leading_functions_, functions_ = 0;
};

}  // namespace softarm::rig
