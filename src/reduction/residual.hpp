// SPDX-License-Identifier: BSD-2-Clause
// Static correction: the quasi-static response of the modes that a mode set does not contain.
#pragma once

#include <memory>
#include <span>

#include "src/modes/modes.hpp"
#include "src/reduction/rows.hpp"
#include "src/reduction/static_flexibility.hpp"

namespace ricochet::reduction {

/// Returns Fᵀ K⁺ F − Σ (Fᵀφ)(φᵀF)/ω² of all modes φ in the set: the quasi-static response of the modes
/// outside the set at the loads themselves. K⁺ is the static flexibility without rigid motion and without the
/// rigid part of loads. Nothing is approximated: there is no shift, and no series.
///
/// Modes far below the cut dominate Fᵀ K⁺ F, so subtracting them would leave their round-off. They are
/// projected out of the loads and responses instead, with the same factorisation as that of the response, so
/// that its errors cancel.
///
/// @param loads  F (local rows, b), the same in every team
/// @param field  if given, receives the values of the responses on the mesh (rows, b)
/// @return (b, b) symmetric [m/N for unit loads], the same on every rank. Collective on all ranks of `teams`.
/// Source: MacNeal 1971, Rubin 1975.
Eigen::MatrixXd residual_response(const parallel::Teams& teams, const mesh::Mesh& mesh,
                                  const elasticity::Body& body, modes::Factorisation& factor,
                                  const modes::ModeSet& modes, const Loads& loads, Rows* field = nullptr);

/// The same response column by column, for loads whose matrix would be too large: by solves with K on
/// springs.
class ResidualColumns {
 public:
  /// Factors K. Loads and everything else must outlive it. Collective on all ranks of `teams`.
  ResidualColumns(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                  modes::Factorisation& factor, const modes::ModeSet& modes, const Loads& loads);
  ~ResidualColumns();

  /// @return (b, number of `columns`) the responses at all loads to those of `columns`, the same on every
  /// rank. Collective.
  Eigen::MatrixXd at(std::span<const Eigen::Index> columns);

  /// Sets the values of the responses on the mesh (rows, b). Collective.
  void respond(Rows& field);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace ricochet::reduction
