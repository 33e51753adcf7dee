// SPDX-License-Identifier: BSD-2-Clause
// The scene as plain data: what the user asked for, with every default resolved. No MPI, no PETSc.
// Defaults written here are the documented defaults. SI units.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kernels/damping.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::scene {

struct Material {
  std::string group;   ///< physical volume (line, for rods) it fills; empty: the whole body
  double density = 0;  ///< [kg/m³]
  double young = 0;    ///< [Pa]
  double poisson = 0;  ///< 1, in (-1, 0.5)
  double area = 0;     ///< cross-section of a rod [m²]; 0: not given (not a rod)
  bool operator==(const Material&) const = default;
};

using Damping = kernels::Damping;

struct Body {
  std::string name;
  std::filesystem::path mesh;              ///< resolved against the scene's folder
  std::map<std::string, double> geometry;  ///< DefineConstant overrides of a .geo
  int order = 3;
  double scale = 1;
  Vector3 translate{};              ///< [m], after rotation
  Vector3 rotate_deg{};             ///< about x, then y, then z through the mesh's origin
  std::vector<Material> materials;  ///< none of an imported body
  Damping damping;
  Vector3 velocity{};                ///< [m/s], initial, rigid
  std::vector<std::string> contact;  ///< physical groups that may touch
  std::map<std::string, std::string>
      support;  ///< physical group → fixed components, a subset of "xyz" in that order

  /// Whether `mesh` is a body file: matrices or modes of another program, without elements or materials.
  bool imported() const { return mesh.extension() == ".h5"; }
  bool operator==(const Body&) const = default;
};

/// Rigid half-space {x : (x − point)·normal ≤ 0}.
struct Obstacle {
  std::string name;
  Vector3 point{};
  Vector3 normal{};  ///< unit, out of the obstacle
  bool operator==(const Obstacle&) const = default;
};

enum class Basis { modes, contact };

struct Modes {
  Basis basis = Basis::modes;
  /// Modes: exactly one of up_to and count is set. Contact: up_to is set, and one of count and
  /// flexibility_error.
  std::optional<Hertz> up_to;
  std::optional<std::int64_t> count;  ///< rigid modes included
  std::optional<double>
      flexibility_error;  ///< of the contact surface over [0, up_to]; modes: leave out those it doesn't need
  /// Neither up_to nor count is set, and ricochet-kernel chooses what makes results as accurate as this.
  std::optional<double> accuracy;
  bool residual_flexibility = true;
  double relative_residual = 1e-8;  ///< bound on each mode's residual
  int approximate = 0;  ///< modes: so many block iterations from the next lower order; 0: certified modes
  double low_rank = 0;  ///< contact: threshold of block low-rank factors; 0: full rank
  bool operator==(const Modes&) const = default;
};

/// How one surface meets another. `a` is a body; `b` a body or an obstacle.
struct Pair {
  std::string a, b;
  std::optional<Vector3> direction;  ///< unit, out of a
  std::optional<Vector3> along;      ///< unit
  std::optional<double> spacing;     ///< [m]
  std::optional<double> gap;         ///< [m]
  std::optional<double> reach;       ///< [m]
  bool operator==(const Pair&) const = default;
};

enum class Solver { exact, uzawa };

/// What answers a contact force: the bodies' modes, or kernels sampled in time and convolved with the forces.
enum class ContactKernel { modes, table };

struct Contact {
  ContactKernel kernel = ContactKernel::modes;
  std::filesystem::path
      table;  ///< of kernel = table: a file that takes the place of bodies; empty: their modes
  Scheme scheme = Scheme::compliant;
  Admittance admittance = Admittance::jump;  ///< of the impulse scheme
  Instant instant = Instant::step;           ///< of the impulse scheme
  double restitution = 0;                    ///< of the impulse scheme, in [0, 1]
  Solver solver = Solver::exact;             ///< of bodies at rest (scheme "static")
  std::optional<int> max_pivots;  ///< bound on the work of a step, at least 1; none: solved whatever it takes
  std::vector<Pair> pairs;        ///< [contact] itself, or each [[contact.pair]]
  bool operator==(const Contact&) const = default;
};

struct Time {
  Hertz rate{44100};
  bool rate_by_accuracy = false;  ///< not given: the scene's accuracy chooses it
  /// Of the products of steps (scheme "compliant"); none: the scene's accuracy chooses it.
  std::optional<Precision> precision = Precision::float64;
  double duration = 0;  ///< [s]; 0: not given, as bodies at rest need none
  bool operator==(const Time&) const = default;
};

/// A force on a surface or at a point, or the displacement of a support: `vector` times a history that is
/// piecewise linear in time (CSV of t [s] and a factor; 0 before the first row, the last value after the last
/// one). Without a history it is constant from t = 0 on.
struct Driven {
  std::string name;  ///< unique within a body; default: the group, or "point <number in the scene>"
  std::string body;
  std::string group;                ///< traction: physical surface; motion: a support of the body
  Vector3 at{};                     ///< point force: where, world axes, bodies as placed by translate [m]
  Vector3 vector{};                 ///< world axes: [Pa], [N], [m]
  std::filesystem::path history{};  ///< resolved against the scene's folder; empty: constant
  bool operator==(const Driven&) const = default;
};

struct Loads {
  Vector3 gravity{};              ///< [m/s²]
  std::vector<Driven> tractions;  ///< [[loads.traction]]
  std::vector<Driven> points;     ///< [[loads.point]]
  std::vector<Driven> motions;    ///< [[loads.motion]]
  bool operator==(const Loads&) const = default;
};

/// A point of a body whose motion is recorded.
struct Receiver {
  std::string name;
  std::string body;
  Vector3 at{};  ///< world axes, bodies as placed by translate [m]
  bool operator==(const Receiver&) const = default;
};

struct Output {
  int every = 1;                    ///< write each n-th step
  bool view = false;                ///< keep the skin in the kernels, for pictures
  std::int64_t snapshot_every = 0;  ///< modal coordinates each n-th step; 0: none
  std::int64_t vtk_every = 0;  ///< a frame of the motion for ParaView each n-th step; 0: none. Needs view
  std::vector<Receiver> receivers;  ///< [[output.receiver]]
  bool operator==(const Output&) const = default;
};

struct Scene {
  std::string title;
  std::filesystem::path file;  ///< as the user named it: errors start with it
  /// Relative error that the main results may have: chooses what is left open, and errors are estimated.
  std::optional<double> accuracy;
  std::vector<Body> bodies;  ///< in the order of their names; none with contact.table
  std::vector<Obstacle> obstacles;
  Modes modes;
  Contact contact;
  Time time;
  Loads loads;
  Output output;

  const Body* find_body(const std::string& name) const;
  const Obstacle* find_obstacle(const std::string& name) const;
  bool operator==(const Scene&) const = default;
};

/// The text of one option `--set KEY=VALUE`.
using Override = std::string;

/// Title in lower case, runs of other than a–z and 0–9 one "-", trimmed; "scene" when nothing is left.
std::string slug(const std::string& title);

/// Rotation matrix of `rotate_deg`, row-major (3,3): world = rotation · body + translate.
std::array<double, 9> rotation_of(const Body& body);

}  // namespace ricochet::scene
