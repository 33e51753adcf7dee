// SPDX-License-Identifier: BSD-2-Clause
// The datasets /gauges of a result file: stress and strain of the gauges, at all output samples or at fewer.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "contact/figures/gauges.hpp"
#include "contact/files/decimator.hpp"

namespace ricochet::contact {

class GaugeRows {
 public:
  /// Creates the datasets, and the row of t = 0 unless bodies are at rest.
  /// @param every  output samples between rows; above 1, a low-pass filter precedes (decimator.hpp)
  GaugeRows(base::hdf5::Writer& file, const Model& model, const StepOptions& step, int every);

  /// Call it after each output sample. Throws InputError if the disk is full.
  void record(const Stepper& stepper);
  /// Writes a row of bodies at rest. Throws as above.
  void record(double time, const Vector& q, const Vector& p);
  /// Writes the rows that the filter still holds.
  void finish();

 private:
  using Rows = base::hdf5::Rows;
  struct Datasets {
    Rows *stress = nullptr, *strain = nullptr;
  };
  void push();
  void append(double time, std::span<const double> values);

  double sample_;  ///< time of an output sample [s]
  Gauges gauges_;
  Decimator decimator_;
  Rows* time_;
  std::vector<Datasets> datasets_;  ///< by gauge
};

}  // namespace ricochet::contact
