// SPDX-License-Identifier: BSD-2-Clause
// The kernel of one body: all data of the body that contact needs. Requires neither MPI, PETSc nor Eigen.
//
// Every array is row-major, with its shape beside it:
//   N modes, M candidate points, c components (3, or 1 if the scene fixes a contact direction),
//   r components of the static correction (c, or 1 if it is stored along the normals of the candidates),
//   T surface elements of k corners, V nodes and E elements of the visualisation surface.
// SI units. Geometry is in the body's own frame: the mesh after `scale`, before rotation and translation.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ricochet/units.hpp"

namespace ricochet::kernels {

/// Evidence that no mode is missing: the Sturm-sequence (inertia) count of full-rank factorisations, compared
/// with the number of modes found. For a contact-adapted basis: its estimated error.
struct Certificate {
  std::int64_t below = 0;             ///< modes below the interval (0: it starts below all modes)
  double upto_hz = 0;                 ///< upper end of the proved interval [Hz]
  std::int64_t count_by_inertia = 0;  ///< modes in it, by Sylvester's law; basis "contact": number of vectors
  std::vector<double> shift;          ///< (S) shifts at which modes were counted [rad²/s²], ascending
  std::vector<double> modes_below;    ///< (S) modes below each shift, by Sylvester's law
  std::int64_t count_found = 0;       ///< modes found
  std::int64_t left_out = 0;  ///< modes found but truncated, because contact hardly excites them in the band
  /// The counts agree, and residuals, M-orthonormality and flexibility are within their bounds. False for the
  /// basis "imported".
  bool complete = false;
  double orthonormality = 0;  ///< max |ΦᵀMΦ − I|
  /// Estimated error of the flexibility of the contact surface over the band of the scene; 0 if no bound on
  /// it was requested.
  double flexibility_error = 0;
  bool operator==(const Certificate&) const = default;
};

/// Whether a rotation mixes two elastic modes: they differ by less than 2 % in frequency.
inline bool nearly_equal(double lower, double upper) { return lower > 0 && upper - lower < 0.02 * lower; }

/// The pairs of nearly equal modes of a free solid, for the Coriolis force if it turns. Empty if it has no
/// such pairs, and in files of earlier versions.
struct Coriolis {
  std::vector<std::int64_t> pair;  ///< (P,2) modes m < n, ascending
  std::vector<double> coupling;  ///< (P,3) ∫ρ φ_m × φ_n along the axes of the body [1], at most 1 in length
  bool operator==(const Coriolis&) const = default;
};

struct Modes {
  std::string basis = "modes";  ///< or "contact" (contact-adapted), or "imported" (nothing is proved)
  std::vector<double> angular_frequency;  ///< (N) ω_n [rad/s], ascending; rigid modes first, exactly 0
  std::vector<double> decay_rate;         ///< (N) δ_n = ζ_n ω_n [1/s]
  std::vector<double> residual;  ///< (N) ‖Kφ − ω²Mφ‖₂ / ‖Kφ‖₂ (rigid: over ‖diag K‖∞ ‖φ‖₂)
  /// (N,N) estimated error E by the mesh of the stiffness of these modes, symmetric [1]: on an infinitely
  /// fine mesh, they have the stiffness ω_m (1 − E)_mn ω_n, and ω_n² is smaller by E_nn ω_n². Rigid modes 0.
  /// Empty if not estimated, and in files of earlier versions.
  std::vector<double> stiffness_error;
  Certificate certificate;
  Coriolis coriolis;
  std::size_t size() const { return angular_frequency.size(); }
  /// Whether these are the load-dependent Ritz vectors of a contact-adapted basis. They are not modes of the
  /// body, and the basis is useful only as a whole.
  bool contact_adapted() const { return basis == "contact"; }
  bool imported() const { return basis == "imported"; }
  bool operator==(const Modes&) const = default;
};

/// All candidates of a surface, for a kernel that contains only some of them. Contact pairs are found among
/// all of them. There are W candidates and T elements of k corners.
struct WholeSurface {
  std::vector<double> node, centroid;  ///< (W,3) as in Surface
  std::vector<double> bulge;           ///< (W) as in Surface
  std::vector<double> normal;          ///< (W,3)
  std::vector<double> area;            ///< (W) [m²]
  int element_corners = 3;             ///< k
  std::vector<std::int64_t> element;   ///< (T,k)
  std::vector<double> element_normal;  ///< (T,k,3) as in Surface
  std::vector<std::int64_t> held;      ///< (M) the candidates that the kernel contains, ascending
  bool operator==(const WholeSurface&) const = default;
};

/// R of a body that turns, in single precision: whole, or, of many candidates, compressed,
///   R_ij = G_i G_jᵀ + E_ij,   E_ij = 0 unless i and j are near each other.
/// Both forms are symmetric and positive semidefinite as they stand (kernels/compression.hpp).
struct CompactFlexibility {
  std::vector<float> whole;   ///< (3M,3M) R [m/N]; empty if compressed
  std::int64_t columns = 0;   ///< k
  std::vector<float> global;  ///< (3M,k) G [m^1/2 N^-1/2]
  /// (M+1) The blocks E_ij with j ≥ i are those from near_first[i] to near_first[i + 1].
  std::vector<std::int64_t> near_first;
  std::vector<std::int64_t> near_candidate;  ///< (P) j, ascending for each i
  std::vector<float> near_block;             ///< (P,3,3) E_ij [m/N]
  /// Largest error of a displacement under a unit force at one of some candidates, as a share of the
  /// displacement of this candidate; 0 if R is whole.
  double error = 0;
  bool compressed() const { return whole.empty(); }
  bool operator==(const CompactFlexibility&) const = default;
};

/// Candidate contact patches (hats w_i ≥ 0 with Σ w_i = 1, A_i = ∫ w_i ds).
struct Surface {
  int components = 3;                ///< c
  std::optional<Vector3> direction;  ///< unit vector of the stored component when c = 1
  std::vector<double> node;          ///< (M,3) vertex of each hat [m]
  /// (M,3) x̂_i [m], from which gaps are measured: the centroid of the patch on its smooth surface; on a
  /// crease or at the end of the contact surface, the centroid of the hat's trace there; at a corner, the
  /// vertex. Empty: equal to node.
  std::vector<double> centroid;
  /// (M) b_i = (1/A_i) ∫ w_i n·(x̂_i − x) ds with the normal n of each smooth face at x̂_i [m]: the height of
  /// x̂_i over the mean of the patch, < 0 on hollow surfaces. Empty: `centroid` is the mean (1/A_i) ∫ w_i x
  /// ds, as in files of version 1.
  std::vector<double> bulge;
  std::vector<std::string> group;     ///< (M) physical surface to which each belongs
  std::vector<double> normal;         ///< (M,3) outward unit normal
  std::vector<double> area;           ///< (M) A_i [m²]
  int element_corners = 3;            ///< k: 1 point (rods), 2 segments (`along`), 3 triangles
  std::vector<std::int64_t> element;  ///< (T,k) by candidate index
  /// (T,k,3) outward unit normals of the surface at the corners of each element, from which its curvature and
  /// creases follow. Empty: elements are flat, and creases are not known.
  std::vector<double> element_normal;
  std::vector<double> shape;  ///< (M,c,N) φ_i = (1/A_i) ∫ w_i φ ds [kg^-1/2]
  std::vector<double>
      residual_flexibility;  ///< (rM,rM) R [m/N], index r·i + component; empty if not requested, or compact
  /// (M) estimated error d_i of the static flexibility of a candidate along its normal, by R and by the
  /// modes: on an infinitely fine mesh it is larger by this [m/N]. Empty if not estimated.
  std::vector<double> mesh_error;
  /// Share κ of neighbours in it: the flexibility between two candidates of one element is smaller by
  /// κ √(d_i d_j), because the error of a force falls as it spreads over more of them.
  double mesh_error_coupling = 0;
  std::optional<CompactFlexibility> compact;  ///< R of a body that turns; r = c = 3
  bool normal_residual = false;  ///< r = 1: R acts along the normal of each candidate alone; otherwise r = c
  std::optional<WholeSurface> whole;  ///< set only if candidates out of reach are missing
  std::size_t size() const { return area.size(); }
  bool has_flexibility() const { return compact || !residual_flexibility.empty(); }
  const std::vector<double>& places() const { return centroid.empty() ? node : centroid; }  ///< (M,3) x̂_i
  int residual_components() const { return normal_residual ? 1 : components; }              ///< r
  /// Corners of the elements of the whole surface; of the candidates alone, no element may be left.
  int corners() const { return whole ? whole->element_corners : element_corners; }
  bool operator==(const Surface&) const = default;
};

/// All candidates: those of `whole` if it is set, otherwise those of the surface itself.
WholeSurface whole_surface(const Surface& surface);

struct Loads {
  std::vector<double> body_force;  ///< (3,N) φᵀ M e_i [kg^1/2]: uniform acceleration fields, momentum
  std::vector<double>
      rotation;  ///< (3,N) φᵀ M (e_i × x) [kg^1/2 m]: angular momentum about the frame's origin
  std::vector<double> body_force_residual;  ///< (rM,3) static correction [s²]: m per m/s²; empty without R
  bool operator==(const Loads&) const = default;
};

/// A traction on a surface or a force at a point; the scene gives its history. Arrays have one row or column
/// for a unit load along each axis of the body.
struct Load {
  std::string name;
  std::string unit;  ///< of the vector that the history scales: "Pa" (traction) or "N" (force)
  std::vector<double> participation;  ///< (3,N) ∫ φ_n ds of the surface [kg^-1/2 m²]; φ_n(x) [kg^-1/2]
  std::vector<double> total;          ///< (3,3) resultant force [N per unit], row: its component
  std::vector<double> moment;         ///< (3,3) resultant moment about the frame's origin [N m per unit]
  std::vector<double> residual;       ///< (rM,3) static correction [m per unit]; empty without R
  /// A pressure: component k of the vector acts with the share −n_k of the outward normal, and (p, p, p) is
  /// the pressure p.
  bool inward = false;
  bool operator==(const Load&) const = default;
};

/// A support that moves by ū, the same vector at all its nodes; other supports do not move. With the static
/// lift Ψ (K Ψ = 0 off the supports), u = (Ψ − ΦΓ) ū + Φ p and p̈ + 2δ (ṗ − Γ ū̇) + ω² p = ω² Γ ū. Arrays
/// have one row or column for each component of ū along the axes of the body; it is 0 if the support does not
/// hold that component.
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
      residual_flexibility;  ///< (3,rM) under unit forces on the candidates [m/N]; empty without R
  std::vector<double> body_force_residual;  ///< (3,3) [s²]; empty without R
  std::vector<double>
      load_residual;  ///< (3,3L) under the L loads, in their order [m per unit]; empty without R
  std::vector<double> motion_residual;  ///< (3,3S) Ψ − ΦΓ of the S motions, in their order [1]
  bool operator==(const Receiver&) const = default;
};

