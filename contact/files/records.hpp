// SPDX-License-Identifier: BSD-2-Clause
// The records that a study keeps of an impact, without its result file: the datasets of
// docs/formats/result.md that are requested, and the total contact force.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "contact/figures/motion_source.hpp"
#include "contact/figures/receivers.hpp"
#include "contact/files/energy_rows.hpp"
#include "contact/files/gauge_rows.hpp"
#include "contact/files/receiver_rows.hpp"
#include "contact/static/equilibrium.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

struct RecordOptions {
  bool force = false;         ///< /contact/time, total_force
  bool receivers = false;     ///< /receivers/time, NAME/velocity
  bool acceleration = false;  ///< /receivers/time, NAME/acceleration
  bool gauges = false;        ///< /gauges/time, NAME/stress, strain
  bool bodies = false;        ///< /time, /bodies/NAME/velocity
  bool energy = false;        ///< /time, /energy; absent with sampled responses
  std::int64_t every = 1;     ///< as in RecorderOptions
  int receivers_every = 1;
};

class Records {
 public:
  /// Writes the rows of t = 0. Energies, receivers and gauges are absent with sampled responses. Throws
  /// InputError, like all members, if the folder of temporary files cannot be written.
  Records(const MotionSource& source, const StepOptions& step, const RecordOptions& options);
  /// Records of bodies at rest, without rows and velocities.
  Records(const Model& model, const RecordOptions& options);

  /// Call it after each step of `stepper`.
  void record(const Stepper& stepper);
  void record(const Equilibrium& equilibrium);

  /// The content of an HDF5 file. No member may be called afterwards.
  std::string file();

 private:
  using Rows = base::hdf5::Rows;
  void force_row(const Stepper& stepper);
  void add_force(double time, double force);
  void bodies_row(const Vector& state, double time);

  MotionSource source_;
  double step_;
  std::int64_t every_;
  base::hdf5::Writer file_;
  Rows* time_ = nullptr;  ///< of bodies and energies
  Rows *force_time_ = nullptr, *force_ = nullptr;
  std::int64_t force_end_ = -1;  ///< step of the last row of the force
  bool pressed_ = false;         ///< whether this row has a force
  std::vector<Rows*> velocity_;  ///< by body
  std::optional<EnergyRows> energy_;
  std::optional<Receivers> receivers_;
  std::optional<ReceiverRows> receiver_rows_;
  std::optional<GaugeRows> gauge_rows_;
};

}  // namespace ricochet::contact
