// SPDX-License-Identifier: BSD-2-Clause
// Impacts of elastic bodies from their kernels, for use inside another program.
//
//   ricochet::Scene scene;
//   scene.bodies = {{.name = "bar", .kernel = ricochet::load_kernel("bar.kernel.h5"),
//                    .velocity = {0, 0, -1}}};
//   scene.obstacles = {{.name = "floor", .normal = {0, 0, 1}}};
//   scene.pairs = {{.a = "bar", .b = "floor", .gap = 1e-3}};
//   scene.pickups = {{.body = "bar", .direction = {0, 0, 1}}};
//   ricochet::Simulation simulation(scene);
//   std::vector<double> sound(512);
//   simulation.step_block(512, {.velocity = sound.data()});
//
// This header requires only the standard library. Units are SI; vectors are in world axes. Every array is
// row-major, with its shape beside it: n steps, m contact points, p pickups.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ricochet/denormals.hpp"
#include "ricochet/energy.hpp"
#include "ricochet/error.hpp"
#include "ricochet/kernel.hpp"
#include "ricochet/material_limits.hpp"
#include "ricochet/scene.hpp"
#include "ricochet/step_status.hpp"

namespace ricochet {

/// Reads a kernel file. Throws a one-line InputError if the file is missing, truncated, not a kernel, or
/// inconsistent. Call it from one thread at a time, because HDF5 may not be thread-safe.
SharedKernel load_kernel(const std::filesystem::path& path);

/// Reads the surface of an obstacle of the shape `mesh` from an STL file, text or binary, or an OBJ file.
/// Throws a one-line InputError if the file is missing or of another kind. @param scale  of its coordinates,
/// which become metres
SurfaceMesh load_surface(const std::filesystem::path& path, double scale = 1);

/// Writes a kernel file (docs/formats/kernel.md); a partial file never has the final name. Throws a one-line
/// InputError if the place cannot be written. Call it from one thread at a time, like load_kernel.
void save_kernel(const kernels::Kernel& kernel, const std::filesystem::path& path);

struct ContactPoint {
  /// Index into Scene::pairs; `no_pair` for a pair of a body that was added.
  std::size_t pair = 0;
  static constexpr std::size_t no_pair = static_cast<std::size_t>(-1);
  Vector3 a{}, b{}, normal{};  ///< points on a and b that face each other [m]; unit normal out of a
  double gap = 0;              ///< initial [m]
  double area = 0;             ///< of the patch of a [m²]
};

/// A point that touches.
struct Touching {
  std::size_t point = 0;  ///< index into Simulation::points()
  /// Names of bodies a and b, or of a and an obstacle. Valid until a body is added or removed.
  std::array<std::string_view, 2> between{};
  Vector3 place{};   ///< on body a, now; with linear rotations, at the start [m]
  Vector3 normal{};  ///< unit, out of a, likewise
  Vector3 force{};   ///< on body b, or on the obstacle: of contact and friction, the mean over the step [N]
};

/// Where a body is, and how it moves as a whole, in world axes.
struct BodyMotion {
  Vector3 position{};                          ///< of its centre of mass [m]
  std::array<double, 4> attitude{1, 0, 0, 0};  ///< unit quaternion w, x, y, z, from the axes of the kernel
  Vector3 velocity{};                          ///< of that centre [m/s]
  Vector3 spin{};                              ///< [rad/s]
};

/// A point of a body: a receiver of its kernel, by name, or a contact candidate.
struct BodyPoint {
  std::string_view receiver{};  ///< if empty, `candidate` is used
  std::size_t candidate = 0;    ///< row of the kernel's surface.node
};

/// Output arrays of step_block, with one row per step; null if not requested.
struct Block {
  double* velocity = nullptr;          ///< (n,p) of the pickups [m/s]
  double* total_force = nullptr;       ///< (n) Σ λ_i [N]
  double* force = nullptr;             ///< (n,m) λ_i [N]
  double* displacement = nullptr;      ///< (n,m) u_i [m]
  double* tangential_force = nullptr;  ///< (n,m,3) of friction on body b or, negated, on a [N]
};

struct BlockResult {
  std::int64_t steps =
      0;  ///< steps made; fewer than requested if the status is not ok, or OnContact ended it
  StepStatus status = StepStatus::ok;
};

/// Is called after each step in which points touch, and, without points, after the first step in which none
/// touches any more. Returns whether a block of steps goes on. Must not step, restore or change the
/// simulation.
using OnContact = bool (*)(void* user, std::span<const Touching> contacts);

/// Bodies in motion. The constructor computes and allocates all constant data. Functions that are noexcept
/// neither allocate nor lock nor call the system, so they may run in an audio callback. Use each simulation
/// from one thread at a time; different simulations share only constant data. A moved-from simulation can
/// only be assigned to.
class Simulation {
 public:
  class State;

