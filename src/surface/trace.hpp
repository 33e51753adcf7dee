// SPDX-License-Identifier: BSD-2-Clause
// The trace of modes on candidates, receivers and the visualisation surface.
#pragma once

#include "src/surface/patches.hpp"
#include "src/surface/sources.hpp"

namespace ricochet::surface {

/// Modes at the candidates, (cM,N), under uniform acceleration and rotation, (6,N), under the loads, (3L,N),
/// and at the receivers, (3R,N).
struct Traces {
  Eigen::MatrixXd shape, participation, applied, at_receivers;
};

/// Stores the traces in a kernel, with all data that do not depend on the modes.
void take_traces(const Patches& patches, const Traces& traces, const Sources& sources,
                 kernels::Kernel& kernel);

/// Stores the static correction in a kernel, from the responses at candidates and receivers (rows) to forces
/// there, gravity and the loads (columns). @param candidates  number of rows that belong to candidates
void take_residuals(const Eigen::MatrixXd& response, Eigen::Index candidates, const Sources& sources,
                    kernels::Kernel& kernel);

/// Fills shape, residual flexibility and loads of a kernel, the parts that depend on `sources`, and, if
/// `view` is set, its visualisation surface. The result is the same on every rank, except for the
/// visualisation surface, which is on rank 0. `loads` are those of the patches. Collective.
void trace(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
           modes::Factorisation& factor, const modes::ModeSet& modes, const Patches& patches,
           Eigen::MatrixXd loads, bool residual, bool view, kernels::Kernel& kernel, const Sources& sources);

}  // namespace ricochet::surface
