// SPDX-License-Identifier: BSD-2-Clause
// The scene as plain data: the user's settings with all defaults. Independent of MPI and PETSc. The defaults
// in this file are those of the documentation. SI units.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kernels/damping.hpp"
#include "ricochet/quantity.hpp"
#include "ricochet/step_options.hpp"
#include "ricochet/units.hpp"

namespace ricochet::scene {

struct Material {
  std::string group;   ///< physical volume (rods: line) with this material; empty: the whole body
  double density = 0;  ///< [kg/m³]
  double young = 0;    ///< [Pa]
  double poisson = 0;  ///< [1], between −1 and 0.5
  double area = 0;     ///< cross-section of a rod [m²]; 0: not a rod
  double yield = 0;    ///< stress at which it yields [Pa]; 0: unknown. Kernels do not depend on it
  bool operator==(const Material&) const = default;
};

using Damping = kernels::Damping;

/// Small elements in a ball.
struct FineBall {
  Vector3 at{};       ///< [m], in the frame of the body
  double radius = 0;  ///< [m]
  double size = 0;    ///< longest edge of elements within the radius [m]
  bool operator==(const FineBall&) const = default;
};

struct Body {
  std::string name;
  std::filesystem::path mesh;              ///< resolved against the scene's folder
  std::map<std::string, double> geometry;  ///< DefineConstant overrides of a .geo
  int order = 3;
  double size_factor = 1;        ///< factor on the element sizes of a geometry (gmsh's Mesh.MeshSizeFactor)
  std::vector<FineBall> refine;  ///< of a geometry
  /// Whether ricochet-kernel chooses order, size_factor and refine for the accuracy.
  bool order_open = false, size_open = false, refine_open = false;
  double scale = 1;
  Vector3 translate{};              ///< [m], after rotation
  Vector3 rotate_deg{};             ///< about x, then y, then z, through the origin of the mesh
  std::vector<Material> materials;  ///< empty for an imported body
  Damping damping;
  Vector3 velocity{};                ///< initial velocity of the centre of mass [m/s]
  Vector3 angular_velocity{};        ///< initial, about the centre of mass, world axes [rad/s]
  double arrival = 0;                ///< time at which it is at its place, with its velocity [s]
  std::string copy_of{};             ///< the mallet of which it is a copy, for a further strike
  std::vector<std::string> contact;  ///< physical groups that may touch
  /// Fixed components by physical group: a subset of "xyz", in that order.
  std::map<std::string, std::string> support;

