// Pieces of RitzRod whose sections differ or answer bending with laws of their own.
#include "ritz_rod_impl.h"

namespace softarm::rig {
namespace {

Eigen::Vector3d at(const SectionNode& node, const Eigen::VectorXd& coefficients) {
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  for (int m = 0; m < 4; ++m)
    u += node.basis[static_cast<std::size_t>(m)] * coefficients.segment<3>(3 * (node.first_function + m));
  return u;
}

}  // namespace

void RitzRod::Impl::make_section_nodes() {
  std::size_t memory = 0;
  for (int e = 0; e < mesh.elements(); ++e) {
    const RodMesh::Element& element = mesh.element(e);
    const auto j = static_cast<std::size_t>(element.piece);
    if (is_plain(j)) continue;
    const RodPiece& piece = params.pieces[j];
    for (int i = 0; i < StrainBasis::kPoints; ++i) {
      const double fraction = (element.local + mesh.points()[static_cast<std::size_t>(i)]) * element.size;
      SectionNode node;
      node.piece = j;
      node.first_function = element.first_function;
      node.basis = mesh.pieces()[j].basis.evaluate(element.local, fraction);
      node.weight = element.size * mesh.integration()(StrainBasis::kIntervals, i);
      if (piece.sections) node.ratios = piece.sections(fraction);
      node.first_memory = memory;
      for (const auto& law : piece.laws) memory += law->memory_size();
      section_nodes.push_back(node);
    }
  }
  responses.resize(section_nodes.size());
  virgin_memory.assign(memory, 0.0);
}

void RitzRod::Impl::add_sections(const Differences& d, double load) {
  for (const SectionNode& node : section_nodes) residual.segment<12>(3 * node.first_function).setZero();
  const std::vector<double>& memory = d.dt > 0.0 ? last.memory : virgin_memory;
  for (std::size_t i = 0; i < section_nodes.size(); ++i) {
    const SectionNode& node = section_nodes[i];
    const RodPiece& piece = params.pieces[node.piece];
    const PieceInputs& in = inputs.pieces[node.piece];
    const double bending = node.ratios.bending * in.bending_stiffness_nm2;
    const Eigen::Vector3d stiffness(bending, bending, node.ratios.twist * in.torsional_stiffness_nm2);
    const Eigen::Vector3d u = at(node, now.q) / lengths_m[node.piece];
    const Eigen::Vector3d u_last = d.dt > 0.0 ? at(node, last.u) : Eigen::Vector3d(Eigen::Vector3d::Zero());
    Eigen::Vector3d work = u;
    if (d.dt > 0.0 && piece.retardation_s > 0.0)
      work += piece.retardation_s * d.apply(u, u_last, at(node, before.u), at(node, oldest.u));
    Eigen::Vector3d moment =
        stiffness.cwiseProduct(work) - load * node.ratios.actuation * in.moment_section_nm;
    if (!piece.laws.empty()) {
      SectionStep step;
      step.curvature = u.head<2>();
      step.last_curvature = u_last.head<2>();
      step.dt_s = d.dt;
      step.stiffness_nm2 = bending;
      step.core_stiffness_nm2 = node.ratios.bending * in.core_stiffness_nm2;
      step.last_core_stiffness_nm2 =
          d.dt > 0.0 ? node.ratios.bending * last.core_stiffness_nm2[node.piece] : step.core_stiffness_nm2;
      responses[i] = SectionResponse{};
      std::size_t first = node.first_memory;
      for (const auto& law : piece.laws) {
        law->add(step, memory.data() + first, now.memory.data() + first, responses[i]);
        first += law->memory_size();
      }
      moment.head<2>() += responses[i].moment_nm;
    }
    for (int m = 0; m < 4; ++m)
      residual.segment<3>(3 * (node.first_function + m)) +=
          node.weight * node.basis[static_cast<std::size_t>(m)] * moment;
  }
}

void RitzRod::Impl::factorise_sections(const Differences& d) {
  const double rate = d.rate();
  for (std::size_t i = 0; i < section_nodes.size(); ++i) {
    const SectionNode& node = section_nodes[i];
    const PieceInputs& in = inputs.pieces[node.piece];
    const double viscous = 1.0 + params.pieces[node.piece].retardation_s * rate;
    const double bending = viscous * node.ratios.bending * in.bending_stiffness_nm2;
    Eigen::Matrix3d tangent =
        Eigen::Vector3d(bending, bending, viscous * node.ratios.twist * in.torsional_stiffness_nm2)
            .asDiagonal();
    tangent.topLeftCorner<2, 2>() += responses[i].tangent_nm2;
    tangent *= node.weight / lengths_m[node.piece];
    for (int m = 0; m < 4; ++m)
      for (int l = 0; l < 4; ++l)
        matrix.block<3, 3>(3 * (node.first_function + m), 3 * (node.first_function + l)) +=
            node.basis[static_cast<std::size_t>(m)] * node.basis[static_cast<std::size_t>(l)] * tangent;
  }
}

double RitzRod::Impl::section_energy() const {
  double energy = 0.0;
  for (std::size_t i = 0; i < section_nodes.size(); ++i) {
    const SectionNode& node = section_nodes[i];
    const PieceInputs& in = inputs.pieces[node.piece];
    const Eigen::Vector3d u = at(node, now.u);
    const double density = 0.5 * node.ratios.bending * in.bending_stiffness_nm2 * u.head<2>().squaredNorm() +
                           0.5 * node.ratios.twist * in.torsional_stiffness_nm2 * u.z() * u.z() -
                           node.ratios.actuation * in.moment_section_nm.dot(u) + responses[i].stored_j_per_m;
    energy += node.weight * lengths_m[node.piece] * density;
  }
  return energy;
}

}  // namespace softarm::rig
