// SPDX-License-Identifier: BSD-2-Clause
// The request for a kernel: all that the kernel depends on, and its hash.
#pragma once

#include "src/scene/scene.hpp"

namespace ricochet::scene {

/// All that the kernel of a body depends on, and nothing else. Vectors are in the frame of the body.
struct KernelRequest {
  Body body;  ///< placement, velocity cleared
  Modes modes;
  std::optional<Vector3> direction;  ///< set only if every pair of the body gives the same one
  std::optional<Vector3> along;
  std::optional<double> spacing;
  /// Indices, among the candidates of the whole surface, of those that the kernel keeps; none: all.
  std::optional<std::vector<std::int64_t>> points;
  /// Whether `points` (ascending) are the candidates within `reach`, with pairs still found on the whole
  /// surface. Otherwise they are an explicit choice, the rest of the surface is dropped, and no scene makes
  /// such a request.
  bool within_reach = false;
  bool view = false;
  std::vector<Forcing> tractions, point_forces,
      motions;                      ///< of this body; vector and history empty, `at` in its frame
  std::vector<Receiver> receivers;  ///< of this body; `at` in its frame
  std::vector<std::string> beside;  ///< with modes.accuracy: SHA-256 of mesh and material of the others
  std::string mesh_sha256;
  std::string toml;  ///< the request as TOML, part of the hash
  std::string hash;  ///< SHA-256, hex
};

/// SHA-256 of `bytes`, in hexadecimal digits. Throws SolverError if OpenSSL does not offer it.
std::string sha256(const std::string& bytes);

/// SHA-256 of meshes by path, from earlier requests. Later changes of the files are not noticed.
using MeshHashes = std::map<std::filesystem::path, std::string>;

/// @param known  read and extended, for many requests
/// Throws InputError if two pairs require different patches of one body, or if a mesh file cannot be read.
KernelRequest kernel_request(const Scene& scene, const Body& body, MeshHashes* known = nullptr);

/// The same request with elements of the next lower order, or with order 2 instead of 1: comparing both shows
/// the error due to the mesh. None for a mesh file, whose order is fixed.
std::optional<KernelRequest> other_order(const KernelRequest& request);

/// Sets `toml` and `hash` from all other members.
void seal(KernelRequest& request);

/// `<out>/<body>-<first 12 of hash>.kernel.h5`
std::filesystem::path kernel_path(const std::filesystem::path& out, const KernelRequest& request);

}  // namespace ricochet::scene
