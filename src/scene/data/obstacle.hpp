// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <filesystem>

#include "ricochet/scene.hpp"

namespace ricochet::scene {

/// What files need beside the settings of the library, whose `mesh` it does not hold.
struct Obstacle : ricochet::Obstacle {
  std::filesystem::path surface{};  ///< of a mesh: an STL file, resolved against the scene's folder
  double scale = 1;                 ///< of its coordinates

  bool is_half_space() const { return shape == Shape::half_space; }
  bool operator==(const Obstacle&) const = default;
};

}  // namespace ricochet::scene
