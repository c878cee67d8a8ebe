// Pieces of RitzRod that answer bending as a whole.
#include "ritz_rod_impl.h"

namespace softarm::rig {

void RitzRod::Impl::make_stretches() {
  std::size_t memory = 0;
  for (std::size_t j = 0; j < params.pieces.size(); ++j) {
    if (!params.pieces[j].stretch) continue;
    RodStretch stretch;
    stretch.piece = j;
    stretch.first_memory = memory;
    memory += params.pieces[j].stretch->memory_size();
    if (params.pieces[j].sections) stretch.ratios = {0.0, 0.0, 0.0};
    for (const SectionNode& node : section_nodes)
      if (node.piece == j && params.pieces[j].sections) {
        stretch.ratios.bending += node.weight * node.ratios.bending;
        stretch.ratios.actuation += node.weight * node.ratios.actuation;
      }
    stretches.push_back(stretch);
  }
  rested_memory.assign(memory, 0.0);
}

SectionStep RitzRod::Impl::step_of(const RodStretch& stretch, const Differences& d, double load) const {
  const std::size_t j = stretch.piece;
  const PieceInputs& in = inputs.pieces[j];
  const Eigen::VectorXd& integral = mesh.pieces()[j].basis.integral();
  const auto mean = [&](const Eigen::VectorXd& all) -> Eigen::Vector2d {
    return {coefficients_of(j, 0).of(all).dot(integral), coefficients_of(j, 1).of(all).dot(integral)};
  };
  SectionStep step;
  step.dt_s = d.dt;
  step.length_m = lengths_m[j];
  step.curvature = mean(now.q) / lengths_m[j];
  step.stiffness_nm2 = stretch.ratios.bending * in.bending_stiffness_nm2;
  step.driven_per_m = load * stretch.ratios.actuation * in.moment_section_nm.head<2>() / step.stiffness_nm2;
  if (d.dt <= 0.0) return step;
  const double tau = params.pieces[j].retardation_s;
  step.last_curvature = mean(last.u);
  step.lag_per_m =
      tau * d.apply<Eigen::Vector2d>(step.curvature, step.last_curvature, mean(before.u), mean(oldest.u));
  step.lag_slope = tau * d.rate();
  step.lag_past = {tau * d.a1 / d.dt, tau * d.a2 / d.dt, tau * d.a3 / d.dt};
  return step;
}

void RitzRod::Impl::add_stretches(const Differences& d, double load) {
  const std::vector<double>& memory = d.dt > 0.0 ? last.stretch_memory : rested_memory;
  for (RodStretch& stretch : stretches) {
    const std::size_t j = stretch.piece, first = stretch.first_memory;
    stretch.response = SectionResponse{};
    params.pieces[j].stretch->add(step_of(stretch, d, load), memory.data() + first,
                                  now.stretch_memory.data() + first, stretch.response);
    for (int c = 0; c < 2; ++c)
      coefficients_of(j, c).of(residual) += stretch.response.moment_nm[c] * mesh.pieces()[j].basis.integral();
  }
}

void RitzRod::Impl::factorise_stretches() {
  for (const RodStretch& stretch : stretches) {
    const std::size_t j = stretch.piece;
    const Eigen::VectorXd& integral = mesh.pieces()[j].basis.integral();
    const Eigen::Matrix2d tangent = stretch.response.tangent_nm2 / lengths_m[j];
    const Eigen::Index first = coefficients_of(j, 0).first;
    for (Eigen::Index m = 0; m < integral.size(); ++m)
      for (Eigen::Index l = 0; l < integral.size(); ++l)
        matrix.block<2, 2>(first + 3 * m, first + 3 * l) += integral[m] * integral[l] * tangent;
  }
}

double RitzRod::Impl::stretch_energy() const {
  double energy = 0.0;
  for (const RodStretch& stretch : stretches)
    energy += lengths_m[stretch.piece] * stretch.response.stored_j_per_m;
  return energy;
}

bool RitzRod::Impl::keep_stretches() {
  if (now.stretch_memory == rested_memory) return false;
  rested_memory = now.stretch_memory;
  return true;
}

}  // namespace softarm::rig
