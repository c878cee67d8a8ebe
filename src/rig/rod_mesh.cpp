#include "rod_mesh.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace softarm::rig {

RodMesh::RodMesh(const std::vector<Division>& divisions, int leading_functions)
    : leading_functions_(leading_functions), functions_(leading_functions) {
  double begin = 0.0;
  for (const Division& division : divisions) {
    Piece piece{StrainBasis(division.elements), begin, division.share, elements(), functions_};
    for (int i = 0; i < division.elements; ++i)
      elements_.push_back({static_cast<int>(pieces_.size()), i, functions_ + i, piece.basis.element_size()});
    functions_ += piece.basis.functions();
    begin += division.share;
    pieces_.push_back(std::move(piece));
  }
  if (!(std::abs(begin - 1.0) < 1e-9)) throw std::invalid_argument("the pieces of a rod must sum to 1");
}

RodPlace RodMesh::locate(double fraction) const {
  std::size_t j = 0;
  while (j + 1 < pieces_.size() && fraction >= pieces_[j + 1].begin) ++j;
  const Piece& piece = pieces_[j];
  const double inside = std::clamp((fraction - piece.begin) / piece.share, 0.0, 1.0);
  return {piece.first_element + piece.basis.element_of(inside), inside};
}

double RodMesh::within_element(const RodPlace& place) const {
  const Element& e = element(place.element);
  return place.fraction * piece_of(place.element).basis.elements() - e.local;
}

LocalBasis RodMesh::evaluate(const RodPlace& place) const {
  return piece_of(place.element).basis.evaluate(element(place.element).local, place.fraction);
}

}  // namespace softarm::rig
