// SPDX-License-Identifier: BSD-2-Clause
// The datasets /receivers of a result file: the motion of the receivers, at all output samples or at fewer.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "contact/figures/receivers.hpp"
#include "contact/files/decimator.hpp"

namespace ricochet::contact {

class ReceiverRows {
 public:
  struct Kept {
    bool displacement = true, velocity = true, acceleration = true;
  };

  /// Creates the datasets.
  /// @param every  output samples between rows; above 1, a low-pass filter precedes (decimator.hpp)
  ReceiverRows(base::hdf5::Writer& file, const Model& model, const StepOptions& step, int every);
  /// @param kept  which datasets
  ReceiverRows(base::hdf5::Writer& file, const Model& model, const StepOptions& step, int every, Kept kept);

  /// Call it with the motion at t = 0 and then after each output sample. Throws InputError if the disk
  /// is full.
  void record(const Receivers& motion);
  /// Writes the rows that the filter still holds.
  void finish();

 private:
  using Rows = base::hdf5::Rows;
  struct Datasets {
    Rows *displacement = nullptr, *velocity = nullptr, *acceleration = nullptr;
  };
  void append(std::int64_t sample, std::span<const double> values);

  StepOptions step_;
  int every_;
  Rows* time_;
  std::vector<Datasets> datasets_;      ///< by receiver
  std::optional<Decimator> decimator_;  ///< once the motion at t = 0 is known
  std::vector<double> row_;             ///< (9 receivers) displacement, velocity and acceleration of each
};

}  // namespace ricochet::contact
