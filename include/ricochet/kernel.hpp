// SPDX-License-Identifier: BSD-2-Clause
// The compact kernel of one body: what contact can see of it. No MPI, no PETSc, no Eigen.
//
// Every array is row-major and its shape is written beside it:
//   N modes, M candidate points, c components (3, or 1 where the scene fixes a contact direction),
//   T surface elements of k corners, V nodes and E elements of the skin.
// SI units. Geometry is in the body's own frame: the mesh after `scale`, before rotation and translation.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ricochet/units.hpp"

namespace ricochet::kernels {

/// Proof that no mode is missing: inertia of full-rank factorisations against the modes found. Of a basis
/// fitted to contact: the error estimate that it met.
struct Certificate {
  std::int64_t below = 0;             ///< modes below the interval (0: the interval starts below all)
  double upto_hz = 0;                 ///< upper end of the proved interval [Hz]
  std::int64_t count_by_inertia = 0;  ///< modes in it by Sylvester's law; basis "contact": vectors
  std::int64_t count_found = 0;       ///< modes found
  std::int64_t left_out = 0;  ///< of those: not in this kernel, as contact hardly feels them in the band
  /// Counts agree, residuals, M-orthonormality and flexibility within bounds; basis "imported": false.
  bool complete = false;
  double orthonormality = 0;  ///< max |ΦᵀMΦ − I|
  /// Error of the contact surface's flexibility over the band of the scene, as estimated, where one was asked
  /// for; otherwise 0.
  double flexibility_error = 0;
  std::int64_t approximate = 0;  ///< block iterations that took the place of the certified search; 0: none
  bool operator==(const Certificate&) const = default;
};

struct Modes {
  std::string basis = "modes";  ///< or "contact", fitted to it, or "imported", of which nothing is proved
  std::vector<double> angular_frequency;  ///< (N) ω_n [rad/s], ascending; rigid modes first, exactly 0
  std::vector<double> decay_rate;         ///< (N) δ_n = ζ_n ω_n [1/s]
  std::vector<double> residual;  ///< (N) ‖Kφ − ω²Mφ‖₂ / ‖Kφ‖₂ (rigid: over ‖diag K‖∞ ‖φ‖₂)
  Certificate certificate;
  std::size_t size() const { return angular_frequency.size(); }
  /// What a reader should know of them: "modes" (certified), "approximate modes", "contact" or
  /// "imported".
  std::string kind() const { return certificate.approximate > 0 ? "approximate " + basis : basis; }
  /// Vectors of a basis that only serves whole, not modes of the body.
  bool fitted() const { return basis == "contact"; }
  bool imported() const { return basis == "imported"; }
  bool operator==(const Modes&) const = default;
};

/// All candidates of a surface some of which were left out of a kernel: pairs are found among these.
/// W of them, T elements of k corners.
struct WholeSurface {
  std::vector<double> node, centroid, normal;  ///< (W,3) as in Surface
  std::vector<double> area;                    ///< (W) [m²]
  int element_corners = 3;                     ///< k
  std::vector<std::int64_t> element;           ///< (T,k)
  std::vector<std::int64_t> held;              ///< (M) the candidates that the kernel holds, ascending
  bool operator==(const WholeSurface&) const = default;
};

/// Candidate contact patches (hats w_i ≥ 0 with Σ w_i = 1, A_i = ∫ w_i ds).
struct Surface {
  int components = 3;                 ///< c
  std::optional<Vector3> direction;   ///< unit vector of the stored component when c = 1
  std::vector<double> node;           ///< (M,3) where each hat stands [m]
  std::vector<double> centroid;       ///< (M,3) (1/A_i) ∫ w_i x ds [m]; empty: as node
  std::vector<std::string> group;     ///< (M) physical surface each belongs to
  std::vector<double> normal;         ///< (M,3) outward unit normal
  std::vector<double> area;           ///< (M) A_i [m²]
  int element_corners = 3;            ///< k: 1 point (rods), 2 segments (`along`), 3 triangles
  std::vector<std::int64_t> element;  ///< (T,k) by candidate index
  std::vector<double> shape;          ///< (M,c,N) φ_i = (1/A_i) ∫ w_i φ ds [kg^-1/2]
  std::vector<double>
      residual_flexibility;           ///< (cM,cM) R [m/N], index c·i + component; empty when not asked for
  std::optional<WholeSurface> whole;  ///< where candidates out of reach were left out; none: these are all
  std::size_t size() const { return area.size(); }
  bool operator==(const Surface&) const = default;
};

/// All candidates: those of `whole`, or, where none were left out, of the surface itself.
WholeSurface whole_surface(const Surface& surface);

struct Loads {
  std::vector<double> body_force;  ///< (3,N) φᵀ M e_i [kg^1/2]: uniform acceleration fields, momentum
  std::vector<double>
      rotation;  ///< (3,N) φᵀ M (e_i × x) [kg^1/2 m]: angular momentum about the frame's origin
  std::vector<double>
      body_force_residual;  ///< (cM,3) static part of the modes left out [s²]: m per m/s²; empty without R
  bool operator==(const Loads&) const = default;
};

/// A traction on a surface or a force at a point whose history the scene gives: one column for a unit of each
/// component along the body's axes.
struct Load {
  std::string name;
  std::string unit;                   ///< of what the history scales: "Pa" of a traction, "N" of a force
  std::vector<double> participation;  ///< (3,N) ∫ φ_n ds of the surface [kg^-1/2 m²]; φ_n(x) [kg^-1/2]
  std::vector<double> total;          ///< (3,3) resultant force [N per unit], row: its component
  std::vector<double> moment;         ///< (3,3) resultant moment about the frame's origin [N m per unit]
  std::vector<double> residual;  ///< (cM,3) static part of the modes left out [m per unit]; empty without R
  bool operator==(const Load&) const = default;
};

/// A support that moves by ū, the same vector at all its nodes; other supports stay. With the static lift Ψ
/// (K Ψ = 0 off the supports) u = (Ψ − ΦΓ) ū + Φ p, p̈ + 2δ (ṗ − Γ ū̇) + ω² p = ω² Γ ū. One column for each
/// component of ū along the body's axes; those that the support does not hold are 0.
struct Motion {
  std::string name;                   ///< the support's group
  std::vector<double> participation;  ///< (3,N) Γ = Φᵀ M Ψ [kg^1/2]
  std::vector<double> residual;       ///< (cM,3) Ψ − ΦΓ on the candidates [1]
  std::vector<double> momentum;       ///< (3,3) e_iᵀ M (Ψ − ΦΓ) e_k [kg]
  bool operator==(const Motion&) const = default;
};

/// A point whose motion is recorded.
struct Receiver {
  std::string name;
  Vector3 point{};            ///< [m]
  std::vector<double> shape;  ///< (3,N) φ_n(x) [kg^-1/2]
  std::vector<double>
      residual_flexibility;  ///< (3,cM) by unit forces on the candidates [m/N]; empty without R
  std::vector<double> body_force_residual;  ///< (3,3) [s²]; empty without R
  std::vector<double> load_residual;  ///< (3,3L) of the L loads in their order [m per unit]; empty without R
  std::vector<double> motion_residual;  ///< (3,3S) Ψ − ΦΓ of the S motions in their order [1]
  bool operator==(const Receiver&) const = default;
};

/// The skin of the body, for pictures: in single precision.
struct View {
  std::vector<double> node;           ///< (V,3) [m]
  int element_corners = 3;            ///< 3 triangles, 2 segments (rods)
  std::vector<std::int64_t> element;  ///< (E,k)
  std::vector<float> shape;           ///< (V,3,N) [kg^-1/2]
  // As of receivers, what the modes left out do statically; empty without R.
  std::vector<float> residual_flexibility;  ///< (V,3,cM) by unit forces on the candidates [m/N]
  std::vector<float> body_force_residual;   ///< (V,3,3) [s²]
  std::vector<float> load_residual;         ///< (V,3,3L) [m per unit]
  std::vector<float> motion_residual;       ///< (V,3,3S) Ψ − ΦΓ [1]; always
  bool operator==(const View&) const = default;
};

struct Kernel {
  std::string body;         ///< the scene's name for it
  std::string hash;         ///< SHA-256 (hex) of all that the kernel depends on
  std::string scene;        ///< resolved TOML of what it depends on
  std::string mesh_sha256;  ///< of the mesh file (and the files it includes)
  std::string created_by;   ///< program and version
  std::int64_t dofs = 0;
  std::int64_t elements = 0;
  int order = 0;
  double mass = 0;                  ///< [kg]
  Vector3 centre{};                 ///< centre of mass [m]
  std::array<double, 9> inertia{};  ///< (3,3) about the centre of mass [kg m²]
  bool supported = false;           ///< some displacement is held by a support

  Modes modes;
  Surface surface;
  Loads loads;
  std::vector<Load> applied;    ///< tractions and point forces
  std::vector<Motion> motions;  ///< supports that move
  std::vector<Receiver> receivers;
  std::optional<View> view;
  bool operator==(const Kernel&) const = default;
};

/// Whether a load, a motion or a receiver may have this name, which becomes that of a dataset: not empty, at
/// most 100 bytes, no "/" and no control characters, not "." or a name that the file's loads have already.
bool is_free_name(const std::string& name);

/// Throws InputError naming `origin` when shapes disagree, a value is not finite, areas or frequencies are
/// negative, an index leaves its range or normals are not unit vectors. Loaders call it, so that nothing past
/// them needs to.
void validate(const Kernel& kernel, const std::string& origin);

}  // namespace ricochet::kernels
