// SPDX-License-Identifier: BSD-2-Clause
// The scene as plain data: the user's settings with all defaults. Independent of MPI and PETSc. The defaults
// in this file are those of the documentation. SI units.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ricochet/quantity.hpp"
#include "src/scene/data/body.hpp"
#include "src/scene/data/contact.hpp"
#include "src/scene/data/loads.hpp"
#include "src/scene/data/modes.hpp"
#include "src/scene/data/motion.hpp"
#include "src/scene/data/obstacle.hpp"
#include "src/scene/data/output.hpp"
#include "src/scene/data/time.hpp"

namespace ricochet::scene {

/// A blow by a mallet, a body that flies freely until then. The first strike of a mallet is that of the body
/// itself, and each further one that of a copy; copies do not touch each other.
struct Strike {
  std::string mallet;
  double time = 0;      ///< when the mallet is at its place [s]
  double speed = 0;     ///< there [m/s]
  Vector3 direction{};  ///< of its velocity; unit vector
  Vector3 translate{};  ///< its place, as for bodies [m]
  Vector3 rotate_deg{};
  bool operator==(const Strike&) const = default;
};

struct Scene {
  std::string title;
  std::filesystem::path file;  ///< as the user named it; errors begin with it
  /// Allowed relative error of the quantities in `accuracy_of`. If set, it chooses the settings that the
  /// scene leaves open and requests error estimates.
  std::optional<double> accuracy;
  std::vector<Quantity> accuracy_of{Quantity::impulse, Quantity::rebound};
  /// File of the settings chosen for `accuracy`, beside the kernels; empty: named after the bodies.
  std::string settings{};
  /// Sorted by name, then copies of mallets; empty with contact.table.
  std::vector<Body> bodies;
  std::vector<Strike> strikes{};    ///< [[strikes]], already applied to bodies and pairs
  std::vector<Obstacle> obstacles;  ///< half-spaces with a unit normal
  Modes modes;
  Contact contact;
  Motion motion;
  Time time;
  Loads loads;
  Output output;

  const Body* find_body(const std::string& name) const;
  const Obstacle* find_obstacle(const std::string& name) const;
  bool operator==(const Scene&) const = default;
};

/// Whether the ending of a file is that of a mesh which gmsh does not read, or without its groups, and
/// `ricochet import mesh` converts.
bool is_foreign_mesh(const std::filesystem::path& file);

/// The scene with finite rotations, which it leaves open. @param reason  why
Scene with_finite_rotation(Scene scene, std::string reason);

/// The component of a vector along the normal of the obstacle; exactly 0 if it is round-off.
double along_normal(const Obstacle& obstacle, const Vector3& vector);

/// Whether an obstacle moves, in any way and otherwise than along the surface of a half-space.
bool moves(const Scene& scene, const Obstacle& obstacle);
bool leaves_its_surface(const Scene& scene, const Obstacle& obstacle);

/// Accuracy of a scene that leaves its modes open and gives none.
inline constexpr double default_accuracy = 1e-2;

/// The text of one option `--set KEY=VALUE`.
using Override = std::string;

/// The title in lower case, for names of files. Each run of other characters than a–z and 0–9 becomes one
/// "-", except at the ends; "scene" if nothing remains. If this loses more than the separators of words (" ",
/// "_",
/// "/", ".", ", " and ": " for "-"), six digits of the SHA-256 of the title follow, so that titles such as
/// "v=1.0" and "v=-1.0" give different names.
std::string slug(const std::string& title);

}  // namespace ricochet::scene