  /// Throws a one-line InputError if the scene cannot be placed, paired or stepped.
  explicit Simulation(const Scene& scene);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// Makes one step. If the status is not ok, the state is that after the last contact step that succeeded.
  StepStatus step() noexcept;

  /// Makes `steps` steps, bitwise equal to those of step(), and faster unless displacements are requested.
  /// Rows from a failed step on are 0.
  BlockResult step_block(std::int64_t steps, const Block& out = {}) noexcept;

  std::int64_t steps() const noexcept;  ///< since t = 0
  double time() const noexcept;         ///< [s]

  std::span<const ContactPoint> points()
      const noexcept;                              ///< (m); m may change when a body is added or removed
  std::span<const double> force() const noexcept;  ///< (m) λ_i ≥ 0 [N], the mean over the last step
  std::span<const double> displacement() const noexcept;  ///< (m) u_i [m]; the gap is now g_i − u_i
  /// (m,3) force of friction on body b, and negated on a [N]: the mean over the last step, perpendicular to
  /// the normal. 0 for points without friction.
  std::span<const double> tangential_force() const noexcept;
  int active() const noexcept;  ///< points in contact at the end of the last step
  /// The points with a force in the last step. Valid until the next call.
  std::span<const Touching> contacts() noexcept;

  /// Calls `callback` from now on, in the thread that steps; null: no longer. @param user  is passed to it
  void on_contact(OnContact callback, void* user = nullptr) noexcept;

  std::size_t pickups() const noexcept;  ///< p
  /// Motion of the modes at the end of the last step, with the motion that supports give them and without the
  /// static correction. With finite rotations, that of the point of the body that turns, along the direction
  /// in the world.
  double pickup_velocity(std::size_t pickup) const noexcept;      ///< [m/s]
  double pickup_displacement(std::size_t pickup) const noexcept;  ///< since t = 0 [m]

  // Functions below take the number of a body: its index in Scene::bodies, or what `add` has returned. A
  // number stays that of its body, whatever is added or removed, and is never used again.

  Vector3 mean_velocity(std::size_t body) const noexcept;  ///< averaged over the mass [m/s]; NaN if removed
  /// At the end of the last step. With linear rotations, the attitude is that of the rotation vector of the
  /// rigid modes. NaN if the body has been removed.
  BodyMotion body_motion(std::size_t body) const noexcept;
  /// Sets a force [N] and a torque about the centre of mass [N m] from outside, in world axes, which act on a
  /// body until they are set again. Returns false and does nothing unless rotations are finite and the body
  /// is there.
  bool push(std::size_t body, const Vector3& force, const Vector3& torque) noexcept;
  /// Sets a force [N] from outside at a point of a body, which acts from the next step on until it is set
  /// again at this point; 0 ends it. It is constant over a step and in world axes, and it moves and deforms
  /// the body: with finite rotations, its arm turns with the body. Its work is part of energy().loads. Costs
  /// a product of contact points and modes, unless the force is the one that acts.
  ///
  /// Modes up to half the rate respond. With linear rotations, contact points of the body also respond by the
  /// static correction of the kernel, at once; pickups and, with finite rotations, contact points do not.
  ///
  /// Returns false and does nothing if the body or the point is not there, if the force is not finite, if
  /// forces act at 1024 other points, or if the kernel holds one component of the motion of the candidate and
  /// the force has another one.
  bool push_at(std::size_t body, const BodyPoint& point, const Vector3& force) noexcept;

