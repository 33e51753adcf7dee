// Certified modes of K φ = ω² M φ, rigid ones exact.
#pragma once

#include <optional>

#include "kernels/kernel.hpp"
#include "src/elasticity/assemble.hpp"
#include "src/modes/factorisation.hpp"

namespace ricochet::modes {

struct Request {
  std::optional<Hertz> up_to{};  ///< all modes up to here, or
  /// the lowest ones, rigid included; extended to the end of a multiple mode
  std::optional<std::int64_t> count{};
  double relative_residual = 1e-8;
};

struct ModeSet {
  std::vector<double> angular_frequency;  ///< (N) [rad/s], ascending; rigid modes first, exactly 0
  std::vector<double> residual;  ///< (N) ‖Kφ − ω²Mφ‖₂ / ‖Kφ‖₂; rigid: ‖Kφ‖₂ / (max |diag K| ‖φ‖₂)
  Eigen::MatrixXd shape;  ///< (local rows, N), M-orthonormal; the largest entry of each is positive
  kernels::Certificate certificate;
  double cut = 0;  ///< λ between the last mode kept and the next [rad²/s²]: the proved end
};

/// Collective. Throws InputError when the body has fewer modes than asked for; SolverError when a mode is
/// missing, a residual exceeds its bound, or M-orthonormality is worse than 1e-8: nothing uncertified is
/// returned. Source: counts by inertia as in Grimes, Lewis & Simon 1994.
ModeSet compute_modes(const mesh::Mesh& mesh, const elasticity::Body& body, const Request& request,
                      const parallel::Progress& progress = {});

/// Quasi-static response of the modes left out to a set of loads: Cᵀ Pᵀ (K − σM)⁻¹ P L corrected to σ = 0,
/// where C, the places at which it is seen, are the first `seen` columns of L.
///
/// @param loads  L (local rows, b) [N], held components 0
/// @return (seen, b) [m/N for unit loads], the same on every rank. Collective.
/// Source: MacNeal 1971, Rubin 1975; by the shifted series Σ (−σ)^k … until 1e-12 relative.
Eigen::MatrixXd residual_response(const mesh::Mesh& mesh, const elasticity::Body& body, const ModeSet& modes,
                                  const Eigen::MatrixXd& loads, Eigen::Index seen);

}  // namespace ricochet::modes
