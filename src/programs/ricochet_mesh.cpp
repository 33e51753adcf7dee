// SPDX-License-Identifier: BSD-2-Clause
// ricochet-mesh: reads one body with gmsh for ricochet-kernel, which starts it (src/mesh/apart.hpp).
#include "src/mesh/apart.hpp"

int main() { return ricochet::mesh::answer_request(); }
