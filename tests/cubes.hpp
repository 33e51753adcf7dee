// SPDX-License-Identifier: BSD-2-Clause
// Bodies of unit cubes that meet at faces, edges or corners, or not at all.
#pragma once

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

namespace ricochet::test {

/// Cubes with these lowest corners, of hexahedra with `divisions` along each edge. Cubes share the nodes
/// where they meet.
inline std::string cubes_geo(const std::vector<std::array<int, 3>>& lowest, int divisions) {
  std::string text = "SetFactory(\"OpenCASCADE\");\n";
  for (std::size_t k = 0; k < lowest.size(); ++k)
    text +=
        fmt::format("Box({}) = {{{}, {}, {}, 1, 1, 1}};\n", k + 1, lowest[k][0], lowest[k][1], lowest[k][2]);
  return text + fmt::format(
                    "Coherence;\nTransfinite Curve{{:}} = {};\nTransfinite Surface{{:}};\nRecombine "
                    "Surface{{:}};\nTransfinite Volume{{:}};\nPhysical Volume(\"body\") = Volume{{:}};\n",
                    divisions + 1);
}

}  // namespace ricochet::test
