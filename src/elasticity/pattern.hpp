// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/elasticity: creation and completion of matrices with a known pattern.
#pragma once

#include <vector>

#include "src/mesh/mesh.hpp"
#include "src/parallel/parallel.hpp"

namespace ricochet::elasticity {

struct Body;

/// Number of blocks in each owned block row, on and to the right of the diagonal.
struct Pattern {
  std::vector<PetscInt> diagonal, off_diagonal;  ///< per owned node: within and beyond this rank's columns
};

/// Appends a row with these columns (distinct node numbers in ascending order, none to the left of the
/// diagonal).
void append_row(Pattern& pattern, const mesh::Mesh& mesh, const std::vector<std::int64_t>& columns);

/// Creates an SBAIJ matrix that is preallocated for the pattern. Collective.
parallel::Matrix create(const mesh::Mesh& mesh, const Pattern& pattern);

/// Sets the diagonal of fixed rows, counts free rows into `free_rows`, and assembles both matrices.
/// Collective.
/// @param stiffest  largest diagonal entry on this rank; 0 if there is none
void finish_rows(const mesh::Mesh& mesh, double stiffest, Body& body);

/// Computes mass, centre and inertia. Collective.
/// @param moments  sums over this rank of 1, x_i and x_i x_j, weighted with ρ dV
void finish_inertia(MPI_Comm comm, std::array<double, 10>& moments, Body& body);

/// Returns displacement component c of rigid motion k (0–2 translations, 3–5 rotations) at x.
double rigid_value(const mesh::Mesh& mesh, int k, const Vector3& x, int c);

}  // namespace ricochet::elasticity