/// A quantity of K rows that is linear in the displacement, in its unit [Q]: of each mode, and of each static
/// correction as for receivers.
template <class T>
struct SensitivityOf {
  std::vector<T> shape;                 ///< (K,N) [Q kg^-1/2 m^-1]
  std::vector<T> residual_flexibility;  ///< (K,rM) [Q/N]; empty without R
  std::vector<T> body_force_residual;   ///< (K,3) [Q s²/m]; empty without R
  std::vector<T> load_residual;         ///< (K,3L) [Q per unit]; empty without R
  std::vector<T> motion_residual;       ///< (K,3S) [Q/m]
  bool operator==(const SensitivityOf&) const = default;
};
using Sensitivity = SensitivityOf<double>;

/// Rows of a stress: xx, yy, zz, yz, xz, xy.
inline constexpr std::size_t stress_rows = 6;

/// A point whose stress is recorded, and its strain along a direction.
struct Gauge {
  std::string name;
  Vector3 point{};                      ///< [m]
  Sensitivity stress;                   ///< (6) xx, yy, zz, yz, xz, xy in the axes of the body [Pa]
  std::optional<Sensitivity> strain{};  ///< (1) along the direction of the gauge [1]
  bool operator==(const Gauge&) const = default;
};

/// The visualisation surface of the body, in single precision.
struct View {
  std::vector<double> node;           ///< (V,3) [m]
  int element_corners = 3;            ///< 3 triangles, 2 segments (rods)
  std::vector<std::int64_t> element;  ///< (E,k)
  std::vector<float> shape;           ///< (V,3,N) [kg^-1/2]
  // Static correction, as for receivers; empty without R.
  std::vector<float> residual_flexibility;  ///< (V,3,rM) under unit forces on the candidates [m/N]
  std::vector<float> body_force_residual;   ///< (V,3,3) [s²]
  std::vector<float> load_residual;         ///< (V,3,3L) [m per unit]
  std::vector<float> motion_residual;       ///< (V,3,3S) Ψ − ΦΓ [1]; never empty if S > 0
  /// (6V) stress at the nodes in the axes of the body [Pa], 6 rows for each; 0 for rigid modes. No value
  /// unless the scene asks for it.
  std::optional<SensitivityOf<float>> stress{};
  bool operator==(const View&) const = default;
};

