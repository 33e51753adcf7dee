// Candidate contact patches on a body's surface, and the trace of modes on them.
#pragma once

#include <Eigen/Dense>

#include "ricochet/kernel.hpp"
#include "src/mesh/mesh.hpp"
#include "src/modes/lift.hpp"
#include "src/scene/request.hpp"

namespace ricochet::surface {

/// One weight of a patch: candidate i spreads a unit force on the nodes, C(node, i) = (1/A_i) ∫ w_i N_node
/// ds. Loads and receivers spread likewise, numbered in their order.
struct Weight {
  std::int64_t node;  ///< global
  int candidate;
  double value;
};

/// Patches, the same on every rank.
struct Patches {
  kernels::Surface geometry;  ///< all but shape and residual flexibility
  std::vector<Weight> weights;
};

struct PatchOptions {
  std::optional<Vector3> direction{};  ///< unit: only this component of the trace is kept
  std::optional<Vector3> along{};      ///< unit: one patch for all that lies on a line in this direction
  std::optional<double> spacing{};     ///< [m] between candidates; none: every node of the subdivided surface
};

/// Hats w_i ≥ 0, Σ w_i = 1, on the vertices of the surface subdivided to the element order; merged along a
/// direction and thinned to a spacing when asked. Needs a GmshSession. `rod_area` is the cross-section of a
/// rod. Throws InputError when the mesh has no contact facets.
Patches make_patches(const mesh::Mesh& mesh, const std::vector<std::string>& groups,
                     const PatchOptions& options);

/// Leaves out all candidates but `points` (ascending). Patches and loads of those that stay are as before,
/// and the surface remembers them all (kernels::WholeSurface).
void keep(Patches& patches, const std::vector<std::int64_t>& points);

/// Loads of the patches: column c·i + k is a unit force on patch i in component k (c = 3), or along
/// `direction` (c = 1). Held components carry none. @return (local rows, c M) [N]
Eigen::MatrixXd patch_loads(const mesh::Mesh& mesh, const Patches& patches);

/// What else than contact acts on the body or is seen of it, the same on every rank but for rows of the mesh.
struct Sources {
  std::vector<kernels::Load> loads;          ///< name, unit, total and moment
  std::vector<kernels::Motion> motions;      ///< names, in the order of mesh::Asked::moved
  std::vector<kernels::Receiver> receivers;  ///< names and points
  std::vector<Weight> at_receivers;
  Eigen::MatrixXd load;      ///< (local rows, 3 each): unit traction or force in each component; held 0
  Eigen::MatrixXd receiver;  ///< likewise, of a unit force at each receiver
  modes::Lift lift;          ///< of the supports that move; filled in when there are factors
};

/// What the body's mesh is asked for by a request.
mesh::Asked asked_of(const scene::KernelRequest& request);

/// All but the lift. `mesh` was read with asked_of(request). Needs a GmshSession. Collective.
/// Throws InputError when a point is farther from the body than 1e-6 of its size.
Sources make_sources(const mesh::Mesh& mesh, const scene::KernelRequest& request);

enum class HeldRows { zero, filled };

/// Unit forces at places that spread them by weights: column 3·i + k is component k at place i, or column i
/// that along `direction`. With held rows filled its transpose gives the displacement of the places from that
/// of all nodes. @return (local rows, columns) [N]
Eigen::MatrixXd spread(const mesh::Mesh& mesh, const std::vector<Weight>& weights, std::size_t places,
                       const std::optional<Vector3>& direction, HeldRows held);

/// Modes at the candidates, (cM,N), under uniform acceleration and turning, (6,N), the loads, (3L,N), and at
/// the receivers, (3R,N).
struct Traces {
  Eigen::MatrixXd shape, participation, applied, heard;
};

/// Into a kernel, with what does not depend on modes.
void take_traces(const Patches& patches, const Traces& traces, const Sources& sources,
                 kernels::Kernel& kernel);

/// Static parts of what the modes leave out, from the responses at candidates and receivers (rows) to forces
/// there, gravity and the loads (columns). @param candidates  how many rows are theirs
void take_residuals(const Eigen::MatrixXd& response, Eigen::Index candidates, const Sources& sources,
                    kernels::Kernel& kernel);

/// Fills shape, residual flexibility and loads of a kernel, what it has of `sources`, and its view when
/// asked; the same on every rank but for the view, which is on rank 0. `loads` are those of the patches.
/// Collective.
void trace(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
           modes::Factorisation& factor, const modes::ModeSet& modes, const Patches& patches,
           Eigen::MatrixXd loads, bool residual, bool view, kernels::Kernel& kernel, const Sources& sources);

}  // namespace ricochet::surface
