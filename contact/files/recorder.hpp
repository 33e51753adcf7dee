// SPDX-License-Identifier: BSD-2-Clause
// Streams a run into a result file (docs/formats/result.md). The file gets its final name only when it is
// complete.
//
//   Recorder recorder(model, step_options, {.path = "out/two-disks.result.h5", …});
//   while (…) { stepper.step(); recorder.record(stepper); }
//   recorder.commit();
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "contact/figures/contact_sides.hpp"
#include "contact/figures/motion_source.hpp"
#include "contact/figures/receivers.hpp"
#include "contact/figures/stress_envelope.hpp"
#include "contact/files/energy_rows.hpp"
#include "contact/files/entry_rows.hpp"
#include "contact/files/gauge_rows.hpp"
#include "contact/files/obstacle_rows.hpp"
#include "contact/files/pose_rows.hpp"
#include "contact/files/receiver_rows.hpp"
#include "contact/files/snapshot_rows.hpp"
#include "contact/model/model.hpp"
#include "contact/static/equilibrium.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

struct RecorderOptions {
  std::filesystem::path path;
  std::string title{}, scene{};             ///< scene: resolved TOML
  std::string created_by{};                 ///< program and version
  std::vector<std::string> kernel_files{};  ///< by body of the model
  std::int64_t every = 1;           ///< writes a row every n-th output sample, and in contact every n-th step
  std::int64_t snapshot_every = 0;  ///< writes modal coordinates every n-th output sample; 0 for never
  int receivers_every = 1;          ///< output samples between rows of receivers and gauges
};

/// Lower bound on the size of a result [bytes]; rows that are written during contact are not counted.
double least_bytes(const MotionSource& source, const RecorderOptions& options, std::int64_t samples);

class Recorder {
 public:
  /// Creates the file and writes the row of t = 0. With sampled responses, the datasets of energies, of the
  /// motion of the two sides and of modal coordinates are absent. Throws InputError if the file cannot be
  /// created.
  Recorder(const MotionSource& source, const StepOptions& step, const RecorderOptions& options);

  /// Creates the file for bodies at rest, without rows. Throws as above.
  Recorder(const Model& model, const RecorderOptions& options);

  /// Call it after each step of `stepper`; it applies `every`. Throws InputError if the disk is full.
  void record(const Stepper& stepper);
  /// Writes a row. Throws as above.
  void record(const Equilibrium& equilibrium);
  /// Writes the envelopes by body, once. Throws as above.
  void record(const std::map<std::string, StressEnvelope>& envelopes);

  /// Motion of the receivers after the last step. Must not be called with sampled responses.
  const Receivers& receivers() const { return *receivers_; }

  /// Writes buffered rows and gives the file its final name. No member may be called afterwards.
  /// @param run      identifier of the run, which its other files contain as well
  /// @param summary  summary of an earlier run; it is removed first, because a summary marks a complete run
  void commit(const std::string& run = {}, const std::filesystem::path& summary = {});

 private:
  using Rows = base::hdf5::Rows;
  struct BodyRows {
    Rows *velocity, *momentum, *angular_momentum = nullptr, *reaction = nullptr;
    std::optional<PoseRows> pose{};  ///< with finite rotations, as `spin`
    Rows* spin = nullptr;
    Eigen::Vector3d last_momentum = Eigen::Vector3d::Zero();    ///< at the last row
    Eigen::Vector3d contact_impulse = Eigen::Vector3d::Zero();  ///< on this body, since the last row [N s]
  };
  struct ContactRows {
    Rows *time = nullptr, *force = nullptr, *gap = nullptr;
    Rows *displacement_a = nullptr, *displacement_b = nullptr, *velocity_a = nullptr, *velocity_b = nullptr;
    // with friction
    Rows *tangential_force = nullptr, *tangential_displacement = nullptr, *state = nullptr;
  };

  void write_points(const Model& model);
  void write_place(const Bodies::Block& body, std::size_t number, const RecorderOptions& options);
  void add_model_rows(const Model& model, const StepOptions& step, const RecorderOptions& options);
  void push(const RowFrames& frames, const Vector& force, double duration);
  void bodies_row(const Vector& state, std::span<const Pose> poses, double from, double to);
  void contact_row(double time, const Vector& u, const Vector& force);
  void sides_row(const SidesMotion& sides);
  void friction_row(const Vector& w, const Vector& force, std::span<const ContactState> states);

  MotionSource source_;
  double step_;
  bool turns_;  ///< whether rotations are finite
  std::int64_t every_, snapshot_every_, last_row_ = 0;
  base::hdf5::Writer file_;
  std::optional<ContactSides> sides_;
  std::optional<Receivers> receivers_;
  Rows* time_;
  Rows* persistency_ = nullptr;
  std::optional<EntryRows> entries_;  ///< of bodies that turn
  ContactRows contact_{};             ///< of others
  std::optional<EnergyRows> energy_;
  std::vector<BodyRows> bodies_;
  std::optional<ObstacleRows> obstacle_rows_;
  std::optional<ReceiverRows> receiver_rows_;
  std::optional<GaugeRows> gauge_rows_;
  std::optional<SnapshotRows> snapshots_;
};

}  // namespace ricochet::contact