struct Kernel {
  std::string body;         ///< its name in the scene
  std::string hash;         ///< SHA-256 (hex) of all that the kernel depends on
  std::string scene;        ///< settings that the kernel depends on, as resolved TOML
  std::string mesh_sha256;  ///< of the mesh file and the files that it includes
  std::string created_by;   ///< program and version
  std::int64_t dofs = 0;
  std::int64_t elements = 0;
  int order = 0;
  double mass = 0;                  ///< [kg]
  Vector3 centre{};                 ///< centre of mass [m]
  std::array<double, 9> inertia{};  ///< (3,3) about the centre of mass [kg m²]
  bool supported = false;           ///< a support holds some displacement
  std::int64_t parts = 0;           ///< connected parts of the mesh; 0: not known
  std::int64_t held_on_lines = 0;   ///< bit c: supports hold component c on lines or points only
  /// (H,3) nodes that lie farthest out in several hundred directions [m]; empty if not known
  std::vector<double> outline;
  /// Elements that share faces are a piece. Only if pieces of a body can move against each other without
  /// strain: lowest and highest coordinates of each (P,2,3) [m], and its number of elements (P).
  std::vector<double> piece_box{};
  std::vector<std::int64_t> piece_elements{};

  Modes modes;
  Surface surface;
  Loads loads;
  std::vector<Load> applied;    ///< tractions and point forces
  std::vector<Motion> motions;  ///< supports that move
  std::vector<Receiver> receivers;
  std::vector<Gauge> gauges{};
  std::optional<View> view;
  bool operator==(const Kernel&) const = default;
};

