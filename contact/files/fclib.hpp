// SPDX-License-Identifier: BSD-2-Clause
// Writes the contact problems of a run as files of FCLIB, a collection of contact problems in HDF5 that other
// nonsmooth solvers read (Acary et al. 2014; github.com/FrictionalContactLibrary/fclib, fclib.h).
//
//   FCLIB, local problem:  u = W r + q,  K* ∋ u + μ |u_T| n ⟂ r ∈ K,  a friction cone for each contact
//   here:                  w = S p − (û − g)    in normal rows: the gap
//                          w = S p − (û − u⁻ − belt)    in tangential rows: minus the slip of the step
//
// A contact has three rows in FCLIB, the normal one first, so W is S in another order, r = p and u = w. At a
// contact without friction, μ = 0, and the other two rows are not coupled to any row. Their diagonal entry is
// the mean normal diagonal of S, so that W is as definite as S, and their solution is 0. Springs of points
// (patch_spring.hpp) are linearised at the solution, so that it also solves the problem in the file.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

struct ProblemOptions {
  std::filesystem::path folder;  ///< created if missing
  std::string name;              ///< files are <name>-i<step>-<points>.hdf5
  std::string title;
  int every = 1;  ///< writes every n-th step with contact, beginning with the first
};

/// Observes a run of the compliant scheme from t = 0 on. Call `observe` after each step.
class ProblemFiles {
 public:
  /// `model` must outlive this object. Throws InputError if the folder cannot be created, or if friction does
  /// not follow Coulomb's law, the only one that FCLIB knows.
  ProblemFiles(const Model& model, const StepOptions& step, ProblemOptions options);

  /// Writes the problem of the step and its solution if the step has a force and max_pivots did not cut the
  /// solve short. Throws InputError if the file cannot be written.
  void observe(const Stepper& stepper);

  int written() const { return static_cast<int>(written_.size()); }
  /// Removes the files, because the run is repeated.
  void remove();

 private:
  /// A contact problem and its solution, in the rows of the model.
  struct Problem {
    Eigen::MatrixXd S;
    Vector u, q, p;  ///< (n) [m], [m], [N]
    Vector mu;       ///< (m)
  };
  Problem problem_of(const Stepper& stepper) const;
  void write(const Stepper& stepper);

  const Model& model_;
  ProblemOptions options_;
  std::shared_ptr<const StepSystem> system_;
  RowMatrices matrices_;
  // with friction: before the step
  Slip slip_;
  Vector displacement_, force_;  ///< (n) u, p
  int seen_ = 0;
  std::vector<std::filesystem::path> written_;
};

}  // namespace ricochet::contact
