// SPDX-License-Identifier: BSD-2-Clause
// The trace of modes on candidates, receivers and the visualisation surface.
#pragma once

#include "src/surface/patches.hpp"
#include "src/surface/sources.hpp"

namespace ricochet::surface {

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
