// SPDX-License-Identifier: BSD-2-Clause
// The datasets /energy of a result file: the energy ledger, one row at each output sample that is written.
#pragma once

#include <vector>

#include "base/hdf5_writer.hpp"
#include "ricochet/energy.hpp"

namespace ricochet::contact {

class EnergyRows {
 public:
  /// Creates the datasets.
  explicit EnergyRows(base::hdf5::Writer& file);

  /// Throws InputError if the disk is full.
  void append(const Energy& energy);

 private:
  std::vector<base::hdf5::Rows*> rows_;  ///< total, then the terms
};

}  // namespace ricochet::contact
