// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/request.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <utility>

#include "kernels/read.hpp"
#include "src/scene/keys.hpp"
#include "src/scene/loads.hpp"
#include "src/scene/modes.hpp"
#include "src/scene/near_miss.hpp"
#include "src/scene/parts.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::scene {

namespace {

/// Must be increased whenever the meaning of a kernel changes, so that old kernels are computed again.
constexpr int kernel_generation = 7;
/// The same for meshes of other programs.
constexpr int import_generation = 1;
/// The same for the triangles of obstacles.
constexpr int surface_generation = 1;
/// The same for kernels with a visualisation surface.
constexpr const char* view_generation = " view 2";
/// The same for kernels with stress, at gauges or on the surface.
constexpr const char* stress_generation = " stress 2";

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

std::ifstream opened(const std::filesystem::path& path, const std::string& key) {
  // Reading a device or a pipe might not end.
  std::error_code ignored;
  const bool is_file = std::filesystem::is_regular_file(path, ignored);
  std::ifstream file;
  if (is_file) file.open(path, std::ios::binary);
  if (!file.is_open())
    throw InputError(fmt::format("{} = {}: {}", key, toml_string(path.string()), advice_on(path)));
  return file;
}

/// Hash of the rest of a file, of which only a piece is in memory at a time.
std::string hash_of(std::istream& file) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> state(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  std::array<unsigned char, 32> digest{};
  std::array<char, 1 << 16> piece;
  bool right = EVP_DigestInit_ex(state.get(), EVP_sha256(), nullptr) == 1;
  while (right && (file.read(piece.data(), piece.size()) || file.gcount() > 0))
    right = EVP_DigestUpdate(state.get(), piece.data(), static_cast<std::size_t>(file.gcount())) == 1;
  if (!right || EVP_DigestFinal_ex(state.get(), digest.data(), nullptr) != 1)
    throw SolverError("SHA-256 is not available in this OpenSSL");
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

/// How a line of a file includes another one; null: files of this kind include none.
const std::regex* includes_of(const std::filesystem::path& file) {
  static const std::regex geo("^\\s*(?:Include|Merge)\\s*\"([^\"\n]+)\""),
      inp(R"(^\*[^=]*\bINPUT\s*=\s*"?([^",\s]+))", std::regex::icase),
      bulk(R"(^\s*INCLUDE\s+['"]?([^'"$]+?)['"]?\s*$)", std::regex::icase);
  const std::string ending = file.extension().string();
  if (ending == ".geo") return &geo;
  if (ending == ".inp") return &inp;
  return ending == ".bdf" || ending == ".nas" || ending == ".fem" ? &bulk : nullptr;
}

/// Hash of a mesh file or of its parts. The hash of a .geo or a deck covers the files that it includes or
/// merges.
std::string mesh_hash(const std::filesystem::path& path, const std::string& key,
                      std::set<std::filesystem::path>& seen) {
  seen.insert(path);
  if (const std::vector<std::filesystem::path> parts = part_files(path); !parts.empty()) {
    std::string all;
    for (const std::filesystem::path& part : parts) {
      std::ifstream file = opened(part, key);
      all += hash_of(file);
    }
    return sha256(all);
  }
  std::ifstream file = opened(path, key);
  std::string all = hash_of(file);
  const std::regex* const pulls = includes_of(path);
  if (pulls == nullptr) return all;
  file.clear();
  file.seekg(0);
  std::smatch match;
  for (std::string line; std::getline(file, line);) {
    if (line.size() > 1000 || !std::regex_search(line, match, *pulls)) continue;
    const std::filesystem::path inner = (path.parent_path() / match[1].str()).lexically_normal();
    if (seen.count(inner) == 0) all += mesh_hash(inner, key + " includes", seen);
  }
  return sha256(all);
}

/// Hash of the mesh of a body.
std::string mesh_hash(const Scene& scene, const Body& body) {
  std::set<std::filesystem::path> seen;
  const std::string hash = mesh_hash(
      body.mesh, fmt::format("{}: bodies.{}.mesh", scene.file.filename().string(), body.name), seen);
  return body.foreign() ? sha256(fmt::format("import {} {}", import_generation, hash)) : hash;
}

/// Rounds to 1e-12, so that hashes do not depend on round-off.
Vector3 rounded(Vector3 vector) {
  for (double& x : vector) x = std::round(x * 1e12) / 1e12;
  return vector;
}

/// A direction in the frame of the body. Its sign is chosen so that the first nonzero component is positive,
/// and it is rounded so that round-off does not change hashes.
Vector3 own_axis(Vector3 own) {
  own = rounded(own);
  double sign = 1;
  for (std::size_t k = 3; k-- > 0;)
    if (own[k] != 0) sign = own[k] > 0 ? 1 : -1;
  for (double& x : own) x = x == 0 ? 0 : sign * x;
  return own;
}

Vector3 own_axis(const Body& body, const Vector3& world) { return own_axis(in_body(body, world)); }

/// The place of a load, a receiver or a gauge in the frame of its body.
template <class S>
Vector3 own_place(const Body& body, const S& source) {
  return rounded(source.at_axes == Axes::body ? source.at : point_in_body(body, source.at));
}

/// Copies the loads, motions, receivers and gauges of `all` that belong to the body into the request, reduced
/// to the data on which its kernel depends.
void take_sources(const Scene& all, const Body& placed, KernelRequest& request) {
  for (const LoadKind& kind : load_kinds)
    for (Forcing driven : all.loads.*kind.list) {
      if (driven.body != placed.name) continue;
      driven.vector = {};
      if (driven.pressure) driven.pressure = 0;  // only whether the load is one
      driven.history.clear();
      driven.axes.reset();
      if (&kind.keys == &point_keys) driven.at = own_place(placed, driven);
      // All motions of a support share one dataset of the kernel, whatever their histories.
      if (&kind.keys == &motion_keys) driven.name = driven.group;
      std::vector<Forcing>& list = request.loads.*kind.list;
      if (std::ranges::count(list, driven.name, &Forcing::name) == 0) list.push_back(driven);
    }
  for (Receiver receiver : all.output.receivers) {
    if (receiver.body != placed.name) continue;
    receiver.axes = Axes::world;
    receiver.at = own_place(placed, receiver);
    request.receivers.push_back(receiver);
  }
  for (Gauge gauge : all.output.gauges) {
    if (gauge.body != placed.name) continue;
    gauge.at = own_place(placed, gauge);
    if (gauge.direction)
      gauge.direction =
          gauge.at_axes == Axes::body ? own_axis(*gauge.direction) : own_axis(placed, *gauge.direction);
    request.gauges.push_back(gauge);
  }
}

/// Points within reach may be thousands, too many for an attribute, so the kernel stores them as a dataset.
bool read_reach(const Table& table, const Key& key, KernelRequest& request) {
  return request.within_reach = table.has(key.name);
}

std::string reach_of(const KernelRequest& request) {
  if (!request.points || !request.within_reach) return "";
  return toml_string(sha256(fmt::format("{}", fmt::join(*request.points, ", "))));
}

bool has_chosen_points(const KernelRequest& request) { return !request.within_reach; }

// The tables of a request, which differ from those of a scene.
const SectionOf<KernelRequest> request_keys{"a kernel's scene",
                                            "",
                                            {{"body", Type::table},
                                             {"modes", Type::table},
                                             {"contact", Type::table},
                                             {"loads", Type::table},
                                             {"output", Type::table}}};
const SectionOf<KernelRequest> request_contact_keys{
    "[contact] of a kernel's scene",
    "",
    {{"direction", &KernelRequest::direction},  // rounded, so its length is not exactly 1
     {"along", &KernelRequest::along},
     {"spacing", &KernelRequest::spacing},
     {"points", Access(&KernelRequest::points).only(has_chosen_points, "a kernel without within_reach")},
     {"within_reach", Access(Type::text, read_reach, reach_of)},
     {"residual", choice<KernelRequest>(&KernelRequest::normal_residual, {"all", "normal"}).if_changed()},
     {"turns", Access(&KernelRequest::turns).if_changed()}}};
const SectionOf<KernelRequest> request_output_keys{"[output] of a kernel's scene",
                                                   "",
                                                   {{"view", &KernelRequest::view},
                                                    {"stress", Access(&KernelRequest::stress).if_changed()},
                                                    {"receiver", Type::tables},
                                                    {"gauge", Type::tables}}};

/// The keys of a request, in which places are in the frame of the body, whichever key of the scene gave them.
template <class S>
SectionOf<S> with_own_place(SectionOf<S> keys) {
  keys = keys.without({"at_body"});
  for (Key& key : keys.keys)
    if (key.name == "at") key.access.is_written = {};
  return keys;
}

SectionOf<Forcing> request_keys_of(const LoadKind& kind) {
  return with_own_place(kind.keys.without({"body", "obstacle", "vector", "axes", "history"}));
}

SectionOf<Receiver> request_receiver_keys() {
  return with_own_place(receiver_keys.without({"body", "axes"}));
}

SectionOf<Gauge> request_gauge_keys() {
  SectionOf<Gauge> keys = with_own_place(gauge_keys.without({"body"}));
  for (Key& key : keys.keys)  // rounded, so its length is not exactly 1
    if (key.name == "direction") key.access = Access(&Gauge::direction), key.type = key.access.type;
  return keys;
}

/// Reads [loads], and the receivers and gauges in [output].
void read_sources(const Table& root, const Table& output, KernelRequest& request) {
  if (const auto loads = root.table("loads", loads_keys))
    for (const LoadKind& kind : load_kinds) {
      const auto keys = request_keys_of(kind);
      for (const Table& entry : loads->array(kind.name, keys))
        keys.read(entry, (request.loads.*kind.list).emplace_back());
    }
  const auto keys = request_receiver_keys();
  for (const Table& entry : output.array("receiver", keys))
    keys.read(entry, request.receivers.emplace_back());
  const auto of_gauges = request_gauge_keys();
  for (const Table& entry : output.array("gauge", of_gauges))
    of_gauges.read(entry, request.gauges.emplace_back());
}

}  // namespace

std::string sha256(const std::string& bytes) {
  std::istringstream stream(bytes);
  return hash_of(stream);
}

KernelRequest kernel_request(const Scene& scene, const Body& body, MeshHashes* known) {
  const std::string file = scene.file.filename().string();
  KernelRequest request;
  request.body = body;
  request.body.velocity = request.body.angular_velocity = {};
  request.body.arrival = 0;
  for (Material& material : request.body.materials) material.yield = 0;
  request.body.copy_of.clear();
  if (!body.copy_of.empty()) request.body.name = body.copy_of;  // one file serves all strikes
  request.modes = scene.modes;
  request.view = scene.output.view;
  request.stress = scene.output.stress;
  request.turns = scene.motion.is_finite();

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
  // Friction acts along the other two components; an obstacle meets a body that turns along any of its axes.
  if (request.friction || request.turns) request.direction.reset();
  if (known != nullptr && known->contains(body.mesh)) {
    request.mesh_sha256 = known->at(body.mesh);
  } else {
    request.mesh_sha256 = mesh_hash(scene, body);
    if (known != nullptr) known->emplace(body.mesh, request.mesh_sha256);
  }
  if (!body.converted.empty()) request.body.mesh = std::exchange(request.body.converted, {});
  take_sources(scene, body, request);
  constexpr int lowest_with_estimate = 2;
  request.mesh_error = scene.accuracy && !body.imported() && body.order >= lowest_with_estimate;
  seal(request);
  return request;
}

bool may_be_normal(const KernelRequest& request) {
  return request.modes.residual_flexibility && !request.modes.all_components && !request.direction &&
         !request.friction && !request.turns && !request.body.contact.empty();
}

void seal(KernelRequest& request) {
  request.toml = "[body]\n" + matter_keys.write(request.body) + "[modes]\n" +
                 modes_keys.write(request.modes) + "[contact]\n" + request_contact_keys.write(request) +
                 "[output]\n" + request_output_keys.write(request);
  for (const LoadKind& kind : load_kinds)
    for (const Forcing& driven : request.loads.*kind.list)
      request.toml += fmt::format("[[loads.{}]]\n{}", kind.name, request_keys_of(kind).write(driven));
  for (const Receiver& receiver : request.receivers)
    request.toml += "[[output.receiver]]\n" + request_receiver_keys().write(receiver);
  for (const Gauge& gauge : request.gauges)
    request.toml += "[[output.gauge]]\n" + request_gauge_keys().write(gauge);
  request.hash = sha256(fmt::format("{}{}{}\n{}\n{}", kernel_generation, request.view ? view_generation : "",
                                    request.stress || !request.gauges.empty() ? stress_generation : "",
                                    request.mesh_sha256, request.toml));
}

KernelRequest with_view(KernelRequest request) {
  request.view = true;
  seal(request);
  return request;
}

KernelRequest request_of(const kernels::Header& header, const std::string& origin) {
  KernelRequest request;
  request.mesh_sha256 = header.mesh_sha256;
  toml::table parsed;
  try {
    parsed = parse_toml(header.scene, origin);
  } catch (const toml::parse_error& error) {
    throw InputError(
        one_line(fmt::format("{}: its scene is not TOML ({}). Compute it again with "
                             "ricochet-kernel.",
                             origin, error.description())));
  }
  const Table root(parsed, request_keys, origin);
  const auto body = root.table("body", matter_keys);
  if (!body) root.complain("body", "is missing. Compute it again with ricochet-kernel.");
  matter_keys.read(*body, request.body);
  request.modes = read_modes(root);
  if (const auto contact = root.table("contact", request_contact_keys)) {
    request_contact_keys.read(*contact, request);
    if (request.within_reach) request.points = header.held;
  }
  if (const auto output = root.table("output", request_output_keys)) {
    request_output_keys.read(*output, request);
    read_sources(root, *output, request);
  }
  seal(request);
  if (request.hash != header.hash)
    throw InputError(
        fmt::format("{}: is a kernel of another version. Compute it again with ricochet-kernel.", origin));
  return request;
}

void scale_places(KernelRequest& request, double factor) {
  const auto scale = [&](Vector3& at) {
    for (double& x : at) x *= factor;
    at = rounded(at);
  };
  for (Forcing& driven : request.loads.points) scale(driven.at);
  for (Receiver& receiver : request.receivers) scale(receiver.at);
  for (Gauge& gauge : request.gauges) {
    scale(gauge.at);
    gauge.length *= factor;
  }
  for (Material& material : request.body.materials)
    if (material.about) scale(material.about->point);
}

std::filesystem::path kernel_path(const std::filesystem::path& out, const KernelRequest& request) {
  return out / fmt::format("{}-{}.kernel.h5", request.body.name, request.hash.substr(0, 12));
}

std::filesystem::path converted_path(const std::filesystem::path& out, const Scene& scene, const Body& body) {
  return out / fmt::format("{}-{}.msh", body.mesh.filename().string(), mesh_hash(scene, body).substr(0, 12));
}

std::filesystem::path surface_path(const std::filesystem::path& out, const Scene& scene,
                                   const Obstacle& obstacle) {
  std::set<std::filesystem::path> seen;
  const std::string key = fmt::format("{}: obstacles.{}.surface", scene.file.filename().string(),
                                      obstacle.name),
                    hash = sha256(fmt::format("surface {} {} {}", surface_generation,
                                              mesh_hash(obstacle.surface, key, seen),
                                              toml_number(obstacle.size_factor)));
  return out / fmt::format("{}-{}.stl", slug(obstacle.name), hash.substr(0, 12));
}

}  // namespace ricochet::scene
