// SPDX-License-Identifier: BSD-2-Clause
// What a simulation of the embedding interface consists of: a stepper, the forces of its last sample,
// pickups, and the numbers and names of its bodies.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/digest.hpp"
#include "contact/api/sample_forces.hpp"
#include "contact/api/scene_model.hpp"
#include "contact/figures/rigid_motion.hpp"
#include "contact/figures/summary_observer.hpp"
#include "ricochet/ricochet.hpp"

namespace ricochet {

inline Vector3 array(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

struct Simulation::Impl {
  /// A body that is there.
  struct Entry {
    std::size_t number;
    std::string name;
    int body;  ///< of the model
  };

  explicit Impl(const Scene& scene);

  /// @param by  null: a stepper from t = 0  @param pairs  numbers in the scene, by pair of the model
  Impl(const Scene& of, std::shared_ptr<const contact::Model> of_bodies, std::unique_ptr<contact::Stepper> by,
       std::vector<std::size_t> pairs);

  int per_sample() const noexcept { return stepper->options().steps_per_sample; }
  std::int64_t samples() const noexcept { return stepper->steps() / per_sample(); }

  /// After a contact step that succeeded. @return false if the callback ends a block at this sample
  bool made_step();

  std::span<const Touching> find_touching() noexcept;
  void add_touching(Eigen::Index i) noexcept;
  std::string_view name_of(int body) const noexcept;

  /// The body of the model with this number, or −1.
  int body_of(std::size_t number) const noexcept;

  /// Writes row k from the last sample.
  void write_forces(const Block& out, std::int64_t k) const noexcept;

  /// The part of the motion of a pickup that moving supports give to the modes. Blocks of steps in which one
  /// moves are advanced step by step.
  double velocity_of_supports(Eigen::Index pickup) const noexcept;
  double displacement_of_supports(Eigen::Index pickup) const noexcept;

  /// Elastic displacement, or its rate, of a pickup on a body that turns, in the axes of the body.
  /// @param driven  the factor of supports, or its rate
  Eigen::Vector3d elastic(const TurningPickup& pickup, const contact::Vector& modal,
                          double (contact::History::*driven)(double) const noexcept) const noexcept;
  /// Its arm from the centre and its rate, body axes.
  Eigen::Vector3d arm(const TurningPickup& pickup) const noexcept;
  /// Its place along its direction [m], and the rate [m/s].
  double place_of(const TurningPickup& pickup) const noexcept;
  double rate_of(const TurningPickup& pickup) const noexcept;
  /// @param v  (N) modal rates, those of the present with finite rotations
  double velocity(std::size_t pickup, const double* v) const noexcept;

  /// Writes the rows of velocities of the samples between contact steps `from` and `to` of the block: the
  /// steps through which the state was last advanced.
  void write_velocities(const Block& out, std::int64_t from, std::int64_t to) const noexcept;
  void clear(const Block& out, std::int64_t from, std::int64_t to) const noexcept;

  // Bodies are added and removed.
  void refuse_linear(const char* what) const;
  std::vector<int> present(int but = -1) const;
  contact::PlacedBody placed(int body) const;
  int find_place(const SharedKernel& kernel, const std::optional<Friction>& friction) const;
  void take_place(int body, const contact::PlacedBody& added, const std::optional<Friction>& friction);
  std::unique_ptr<Impl> changed(const std::vector<int>& kept, const contact::Placement* added) const;
  void silence(int body) noexcept;

  /// Of a kernel that may belong to a body.
  base::Digest::Value digest_of_kernel(const SharedKernel& kernel) const;

  /// Of the scene, and of the bodies that were added and removed since.
  base::Digest::Value system{};
  Scene scene;                              ///< without bodies, pairs and loads
  std::vector<Entry> entries{};             ///< of bodies that are there, by ascending number
  std::vector<std::size_t> body_numbers{};  ///< theirs
  std::size_t next_number = 0;
  std::vector<SharedKernel> kernels{};  ///< by body of the model, which contains pointers to them
  std::vector<base::Digest::Value> kernel_digests{};  ///< likewise
  std::shared_ptr<const contact::Model> shared;
  const contact::Model& model = *shared;
  std::unique_ptr<contact::Stepper> stepper;
  contact::FloatingStepper* floating;    ///< the stepper, with finite rotations; otherwise null
  SampleForces forces;                   ///< of the last sample
  contact::Matrix pickups{};             ///< (p,N)
  std::vector<TurningPickup> turning{};  ///< (p) with finite rotations
  std::vector<double> pickups_at_start{};
  contact::RigidMotions rigid;
  std::vector<std::size_t> pair_number;  ///< of each pair of the model, in the scene
  std::vector<ContactPoint> points;
  std::vector<Touching> touching{};
  OnContact on_contact = nullptr;
  void* user = nullptr;
  bool touched = false;  ///< whether points touched when on_contact was last called

  /// Since Simulation::watch.
  struct Watch {
    std::vector<MaterialLimits> limits;  ///< by body of the model
    double slowest_wave;
    /// With the present names of the bodies. The observer refers to it.
    std::shared_ptr<const contact::Model> named;
    contact::SummaryObserver observer;
    std::vector<std::string> earlier{};  ///< warnings with other bodies
  };
  void begin_watch(std::vector<MaterialLimits> limits, double slowest_wave);
  std::optional<Watch> watch{};
  std::vector<std::string> warnings() const;
};

}  // namespace ricochet