  /// Adds a body between two steps, with its elastic modes at rest. It may meet every other body and every
  /// obstacle, with this friction. Returns its number. The other bodies go on as if nothing had happened, and
  /// energy().added grows by what the body brings. Takes time and memory for its pairs with all the others,
  /// unless one with the same `kernel` has been removed, whose place it then takes. Throws a one-line
  /// InputError, and changes nothing, if the name is taken, if the body would overlap another one or an
  /// obstacle (with the depth), if the kernel does not allow finite rotations, or if rotations are linear.
  std::size_t add(const std::string& name, const SharedKernel& kernel, const BodyMotion& motion,
                  const std::optional<Friction>& friction = {});
  /// Removes a body between two steps. Its contacts vanish at once, and its pickups are silent from now on.
  /// Throws a one-line InputError if it is not there, or if rotations are linear.
  void remove(std::size_t body);

  /// Number of modes of the kernel of a body; 0 if it has been removed.
  std::size_t modes(std::size_t body) const noexcept;
  /// Coordinates of the modes of its kernel at the end of the last step, in their order, without the motion
  /// that supports give: the displacement of the body is Σ shape_n · displacement_n plus the static
  /// correction. The first modes are those of the rigid body, which with finite rotations are 0: body_motion
  /// has them. Modes above half the rate respond statically and are 0.
  /// @param displacement, velocity  (modes) [kg^1/2 m], [kg^1/2 m/s]; null if not requested
  void modal_coordinates(std::size_t body, double* displacement, double* velocity) const noexcept;

  std::span<const std::size_t> bodies() const noexcept;  ///< numbers of those that are there, ascending
  /// The number of a body that is there; no value: none has this name.
  std::optional<std::size_t> find(std::string_view name) const noexcept;
  /// The name of a body that is there; otherwise "".
  std::string_view name(std::size_t body) const noexcept;

  /// Judges the run from here on, as that of an impact is judged: whether bodies turn too far, approach too
  /// fast, yield, meet where no candidates are, or have too few of them. Steps then allocate and are slower,
  /// so they must not run in an audio callback. Call it again to begin anew, and after `restore`.
  /// @param limits        by index into Scene::bodies; empty: unknown
  /// @param slowest_wave  smallest √(E/ρ) of the bodies [m/s]; 0: unknown
  void watch(std::span<const MaterialLimits> limits = {}, double slowest_wave = 0);
  /// What is doubtful in the steps since `watch`, one line each; empty without it.
  std::vector<std::string> warnings() const;

  Energy energy() const noexcept;
  int quasi_static_modes() const noexcept;  ///< modes above half the rate, which respond statically

  /// Returns the complete state of motion. Allocates.
  State save() const;

  /// Continues from `state`; the following steps are bitwise the same. Returns false and changes nothing if
  /// `state` is of another system: if the kernels, the scene, or the bodies that were added and removed so
  /// far and their order differ. What was added to a place of its own must have had the same motion.
  /// Allocates if `state` was saved by another simulation, of an equal system.
  bool restore(const State& state) noexcept;

  /// The state that State::bytes has written, perhaps in another process. Throws a one-line InputError if the
  /// bytes are damaged, or if they are of another system or another version of this library.
  State state(std::span<const std::byte> bytes) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The state of one simulation at one time.
class Simulation::State {
 public:
  ~State();
  State(State&&) noexcept;
  State& operator=(State&&) noexcept;

  /// The state as bytes, with a digest of its system and one of the bytes. They suit the version of the
  /// library that wrote them, on machines with the same kind of processor.
  std::vector<std::byte> bytes() const;

 private:
  friend class Simulation;
  struct Impl;
  explicit State(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace ricochet
