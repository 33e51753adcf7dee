// SPDX-License-Identifier: BSD-2-Clause
// Stiffness and mass of a linear elastic body, or of a rod.
//
//   K = ∫ Bᵀ D B dV,  M = ∫ ρ Nᵀ N dV       (rods: ∫ E A N'ᵀN' dx, ∫ ρ A NᵀN dx)
//
// Rows are global node × components + component. A fixed component keeps its row, with a positive diagonal
// entry in K and zeros in M. Its eigenvalue is infinite, so that no count below a shift includes it.
#pragma once

#include <Eigen/Dense>

#include "src/elasticity/imposed.hpp"
#include "src/mesh/mesh.hpp"
#include "src/parallel/parallel.hpp"

namespace ricochet::elasticity {

struct Body {
  parallel::Matrix stiffness;  ///< SBAIJ, block size = components
  parallel::Matrix mass;       ///< same pattern
  /// (local rows, 6): M without supports times the rigid motions e_x, e_y, e_z, e_x × x, e_y × x, e_z × x;
  /// fixed rows are zero.
  Eigen::MatrixXd rigid_load;
  std::int64_t local_rows = 0, total_rows = 0;
  std::int64_t free_rows = 0;       ///< rows that no support fixes
  double total_mass = 0;            ///< [kg]
  Vector3 centre{};                 ///< [m]
  std::array<double, 9> inertia{};  ///< about the centre [kg m²]
  double volume = 0, surface = 0;   ///< of a solid that has elements [m³, m²], otherwise 0
  /// √(E/ρ), in a body of several materials such that as many waves fit into it (the mean of 1/c³) [m/s]
  double wave_speed = 0;
  double poisson = 0.3;  ///< mean Poisson's ratio; 0.3 if it is unknown
  Imposed imposed;       ///< forcing by moving supports
};

/// Assembles K and M. Messages refer to the mesh as `file`; `moved` is as for Imposing. Collective. Needs a
/// GmshSession. Throws InputError on all ranks if the Jacobian of an element is not positive; the message
/// contains the tag and the position of the element.
Body assemble(const mesh::Mesh& mesh, const std::vector<scene::Material>& materials, const std::string& file,
              const parallel::Progress& progress = {}, const std::vector<std::string>& moved = {});

}  // namespace ricochet::elasticity
