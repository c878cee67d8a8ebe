// Extremely randomised trees (P. Geurts, D. Ernst, L. Wehenkel, Machine Learning 63, 2006): what another
// flexible model makes of the same.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <random>
#include <vector>

namespace softarm::diagnose::testing {

class Trees {
 public:
  using Rows = std::vector<Eigen::Index>;

  /// @param x one row per instant
  /// @param rows to learn from
  Trees(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, const Rows& rows) {
    for (int i = 0; i < kTrees; ++i) trees_.push_back(grown(x, y, rows));
  }

  double at(const Eigen::RowVectorXd& x) const {
    double sum = 0.0;
    for (const std::unique_ptr<Node>& tree : trees_) {
      const Node* node = tree.get();
      while (node->low) node = x[node->column] < node->threshold ? node->low.get() : node->high.get();
      sum += node->mean;
    }
    return sum / kTrees;
  }

 private:
  static constexpr int kTrees = 60;
  static constexpr std::size_t kLeaf = 3;

  struct Node {
    double mean = 0.0, threshold = 0.0;
    Eigen::Index column = 0;
    std::unique_ptr<Node> low, high;  ///< of one that is no leaf
  };

  std::unique_ptr<Node> grown(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, const Rows& rows) {
    auto node = std::make_unique<Node>();
    for (const Eigen::Index row : rows) node->mean += y[row] / static_cast<double>(rows.size());
    Rows best_low, best_high;
    double best = 0.0;  // fall of the sum of squares
    for (Eigen::Index column = 0; rows.size() >= 2 * kLeaf && column < x.cols(); ++column) {
      const auto [least, most] = std::minmax_element(
          rows.begin(), rows.end(), [&](auto a, auto b) { return x(a, column) < x(b, column); });
      const double threshold =
          std::uniform_real_distribution<double>(x(*least, column), x(*most, column))(random_);
      Rows low, high;
      double of_low = 0.0;
      for (const Eigen::Index row : rows) {
        const bool is_low = x(row, column) < threshold;
        (is_low ? low : high).push_back(row);
        if (is_low) of_low += y[row] - node->mean;
      }
      if (std::min(low.size(), high.size()) < kLeaf) continue;
      const double fall =
          of_low * of_low * (1.0 / static_cast<double>(low.size()) + 1.0 / static_cast<double>(high.size()));
      if (fall <= best) continue;
      best = fall;
      node->column = column;
      node->threshold = threshold;
      best_low = std::move(low);
      best_high = std::move(high);
    }
    if (best > 0.0) {
      node->low = grown(x, y, best_low);
      node->high = grown(x, y, best_high);
    }
    return node;
  }

  std::mt19937_64 random_{5};
  std::vector<std::unique_ptr<Node>> trees_;
};

}  // namespace softarm::diagnose::testing
