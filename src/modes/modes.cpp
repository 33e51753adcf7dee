// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/modes/checkpoint_folder.hpp"
#include "src/modes/eps_solve.hpp"

namespace ricochet::modes {
namespace {

ExpectedCount expected_count(const elasticity::Body& body) {
  kernels::Extent extent = kernels::box_of(body.total_mass, body.inertia);
  if (body.surface > 0) {
    extent.volume = body.volume;
    extent.surface = body.surface;
  }
  return kernels::expected_count(extent, body.wave_speed, body.poisson);
}

}  // namespace

std::int64_t expected_modes(const elasticity::Body& body, Hertz up_to) {
  // A mode that a mesh resolves takes at least this many displacements.
  constexpr std::int64_t per_mode = 6;
  const double omega = RadPerSecond(up_to).value, count = expected_count(body)(omega * omega);
  return std::min(body.free_rows / per_mode, static_cast<std::int64_t>(std::min(count, 1e15))) + 6;
}

Request request_of(const elasticity::Body& body, Request request) {
  request.expected = expected_count(body);
  return request;
}

void refuse_more_than_there_are(std::optional<std::int64_t> count, const elasticity::Body& body) {
  if (body.free_rows == 0)
    throw InputError("the supports hold every node of the mesh: hold fewer, or refine the mesh");
  if (count && *count > body.free_rows)
    throw InputError(
        fmt::format("modes.count = {}: the body has {} free displacements: request fewer, or refine the mesh",
                    *count, body.free_rows));
}

ModeSet compute_modes(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                      Factorisation& factor, const Request& request, const Progress& progress) {
  refuse_more_than_there_are(request.count, body);
  const Operators operators(mesh, body);
  if (request.up_to) operators.refuse_band(*request.up_to, true);
  return modes_by_eps(teams, operators, body.stiffness, body.mass, factor, request_of(body, request),
                      CheckpointFolder(teams, operators, request.checkpoint), progress);
}

}  // namespace ricochet::modes