/// Calls act(sensitivity) for the stress and, where there is one, the strain of each gauge, and for the
/// stress of the visualisation surface.
template <class Act>
void for_each_sensitivity(Kernel& kernel, Act&& act) {
  for (Gauge& gauge : kernel.gauges) {
    act(gauge.stress);
    if (gauge.strain) act(*gauge.strain);
  }
  if (kernel.view && kernel.view->stress) act(*kernel.view->stress);
}

/// Calls act(values) for each matrix (rows,N) of values of modes, of doubles or of floats.
template <class Act>
void for_each_of_modes(Kernel& kernel, Act&& act) {
  act(kernel.surface.shape);
  act(kernel.loads.body_force);
  act(kernel.loads.rotation);
  for (Load& load : kernel.applied) act(load.participation);
  for (Motion& motion : kernel.motions) act(motion.participation);
  for (Receiver& receiver : kernel.receivers) act(receiver.shape);
  for_each_sensitivity(kernel, [&](auto& seen) { act(seen.shape); });
  if (kernel.view) act(kernel.view->shape);
}

/// Whether a load, a motion, a receiver or a gauge may have this name, which becomes the name of a dataset: 1
/// to 100 bytes, no "/" and no control characters, neither "." nor "..", and not a name that the file uses
/// for its own datasets of loads.
bool is_free_name(const std::string& name);

/// Throws an InputError that names `origin` if shapes disagree, a value is not finite, an area or a frequency
/// is negative, an index is out of range, or a normal is not a unit vector. Every loader calls it, so that
/// later code need not check again.
void validate(const Kernel& kernel, const std::string& origin);

}  // namespace ricochet::kernels
