// SPDX-License-Identifier: BSD-2-Clause
// The contact of bodies that turn in a result file (docs/formats/result.md): in each row an entry for each
// point that carries a force, with where it is, because few of very many points do, and all of them move.
#pragma once

#include <cstdint>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "contact/model/model.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

class EntryRows {
 public:
  /// Creates the datasets, and writes the names of the sides of each pair. `file` and `model` must outlive
  /// this object.
  EntryRows(base::hdf5::Writer& file, const Model& model);

  /// Writes the row of the last step of a stepper of bodies that turn. Throws InputError if the disk is full.
  void append(const Stepper& stepper);

 private:
  using Rows = base::hdf5::Rows;
  void append_friction(const Stepper& stepper, const Vector& u, Eigen::Index point);

  const Model& model_;
  Rows &time_, &first_, &point_, &force_, &gap_, &place_, &normal_;
  Rows *tangential_force_ = nullptr, *tangential_displacement_ = nullptr,
       *state_ = nullptr;         ///< with friction
  std::vector<int> friction_of_;  ///< (m) place among the points with friction, or −1
  std::int64_t count_ = 0;        ///< entries so far
};

}  // namespace ricochet::contact