  /// Whether `mesh` is a body file: matrices or modes from another program, without elements or materials.
  bool imported() const { return mesh.extension() == ".h5"; }
  /// Whether gmsh meshes the body, so that it may have elements of any order.
  bool meshable() const { return !imported() && mesh.extension() != ".msh"; }
  bool operator==(const Body&) const = default;
};

/// Rigid half-space {x : (x − point)·normal ≤ 0}.
struct Obstacle {
  std::string name;
  Vector3 point{};
  Vector3 normal{};    ///< unit vector, pointing out of the obstacle
  Vector3 velocity{};  ///< along its surface [m/s]; felt only with friction
  bool operator==(const Obstacle&) const = default;
};

enum class Basis { modes, contact };

struct Modes {
  Basis basis = Basis::modes;
  /// With basis `modes`, exactly one of up_to and count is set. With basis `contact`, up_to is set together
  /// with one of count and flexibility_error. If neither up_to nor count is set, ricochet-kernel chooses them
  /// for the accuracy of the scene.
  std::optional<Hertz> up_to;
  std::optional<std::int64_t> count;  ///< including rigid modes
  /// Allowed error of the flexibility of the contact surface over [0, up_to]. With basis `modes`, modes that
  /// contact does not need are truncated.
  std::optional<double> flexibility_error;
  bool residual_flexibility = true;
  /// Whether the residual flexibility is always held in all components, and not along the normals alone where
  /// these suffice.
  bool all_components = false;
  double relative_residual = 1e-8;  ///< bound on each mode's residual
  std::string solver = "ricochet";  ///< basis `modes`: type of SLEPc's EPS
  double low_rank = 0;              ///< basis `contact`: threshold of block low-rank factors; 0: full rank
  bool open() const { return !up_to && !count; }
  bool operator==(const Modes&) const = default;
};

/// A contact pair. `a` is a body; `b` is a body or an obstacle.
struct Pair {
  std::string a, b;
  std::optional<Vector3> direction;    ///< unit vector, pointing out of a
  std::optional<Vector3> along;        ///< unit vector
  std::optional<double> spacing;       ///< [m]
  std::optional<double> gap;           ///< [m]
  std::optional<double> reach;         ///< [m]
  std::optional<double> zone;          ///< [m]
  std::optional<Friction> friction{};  ///< no value: frictionless; never with both coefficients 0
  bool names(const std::string& body) const { return a == body || b == body; }
  bool operator==(const Pair&) const = default;
};

enum class Solver { exact, uzawa };

/// How the response to contact forces is computed: from the modes of the bodies, or from kernels that are
/// sampled in time and convolved with the forces.
enum class ContactKernel { modes, table };

struct Contact {
  ContactKernel kernel = ContactKernel::modes;
  std::filesystem::path table;  ///< kernel = table: file that replaces the bodies; empty: sampled modes
  Scheme scheme = Scheme::compliant;
  ContactStep integration = ContactStep::conserving;  ///< compliant scheme only
  Admittance admittance = Admittance::jump;           ///< impulse scheme only
  Instant instant = Instant::step;                    ///< impulse scheme only
  double restitution = 0;                             ///< impulse scheme only, in [0, 1]
  Solver solver = Solver::exact;                      ///< scheme "static" only
  int increments = 20;                                ///< of each stage of the loads, at rest with friction
  std::optional<int> max_pivots;  ///< bound on the work of a step, at least 1; no value: unbounded
  std::vector<Pair> pairs;        ///< [contact] itself, or each [[contact.pair]]
  bool operator==(const Contact&) const = default;
  /// Whether contact steps have a rate of their own, beside that of the output.
  bool has_contact_rate() const { return scheme == Scheme::compliant && kernel == ContactKernel::modes; }
  /// Whether a pair with friction names this body or obstacle.
  bool rubs(const std::string& name) const;
};

/// Largest number of contact steps per output sample.
inline constexpr double most_steps_per_sample = 1e6;

struct Time {
  Hertz rate{44100};  ///< of the output samples
  std::optional<Hertz>
      contact_rate{};  ///< of contact steps, rounded up to a multiple of `rate`; no value: `rate`
  /// The rate of contact steps is not given and follows from the accuracy of the scene: contact_rate where
  /// contact steps have a rate of their own, otherwise `rate`.
  bool rate_by_accuracy = false;
  int steps_per_sample() const;
  double step() const { return 1 / (rate.value * steps_per_sample()); }  ///< of contact, Δ [s]
  /// Precision of the matrix products of the steps (scheme "compliant"); no value: chosen by the accuracy of
  /// the scene.
  std::optional<Precision> precision = Precision::float64;
  double duration = 0;  ///< [s]; 0: not given, as equilibrium needs none
  bool operator==(const Time&) const = default;
};

/// A force on a surface or at a point, or the displacement of a support or obstacle: `vector` times a
/// piecewise linear history. The history is a CSV of t [s] and a factor, which is 0 before the first row and
/// keeps its last value after the last row. Without a history, the factor is always 1: a dead load.
struct Forcing {
  /// Unique within a body or obstacle; default: the group, "point <number in the scene>", or the obstacle.
  std::string name;
  std::string body;   ///< empty for the motion of an obstacle
  std::string group;  ///< traction: physical surface; motion: support of the body
  Vector3 at{};       ///< point force: point of application in world axes, bodies as placed by the scene [m]
  Vector3 vector{};   ///< in world axes: [Pa], [N] or [m]
  std::filesystem::path history{};  ///< resolved against the scene's folder; empty: constant
  std::string obstacle{};           ///< motion: an obstacle that moves along its surface, in place of a body
  bool operator==(const Forcing&) const = default;
};

struct Loads {
  Vector3 gravity{};               ///< [m/s²]
  std::vector<Forcing> tractions;  ///< [[loads.traction]]
  std::vector<Forcing> points;     ///< [[loads.point]]
  std::vector<Forcing> motions;    ///< [[loads.motion]]
  bool operator==(const Loads&) const = default;
};

/// A point of a body whose motion is recorded.
struct Receiver {
  std::string name;
  std::string body;
  Vector3 at{};  ///< in world axes, bodies as placed by the scene [m]
  bool operator==(const Receiver&) const = default;
};

enum class SampleFormat { pcm16, pcm24, float32 };
/// Names of the formats in a scene, in their order.
inline constexpr std::array sample_format_names{"pcm16", "pcm24", "float"};

/// One or two receivers as a sound for players.
struct Sound {
  std::vector<std::string> receivers;  ///< one: mono; two: left and right
  Vector3 direction{};       ///< unit vector, world axes: the component of the velocity that is heard
  double high_pass_hz = 20;  ///< 0: none
  double fade = 0.02;        ///< at the end [s]
  SampleFormat format = SampleFormat::pcm24;
  bool operator==(const Sound&) const = default;
};

/// Rate to which receivers are reduced if other rows are omitted: enough for sound.
inline constexpr Hertz audio_rows{44100};
/// Largest number of output samples between rows of receivers.
inline constexpr int most_samples_per_receiver_row = 1000;

struct Output {
  int every = 1;                    ///< steps between rows of the result
  bool view = false;                ///< keep the visualisation surface in the kernels
  std::int64_t snapshot_every = 0;  ///< steps between snapshots of the modal coordinates; 0: none
  std::int64_t vtk_every = 0;  ///< steps between frames of the motion for ParaView; 0: none. Needs `view`
  std::vector<Receiver> receivers;        ///< [[output.receiver]]
  std::optional<Sound> sound{};           ///< [output.sound]
  std::optional<Hertz> receivers_rate{};  ///< of rows of receivers; no value: see receivers_every
  /// Output samples between rows of receivers, for `rate` output samples per second.
  int receivers_every(Hertz rate) const;
  bool operator==(const Output&) const = default;
};

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
  /// Sorted by name, with copies of mallets behind; empty with contact.table.
  std::vector<Body> bodies;
  std::vector<Strike> strikes{};  ///< [[strikes]], already applied to bodies and pairs
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

/// Accuracy of a scene that leaves its modes open and gives none.
inline constexpr double default_accuracy = 1e-2;

/// The text of one option `--set KEY=VALUE`.
using Override = std::string;

/// The title in lower case. Each run of other characters than a–z and 0–9 becomes one "-", except at the
/// ends. Returns "scene" if nothing remains.
std::string slug(const std::string& title);

/// Rotation matrix of `rotate_deg`, row-major (3,3): world = rotation · body + translate.
std::array<double, 9> rotation_of(const Body& body);

/// Components of a world vector along the axes of the body.
Vector3 in_body(const Body& body, const Vector3& world);

/// The component of a vector along the normal of the obstacle; exactly 0 if it is round-off.
double along_normal(const Obstacle& obstacle, const Vector3& vector);

}  // namespace ricochet::scene
