// Impacts of elastic bodies from their kernels, inside another program: place, pair, step, listen.
//
//   ricochet::Scene scene;
//   scene.bodies = {{.name = "bar", .kernel = ricochet::load_kernel("bar.kernel.h5"), .velocity = {0, 0,
//   -1}}}; scene.obstacles = {{.name = "floor", .normal = {0, 0, 1}}}; scene.pairs = {{.a = "bar", .b =
//   "floor", .gap = 1e-3}}; scene.pickups = {{.body = "bar", .direction = {0, 0, 1}}}; ricochet::Simulation
//   simulation(scene); std::vector<double> sound(512); simulation.step_block(512, {.velocity =
//   sound.data()});
//
// Needs the standard library alone. SI units, world axes. Every array is row-major, its shape beside it:
// n steps, m contact points, p pickups.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ricochet/denormals.hpp"
#include "ricochet/error.hpp"
#include "ricochet/kernel.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet {

/// Constant, and shared by any number of simulations and threads.
using SharedKernel = std::shared_ptr<const kernels::Kernel>;

/// Throws InputError, one line, on a missing, truncated, foreign or inconsistent file. One thread at a time:
/// HDF5 may not be built for more.
SharedKernel load_kernel(const std::filesystem::path& path);

/// Writes a kernel file (FORMAT.md of the kernels); a partial file never has the final name. Throws
/// InputError, one line, when the place cannot be written. One thread at a time, as load_kernel.
void save_kernel(const kernels::Kernel& kernel, const std::filesystem::path& path);

/// A kernel placed in the world: first turned, then moved.
struct Body {
  std::string name;
  SharedKernel kernel{};
  Vector3 rotate_deg{};  ///< about the fixed axes x, then y, then z
  Vector3 translate{};   ///< [m]
  Vector3 velocity{};    ///< initial, rigid [m/s]
};

/// Rigid half-space {x : (x − point)·normal ≤ 0}.
struct HalfSpace {
  std::string name;
  Vector3 point{};   ///< [m]
  Vector3 normal{};  ///< out of it, of any length but 0
};

/// Which surfaces meet, by name.
struct Pair {
  std::string a;                       ///< a body
  std::string b;                       ///< a body or a half-space
  std::optional<Vector3> direction{};  ///< of contact, out of a; otherwise found from the surfaces' normals
  std::optional<double>
      gap{};  ///< [m] moves body a along the direction until the closest points have this gap
  std::optional<double> reach{};  ///< [m] drops points whose initial gap is not below it
};

/// An audio channel: the motion of a point of a body along a direction. It keeps a name of its own, which the C
/// functions share: unlike a receiver, it may be a contact candidate and has one component.
struct Pickup {
  std::string body;
  std::string receiver{};     ///< one of the kernel's receivers, by name; empty: a candidate of contact
  std::size_t candidate = 0;  ///< row of the kernel's surface.node, where no receiver is named
  Vector3 direction{};        ///< of any length but 0
};

struct Scene {
  std::vector<Body> bodies{};
  std::vector<HalfSpace> obstacles{};
  std::vector<Pair> pairs{};
  std::vector<Pickup> pickups{};
  Vector3 gravity{};  ///< [m/s²]
  Scheme scheme = Scheme::compliant;
  Admittance admittance = Admittance::jump;
  double restitution = 0;         ///< of the impulse scheme, in [0, 1]
  double rate_hz = 44100;         ///< steps a second
  bool single_precision = false;  ///< of products of the compliant scheme: faster, less exact
};

struct ContactPoint {
  std::size_t pair = 0;        ///< index into Scene::pairs
  Vector3 a{}, b{}, normal{};  ///< facing places on a and b [m]; unit normal out of a
  double gap = 0;              ///< initial [m]
  double area = 0;             ///< of a's patch [m²]
};

/// Where step_block writes, a row a step; null: not wanted.
struct Block {
  double* velocity = nullptr;      ///< (n,p) of the pickups [m/s]
  double* total_force = nullptr;   ///< (n) Σ λ_i [N]
  double* force = nullptr;         ///< (n,m) λ_i [N]
  double* displacement = nullptr;  ///< (n,m) u_i [m]
};

struct BlockResult {
  std::int64_t steps = 0;  ///< made; less than asked for only when the status is not ok
  StepStatus status = StepStatus::ok;
};

/// Bodies in motion. What is constant is computed and allocated by the constructor; what is noexcept
/// neither allocates, locks nor calls the system, so it may run in an audio callback. One thread at a time
/// each; different simulations share nothing that changes. One that was moved from can only be assigned to.
class Simulation {
 public:
  class State;

  /// Throws InputError, one line, on what can't be placed, paired or stepped.
  explicit Simulation(const Scene& scene);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// Unless the status is ok, nothing has changed.
  StepStatus step() noexcept;

  /// `steps` steps, as step() makes them to the last bit, and faster unless displacements are asked for. Rows
  /// after one that fails are 0.
  BlockResult step_block(std::int64_t steps, const Block& out = {}) noexcept;

  std::int64_t steps() const noexcept;  ///< since t = 0
  double time() const noexcept;         ///< [s]

  std::span<const ContactPoint> points() const noexcept;  ///< (m)
  std::span<const double> force() const noexcept;         ///< (m) λ_i ≥ 0 [N] over the last step
  std::span<const double> displacement() const noexcept;  ///< (m) u_i [m]: the gap is now g_i − u_i
  int active() const noexcept;                            ///< points that push in the last step

  std::size_t pickups() const noexcept;  ///< p
  /// Of the modes, at the end of the last step: without the static response of modes left out.
  double pickup_velocity(std::size_t pickup) const noexcept;      ///< [m/s]
  double pickup_displacement(std::size_t pickup) const noexcept;  ///< since t = 0 [m]

  Vector3 mean_velocity(std::size_t body) const noexcept;  ///< mass-mean, by index into Scene::bodies [m/s]
  Energy energy() const noexcept;
  int quasi_static_modes() const noexcept;  ///< above half the rate: they respond statically

  /// All that stepping changes. Allocates.
  State save() const;

  /// Goes on from there, to the last bit. False, and nothing done, with a state of another simulation.
  bool restore(const State& state) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A moment of one simulation.
class Simulation::State {
 public:
  ~State();
  State(State&&) noexcept;
  State& operator=(State&&) noexcept;

 private:
  friend class Simulation;
  struct Impl;
  explicit State(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace ricochet
