// SPDX-License-Identifier: BSD-2-Clause
// Snapshots of all bodies in a result file, from which a kernel gives the motion of any of its points
// (docs/formats/result.md):
//
//   u = Φ q + R_C f + (static response to gravity, loads and supports)
//
// q are the coordinates Φᵀ M u of the kept modes, f the contact forces on the candidates of the body. R_C and
// the other static responses are in the kernel, for example under /view.
#pragma once

#include <cstdint>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "contact/model/model.hpp"

namespace ricochet::contact {

class SnapshotRows {
 public:
  /// Creates the datasets. `file` and `model` must outlive this object.
  SnapshotRows(base::hdf5::Writer& file, const Model& model);

  /// @param q, p  (N), (n) modal coordinates and forces at `time` [s]; p = 0 under impulses
  void append(double time, const Vector& q, const Vector& p);

 private:
  using Rows = base::hdf5::Rows;
  /// Rows of a body; null if there is nothing of the kind.
  struct Body {
    Rows* modal = nullptr;
    Rows *snapshot = nullptr, *candidate = nullptr, *force = nullptr;
    Rows *load = nullptr, *motion = nullptr;
  };
  void append_forces(std::size_t body, const Body& rows, const Vector& p);

  const Model& model_;
  Rows& time_;
  std::int64_t count_ = 0;  ///< snapshots so far
  std::vector<Body> bodies_;
};

}  // namespace ricochet::contact
