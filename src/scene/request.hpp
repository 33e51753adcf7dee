// SPDX-License-Identifier: BSD-2-Clause
// The request for a kernel: the data that determine it, and their hash.
#pragma once

#include "src/scene/data/body.hpp"
#include "src/scene/data/gauge.hpp"
#include "src/scene/data/loads.hpp"
#include "src/scene/data/modes.hpp"
#include "src/scene/data/receiver.hpp"

namespace ricochet::kernels {
struct Header;
}

namespace ricochet::scene {

struct Obstacle;
struct Scene;

/// The data that determine the kernel of a body, and nothing else. Vectors are in the frame of the body.
struct KernelRequest {
  Body body;  ///< without velocity; its placement, which is not part of the hash, serves messages
  Modes modes;
  /// Set only if every pair of the body gives the same one, and none has friction.
  std::optional<Vector3> direction;
  std::optional<Vector3> along;
  std::optional<double> spacing;
  /// Candidates that the kernel keeps, as indices into those of the whole surface; no value: all.
  std::optional<std::vector<std::int64_t>> points;
  /// True if `points` (ascending) are the candidates within `reach`; contact pairs are then still found on
  /// the whole surface. False if they are an explicit choice, which no scene makes; the rest of the surface
  /// is then dropped.
  bool within_reach = false;
  /// True if the static correction is stored along the normals of the candidates alone. A scene decides this
  /// with its placement, like `points`.
  bool normal_residual = false;
  /// Whether a pair of the body has friction. The kernel then holds all components. Not part of the hash: it
  /// is the same kernel as that of a frictionless scene that needs all components.
  bool friction = false;
  /// Whether the body turns by any angle. The kernel then holds all components, because its points meet an
  /// obstacle in any direction, and its residual flexibility is compact.
  bool turns = false;
  bool view = false;
  bool stress = false;  ///< at the nodes of the visualisation surface, which `view` then asks for
  /// Whether the kernel estimates its errors by the mesh. Not part of the hash: it is the same kernel.
  bool mesh_error = false;
  /// Of this body; vectors and histories empty. `at` is in its frame, whatever `at_axes`, those of the scene.
  Loads loads;
  std::vector<Receiver> receivers;  ///< likewise
  std::vector<Gauge> gauges;        ///< likewise; so is `direction`, of either sign
  std::string mesh_sha256;
  std::string toml;  ///< the request as TOML, part of the hash
  std::string hash;  ///< SHA-256, hexadecimal
};

/// SHA-256 of `bytes` in hexadecimal digits. Throws SolverError if OpenSSL does not provide it.
std::string sha256(const std::string& bytes);

/// SHA-256 of mesh files by path, from earlier requests. Later changes of the files are not detected.
using MeshHashes = std::map<std::filesystem::path, std::string>;

/// Builds the request for the kernel of a body.
/// @param known  hashes to reuse; new ones are added
/// Throws InputError if two pairs require different patches of one body, or if a mesh file cannot be read.
KernelRequest kernel_request(const Scene& scene, const Body& body, MeshHashes* known = nullptr);

/// Whether the kernel may hold its static correction along the normals alone.
bool may_be_normal(const KernelRequest& request);

/// Sets `toml` and `hash` from all other members.
void seal(KernelRequest& request);

/// The same request with a visualisation surface.
KernelRequest with_view(KernelRequest request);

/// Returns the request that a kernel file answers, read from its header. The body has no name, mesh or
/// placement. Throws InputError that begins with `origin` if this version would not make such a kernel.
KernelRequest request_of(const kernels::Header& header, const std::string& origin);

/// Multiplies the positions of point forces, receivers and gauges, and of the lines about which axes of
/// materials turn, for a body of another size.
void scale_places(KernelRequest& request, double factor);

/// `<out>/<body>-<first 12 digits of hash>.kernel.h5`
std::filesystem::path kernel_path(const std::filesystem::path& out, const KernelRequest& request);

/// `<out>/<name>-<first 12 digits of the hash of the file>.msh`: what a foreign mesh becomes. Throws
/// InputError if the file cannot be read.
std::filesystem::path converted_path(const std::filesystem::path& out, const Scene& scene, const Body& body);

/// `<out>/<obstacle>-<first 12 digits of a hash>.stl`: the triangles of a drawn obstacle. The hash covers
/// what they depend on. Throws InputError if the drawing cannot be read.
std::filesystem::path surface_path(const std::filesystem::path& out, const Scene& scene,
                                   const Obstacle& obstacle);

}  // namespace ricochet::scene
