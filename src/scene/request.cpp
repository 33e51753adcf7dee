// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/request.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "ricochet/error.hpp"
#include "src/scene/loads.hpp"
#include "src/scene/near_miss.hpp"
#include "src/scene/parts.hpp"
#include "src/scene/scene.hpp"
#include "src/scene/write.hpp"

namespace ricochet::scene {

namespace {

/// Must be increased whenever the meaning of a kernel changes, so that old kernels are computed again.
constexpr int kernel_generation = 6;

/// What to do about a file that is missing: the similar one in its folder, or the meshes there.
std::string advice_on(const std::filesystem::path& missing) {
  std::error_code failure;
  if (std::filesystem::is_directory(missing, failure)) return "is a folder: name a file in it";
  std::vector<std::string> there;
  const std::filesystem::path folder = missing.parent_path().empty() ? "." : missing.parent_path();
  for (std::filesystem::directory_iterator entry(folder, failure), end; !failure && entry != end;
       entry.increment(failure))
    for (const char* ending : {".geo", ".msh", ".step", ".stp", ".brep"})
      if (entry->path().extension() == ending && entry->is_regular_file(failure))
        there.push_back(entry->path().filename().string());
  std::ranges::sort(there);
  if (there.empty() || there.size() > 5) return "no such file: a path starts at the folder of the scene";
  return "no such file" + existing_names(missing.filename().string(), there);
}

std::string bytes_of(const std::filesystem::path& path, const std::string& key) {
  // Reading a device or a pipe might not end.
  std::error_code ignored;
  const bool is_file = std::filesystem::is_regular_file(path, ignored);
  std::ifstream file;
  if (is_file) file.open(path, std::ios::binary);
  if (!file.is_open())
    throw InputError(fmt::format("{} = {}: {}", key, toml_string(path.string()), advice_on(path)));
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Hash of a mesh file or of its parts. The hash of a .geo covers the files that it includes or merges.
std::string mesh_hash(const std::filesystem::path& path, const std::string& key,
                      std::set<std::filesystem::path>& seen) {
  seen.insert(path);
  if (const std::vector<std::filesystem::path> parts = part_files(path); !parts.empty()) {
    std::string all;
    for (const std::filesystem::path& part : parts) all += sha256(bytes_of(part, key));
    return sha256(all);
  }
  const std::string text = bytes_of(path, key);
  std::string all = sha256(text);
  if (path.extension() != ".geo") return all;
  static const std::regex pulls("^\\s*(?:Include|Merge)\\s*\"([^\"\n]+)\"");
  std::istringstream lines(text);
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (line.size() > 1000 || !std::regex_search(line, match, pulls)) continue;
    const std::filesystem::path inner = (path.parent_path() / match[1].str()).lexically_normal();
    if (seen.count(inner) == 0) all += mesh_hash(inner, key + " includes", seen);
  }
  return sha256(all);
}

/// A direction in the frame of the body. Its sign is chosen so that the first nonzero component is positive,
/// and it is rounded so that round-off does not change hashes.
Vector3 own_axis(const Body& body, const Vector3& world) {
  Vector3 own = rounded(in_body(body, world));
  double sign = 1;
  for (std::size_t k = 3; k-- > 0;)
    if (own[k] != 0) sign = own[k] > 0 ? 1 : -1;
  for (double& x : own) x = x == 0 ? 0 : sign * x;
  return own;
}

}  // namespace

std::string sha256(const std::string& bytes) {
  std::array<unsigned char, 32> digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw SolverError("SHA-256 is not available in this OpenSSL");
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

KernelRequest kernel_request(const Scene& scene, const Body& body, MeshHashes* known) {
  const std::string file = scene.file.filename().string();
  KernelRequest request;
  request.body = body;
  request.body.translate = request.body.rotate_deg = request.body.velocity =
      request.body.angular_velocity = {};
  request.body.arrival = 0;
  for (Material& material : request.body.materials) material.yield = 0;
  request.body.copy_of.clear();
  if (!body.copy_of.empty()) request.body.name = body.copy_of;  // one file serves all strikes
  request.modes = scene.modes;
  request.view = scene.output.view;

  const Pair* first = nullptr;
  for (const Pair& pair : scene.contact.pairs) {
    if (!pair.names(body.name)) continue;
    std::optional<Vector3> direction, along;
    if (pair.direction) direction = own_axis(body, *pair.direction);
    if (pair.along) along = own_axis(body, *pair.along);
    if (first == nullptr) {
      first = &pair;
      request.direction = direction;
      request.along = along;
      request.spacing = pair.spacing;
      request.friction = pair.friction.has_value();
      continue;
    }
    request.friction = request.friction || pair.friction;
    if (along != request.along || pair.spacing != request.spacing)
      throw InputError(
          fmt::format("{}: contact: two pairs require different patches (along, spacing) of bodies.{}: a "
                      "body has one set of candidates; give both pairs the same values",
                      file, body.name));
    if (direction != request.direction) request.direction.reset();
  }
  if (request.friction) request.direction.reset();  // friction acts along the other two components
  if (known != nullptr && known->contains(body.mesh)) {
    request.mesh_sha256 = known->at(body.mesh);
  } else {
    std::set<std::filesystem::path> seen;
    request.mesh_sha256 = mesh_hash(body.mesh, fmt::format("{}: bodies.{}.mesh", file, body.name), seen);
    if (known != nullptr) known->emplace(body.mesh, request.mesh_sha256);
  }
  take_sources(scene, body, request);
  seal(request);
  return request;
}

bool may_be_normal(const KernelRequest& request) {
  return request.modes.residual_flexibility && !request.modes.all_components && !request.direction &&
         !request.friction && !request.body.contact.empty();
}

void seal(KernelRequest& request) {
  request.toml = "[body]\n" + toml_body_matter(request.body) + toml_modes(request.modes) + "[contact]\n";
  if (request.direction) request.toml += "direction = " + toml_vector(*request.direction) + "\n";
  if (request.along) request.toml += "along = " + toml_vector(*request.along) + "\n";
  if (request.spacing) request.toml += "spacing = " + toml_number(*request.spacing) + "\n";
  if (request.points) {
    const std::string points = fmt::format("{}", fmt::join(*request.points, ", "));
    // A list of thousands of points would be too long for an attribute, so the kernel stores it as a dataset.
    request.toml += request.within_reach ? fmt::format("within_reach = \"{}\"\n", sha256(points))
                                         : fmt::format("points = [{}]\n", points);
  }
  if (request.normal_residual) request.toml += "residual = \"normal\"\n";
  request.toml += fmt::format("[output]\nview = {}\n", request.view);
  request.toml += toml_sources(request);
  request.hash = sha256(fmt::format("{}\n{}\n{}", kernel_generation, request.mesh_sha256, request.toml));
}

void scale_sources(KernelRequest& request, double factor) {
  const auto scale = [&](Vector3& at) {
    for (double& x : at) x *= factor;
    at = rounded(at);
  };
  for (Forcing& driven : request.point_forces) scale(driven.at);
  for (Receiver& receiver : request.receivers) scale(receiver.at);
}

std::filesystem::path kernel_path(const std::filesystem::path& out, const KernelRequest& request) {
  return out / fmt::format("{}-{}.kernel.h5", request.body.name, request.hash.substr(0, 12));
}

}  // namespace ricochet::scene
