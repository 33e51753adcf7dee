// SPDX-License-Identifier: BSD-2-Clause
// The scene that the library runs. The scene that programs read (src/scene/scene.hpp) has the same structs,
// and beside them what meshes, kernels and files need. SI units; vectors are in world axes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ricochet/friction.hpp"
#include "ricochet/kernel.hpp"
#include "ricochet/scheme.hpp"

namespace ricochet {

/// A constant kernel, shared by any number of simulations and threads.
using SharedKernel = std::shared_ptr<const kernels::Kernel>;

/// A kernel placed in the world: first rotated, then translated.
struct Body {
  std::string name;
  SharedKernel kernel{};
  Vector3 rotate_deg{};        ///< about the fixed axes x, then y, then z
  Vector3 translate{};         ///< [m]
  Vector3 velocity{};          ///< initial, of the centre of mass [m/s]
  Vector3 angular_velocity{};  ///< initial, about the centre of mass, world axes [rad/s]
  /// When it is at its place with its velocity [s]. Until then, it falls freely.
  double arrival = 0;
  bool operator==(const Body&) const = default;
};

/// A load of a kernel, or the motion of a support: `vector` times a factor that is 0 before its first time,
/// linear between its times and constant after the last one. A support must not jump.
struct Forcing {
  std::string body;
  std::string name;  ///< of the load, or of the support, in the kernel
  bool support = false;
  Vector3 vector{};  ///< of a load [Pa] or [N]; of a support [m]; world axes, at t = 0
  /// Ascending [s]. Without times, the factor has always been 1: bodies start at rest under a dead load.
  std::vector<double> time{};
  std::vector<double> factor{};  ///< one for each time
  /// In which the vector of a load is constant while its body turns, with finite rotations. No value: of the
  /// body for a traction [Pa], as pressure acts, and of the world for a force [N].
  std::optional<Axes> axes{};
  /// Of a load that presses against the outward normal at each point of its surface, in place of `vector`
  /// [Pa].
  std::optional<double> pressure{};
  bool operator==(const Forcing&) const = default;
};

/// A displacement of an obstacle, and a turn about its `point`: each is a vector times a factor that is 0
/// before its first time, linear between its times and constant after the last one. It must not jump.
struct Slide {
  Vector3 vector{};              ///< [m]
  std::vector<double> time{};    ///< ascending [s]
  std::vector<double> factor{};  ///< one for each time
  Vector3 turn_deg{};            ///< axis times angle, world axes [degrees]; not of a half-space
  bool operator==(const Slide&) const = default;
};

/// A closed surface of flat triangles. Edges at which they meet at less than 29° are smooth: there, the
/// surface between the nodes is curved.
struct SurfaceMesh {
  std::vector<Vector3> node{};  ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangle{};
  bool operator==(const SurfaceMesh&) const = default;
};

/// What bounds an obstacle. The axis of a shape is z before the obstacle is rotated, and its middle is the
/// origin.
enum class Shape {
  half_space,  ///< {x : (x − point)·normal ≤ 0}
  sphere,      ///< of `radius`
  cylinder,    ///< of `radius` and `length`, with flat ends
  capsule,     ///< a cylinder of `radius` and `length` between two hemispheres
  box,         ///< with the edges `size`
  cone,        ///< of `length`, with `radius` at its lower end, and `radius_small` at its upper end
  torus,       ///< a tube of `radius_small` around a circle of `radius`
  mesh,        ///< the closed surface `mesh`
};

/// On which side of its surface bodies are.
enum class ObstacleSide { outside, inside };

/// A rigid obstacle.
struct Obstacle {
  std::string name;
  Vector3 point{};   ///< of the surface of a half-space; of others, where their origin is [m]
  Vector3 normal{};  ///< outward, of any nonzero length; of a half-space only
  /// [m/s]. Pairs with friction alone feel what is along the surface of a half-space, as of a conveyor belt.
  Vector3 velocity{};
  std::vector<Slide> slides{};  ///< further motions, which add up
  Shape shape = Shape::half_space;
  ObstacleSide side = ObstacleSide::outside;  ///< of all but half-spaces, as are the following ones
  Vector3 rotate_deg{};                       ///< about the fixed axes x, then y, then z, through `point`
  double radius = 0, radius_small = 0, length = 0;  ///< [m]
  Vector3 size{};                                   ///< along x, y, z [m]
  SurfaceMesh mesh{};
  Vector3 angular_velocity{};  ///< about `point`, world axes [rad/s]; turns of `slides` have the same axis
  bool operator==(const Obstacle&) const = default;
};

/// Two surfaces that may touch, by name.
struct Pair {
  std::string a;                       ///< a body
  std::string b;                       ///< a body or an obstacle
  std::optional<Vector3> direction{};  ///< of contact, out of a; default: from the surface normals
  /// Moves body a along the direction until the closest points have this gap [m].
  std::optional<double> gap{};
  std::optional<double> reach{};  ///< drops points whose initial gap is not below this [m]
  /// Drops points whose initial gap exceeds that of the closest ones by this or more [m].
  std::optional<double> zone{};
  /// Coulomb friction, except of the impulse scheme. Kernels must then hold all three components, also of the
  /// static correction, as those of a scene with contact.friction do. No value, or coefficients of 0:
  /// frictionless.
  std::optional<Friction> friction{};
  bool operator==(const Pair&) const = default;
};

/// An audio channel: the motion of a point of a body along a direction. Unlike a receiver, it has one
/// component, and it may be a contact candidate.
struct Pickup {
  std::string body;
  std::string receiver{};     ///< a receiver of the kernel, by name; if empty, `candidate` is used
  std::size_t candidate = 0;  ///< row of the kernel's surface.node, if no receiver is named
  Vector3 direction{};        ///< of any nonzero length
};

struct Scene : ContactScheme, Stepping, RigidBodies {
  std::vector<Body> bodies{};
  std::vector<Obstacle> obstacles{};
  std::vector<Pair> pairs{};
  std::vector<Pickup> pickups{};
  std::vector<Forcing> forcing{};
  Vector3 gravity{};  ///< [m/s²]
};

}  // namespace ricochet
