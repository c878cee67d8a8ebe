// How sure the effects of the last model are, given all the others in it.
#pragma once

#include "selection.h"

namespace softarm::diagnose {

/// Fills the selection's covariance and still_there: how well the unknowns of the last model are known, and
/// whether its effects still are.
/// @param without_rivals the posterior as if what may be mistaken for effects of the model could not be
/// beside them, however small: a class is surer than which of it is there
/// @param catalogue number of effects that may have been there
void add_doubt(const Linearised& at, const Posterior& posterior, const Posterior& without_rivals,
               std::size_t catalogue, Selection& selection);

}  // namespace softarm::diagnose
