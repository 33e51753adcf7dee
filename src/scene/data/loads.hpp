// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ricochet/scene.hpp"

namespace ricochet::scene {

/// A force on a surface or at a point, or the displacement of a support or obstacle. Its times and factors
/// are those of a CSV of t [s] and a factor. Its name is unique within a body or obstacle; default: the
/// group, "point <number in the scene>", or the obstacle.
struct Forcing : ricochet::Forcing {
  std::string group;                ///< traction: physical surface; motion: support of the body
  Vector3 at{};                     ///< point force: point of application [m]
  std::filesystem::path history{};  ///< resolved against the scene's folder; empty: constant
  std::string obstacle{};           ///< motion: an obstacle that moves, in place of a body
  Vector3 turn_deg{};               ///< motion of an obstacle: axis times angle about its point [degrees]
  Axes at_axes = Axes::world;       ///< of `at`: of the world, bodies as placed by the scene, or of the mesh
  bool operator==(const Forcing&) const = default;
};

struct Loads {
  Vector3 gravity{};               ///< [m/s²]
  std::vector<Forcing> tractions;  ///< [[loads.traction]]
  std::vector<Forcing> points;     ///< [[loads.point]]
  std::vector<Forcing> motions;    ///< [[loads.motion]]
  bool operator==(const Loads&) const = default;
};

}  // namespace ricochet::scene
