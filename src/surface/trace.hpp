// SPDX-License-Identifier: BSD-2-Clause
// The trace of modes on candidates, receivers and the visualisation surface.
#pragma once

#include "src/surface/patches.hpp"
#include "src/surface/sources.hpp"

namespace ricochet::surface {

/// Traces of N modes: `shape` (cM,N) at the candidates, `participation` (6,N) in uniform acceleration and
/// rotation, `applied` (3L,N) in the loads, and `at_receivers` (columns of Sources::receiver, N).
struct Traces {
  Eigen::MatrixXd shape, participation, applied, at_receivers;
};

/// Stores the traces in a kernel, together with all data that do not depend on the modes. The kernel must
/// have its modes, centre and inertia. Rigid modes are stored at the centroids x̂_i, elastic ones as means.
void take_traces(const Patches& patches, const Traces& traces, const Sources& sources,
                 kernels::Kernel& kernel);

/// Stores the static correction in a kernel.
/// @param response    responses at candidates, receivers and gauges (rows) to forces there, gravity and loads
/// (columns)
/// @param candidates  number of rows that belong to candidates
void take_corrections(const Eigen::Ref<const Eigen::MatrixXd>& response, Eigen::Index candidates,
                      const Sources& sources, kernels::Kernel& kernel);

/// The form in which the static correction at the candidates is kept: not at all, in all components, along
/// normals, or in all components and compressed as soon as it is computed.
enum class Correction { none, all, normal, compressed };

/// Fills a kernel with shapes, loads and the data of `sources`. Adds the static correction unless
/// `correction` is `none`, and the visualisation surface if `view` is set, with the stress of bodies that
/// have elements if `stressed` contains their materials. The visualisation surface is stored on rank 0 only;
/// everything else is the same on every rank. `loads` are the loads of the patches, `advance` is called with
/// the number of candidates whose correction is compressed, of all. Needs a GmshSession. Collective.
void trace(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
           modes::Factorisation& factor, const modes::ModeSet& modes, const Patches& patches,
           const reduction::Loads& loads, Correction correction, bool view, kernels::Kernel& kernel,
           const Sources& sources, const std::vector<scene::Material>& stressed = {},
           const parallel::Progress& advance = {});

}  // namespace ricochet::surface
