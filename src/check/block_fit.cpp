#include "block_fit.h"

#include <cstddef>

#include "math/linear_algebra.h"

namespace softarm::check {
namespace {

// Share of the largest square sum of a function, by which functions that are nearly alike are kept apart: far
// below what tells, far above the rounding of the sums.
constexpr double kRidge = 1e-8;

}  // namespace

BlockFit fit_in_blocks(const Eigen::MatrixXd& functions, const Eigen::MatrixXd& places,
                       const std::vector<int>& block) {
  Eigen::MatrixXd normal = functions.transpose() * functions;
  normal.diagonal().array() += kRidge * (1.0 + normal.diagonal().maxCoeff());
  const Eigen::MatrixXd inverse = math::inverse_of_symmetric(normal);
  BlockFit fit;
  fit.x = inverse * (functions.transpose() * places);
  fit.left = places - functions * fit.x;
  fit.covariance.assign(static_cast<std::size_t>(functions.cols()),
                        Eigen::MatrixXd::Zero(places.cols(), places.cols()));
  const auto block_of_row = [&](Eigen::Index k) { return block[static_cast<std::size_t>(k)]; };
  for (Eigen::Index from = 0, to = 0; from < functions.rows(); from = to) {
    for (to = from; to < functions.rows() && block_of_row(to) == block_of_row(from);) ++to;
    const Eigen::MatrixXd moved =
        inverse * (functions.middleRows(from, to - from).transpose() * fit.left.middleRows(from, to - from));
    for (Eigen::Index i = 0; i < moved.rows(); ++i)
      fit.covariance[static_cast<std::size_t>(i)] += moved.row(i).transpose() * moved.row(i);
  }
  return fit;
}

}  // namespace softarm::check
