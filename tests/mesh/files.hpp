// SPDX-License-Identifier: BSD-2-Clause
// Hand-written meshes that are small enough to check by eye.
#pragma once

#include <fmt/format.h>

#include <string>

namespace ricochet::test {

/// Two tetrahedra on both sides of the triangle 1, 2, 3, with the apexes 4 above and 5 below and a volume of
/// 1/6 each. `second` lists the corners of the second; "1 3 2 5" is correct.
inline std::string two_tetrahedra_22(const std::string& second) {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body\"\n$EndPhysicalNames\n"
         "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 -1\n$EndNodes\n"
         "$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 " +
         second + "\n$EndElements\n";
}

inline std::string two_tetrahedra_41(const std::string& second) {
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body\"\n$EndPhysicalNames\n"
         "$Entities\n0 0 0 1\n1 0 0 -1 1 1 1 1 1 0\n$EndEntities\n"
         "$Nodes\n1 5 1 5\n3 1 0 5\n1\n2\n3\n4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 -1\n$EndNodes\n"
         "$Elements\n1 2 1 2\n3 1 4 2\n1 1 2 3 4\n2 " +
         second + "\n$EndElements\n";
}

/// One element of gmsh's type number `type` on the corners of the unit cube:
/// 1–4 around the bottom, 5–8 above them.
inline std::string one_element(int type, const std::string& nodes) {
  return fmt::format(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 "
      "1\n"
      "7 1 1 1\n8 0 1 1\n$EndNodes\n$Elements\n1\n1 {} 2 1 1 {}\n$EndElements\n",
      type, nodes);
}

/// A hexahedron with these corners; "1 2 3 4 5 6 7 8" is correct.
inline std::string one_hexahedron(const std::string& nodes) { return one_element(5, nodes); }

/// A tetrahedron of order 2 in volume 1 and one of order 1 in `volume`.
inline std::string tetrahedra_of_two_orders(int volume) {
  return fmt::format(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n11\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 .5 0 0\n6 .5 "
      ".5 0\n"
      "7 0 .5 0\n8 0 0 .5\n9 0 .5 .5\n10 .5 0 .5\n11 0 0 -1\n$EndNodes\n"
      "$Elements\n2\n1 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n2 4 2 1 {} 1 3 2 11\n$EndElements\n",
      volume);
}

}  // namespace ricochet::test
