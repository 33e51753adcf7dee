// SPDX-License-Identifier: BSD-2-Clause
// What a kernel is asked to hold: all that it depends on, and the hash of it.
#pragma once

#include "src/scene/scene.hpp"

namespace ricochet::scene {

/// All that a body's kernel depends on, and nothing else. Vectors in the body's own frame.
struct KernelRequest {
  Body body;  ///< placement, velocity cleared
  Modes modes;
  std::optional<Vector3> direction;  ///< set only when every pair of the body gives the same one
  std::optional<Vector3> along;
  std::optional<double> spacing;
  /// Numbers of the candidates that are kept, of those of the whole surface; none: all.
  std::optional<std::vector<std::int64_t>> points;
  /// Why only these: pairs are still found on the whole surface, and they are what `reach` leaves
  /// (ascending). Otherwise they are somebody's choice, and all that is left of the surface; no scene asks
  /// for this.
  bool within_reach = false;
  bool view = false;
  std::vector<Driven> tractions, point_forces,
      motions;                      ///< of this body; vector and history cleared, `at` in its frame
  std::vector<Receiver> receivers;  ///< of this body; `at` in its frame
  std::vector<std::string> beside;  ///< of modes.accuracy: SHA-256 of the matter of each other body
  std::string mesh_sha256;
  std::string toml;  ///< the request written out, part of the hash
  std::string hash;  ///< SHA-256, hex
};

/// SHA-256 of meshes by path, of requests before: what changes on disk meanwhile is not seen.
using MeshHashes = std::map<std::filesystem::path, std::string>;

/// @param known  read and added to, where there are many requests
/// Throws InputError when two pairs ask different patches of one body, or a mesh file can't be read.
KernelRequest kernel_request(const Scene& scene, const Body& body, MeshHashes* known = nullptr);

/// The same of elements of the next lower order, or of order 2 in the place of 1: what the mesh does to
/// results shows beside it. None for a mesh file, which has an order of its own.
std::optional<KernelRequest> other_order(const KernelRequest& request);

/// Sets `toml` and `hash` from all else.
void seal(KernelRequest& request);

/// `<out>/<body>-<first 12 of hash>.kernel.h5`
std::filesystem::path kernel_path(const std::filesystem::path& out, const KernelRequest& request);

}  // namespace ricochet::scene
