// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <optional>
#include <string>

#include "ricochet/units.hpp"

namespace ricochet::scene {

/// Constants of a material with three planes of symmetry, which are normal to its axes 1, 2 and 3.
struct Orthotropy {
  Vector3 young{};  ///< E1, E2, E3 [Pa]
  Vector3 shear{};  ///< G23, G13, G12 [Pa]
  Vector3 poisson{};  ///< ν23, ν13, ν12 [1]: ν_ij = −ε_j/ε_i under a stress along i, so ν_ij/E_i = ν_ji/E_j
  bool operator==(const Orthotropy&) const = default;
};

/// A straight line in the axes of the mesh.
struct CentreLine {
  Vector3 point{};      ///< [m], after Body::scale
  Vector3 direction{};  ///< of length 1
  bool operator==(const CentreLine&) const = default;
};

/// A material is isotropic, or it has one of the laws `orthotropy` and `stiffness` in axes of its own.
struct Material {
  std::string group;   ///< physical volume (rods: line) with this material; empty: the whole body
  double density = 0;  ///< [kg/m³]
  double young = 0;    ///< [Pa]; 0 unless isotropic
  double poisson = 0;  ///< [1], between −1 and 0.5; 0 unless isotropic
  double area = 0;     ///< cross-section of a rod [m²]; 0: not a rod
  double yield = 0;    ///< stress at which it yields [Pa]; 0: unknown. Kernels do not depend on it
  std::optional<Orthotropy> orthotropy{};
  /// Upper triangle of C by rows [Pa]: stress xx, yy, zz, yz, xz, xy = C · strain, with the engineering shear
  /// strains γ = 2 ε
  std::optional<std::array<double, 21>> stiffness{};
  /// Axes 1 and 2 in the axes of the mesh, orthonormal. Axis 3 completes a right-handed system.
  std::array<Vector3, 2> axes{{{1, 0, 0}, {0, 1, 0}}};
  /// Instead of `axes`: at each point, axis 1 is radial from this line, axis 2 tangential, and axis 3 along
  /// it
  std::optional<CentreLine> about{};

  bool isotropic() const { return !orthotropy && !stiffness; }
  bool operator==(const Material&) const = default;
};

}  // namespace ricochet::scene
