// SPDX-License-Identifier: BSD-2-Clause
// Operators of a body. In a file of its own, because the library of the eigensolver knows no bodies.
#include "src/elasticity/rigid.hpp"
#include "src/modes/operators.hpp"

namespace ricochet::modes {

Operators::Operators(const mesh::Mesh& mesh, const elasticity::Body& body)
    : Operators(body.stiffness, body.mass, elasticity::rigid_modes(mesh, body)) {
  const int c = mesh.components();
  mesh.for_each_owned([&](std::size_t i, std::int64_t row) {
    for (int k = 0; k < c; ++k) key[static_cast<std::size_t>(row * c + k)] = mesh.canonical[i] * c + k;
  });
}

}  // namespace ricochet::modes
