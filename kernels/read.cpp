// SPDX-License-Identifier: BSD-2-Clause
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/hdf5_reader.hpp"
#include "kernels/format.hpp"
#include "kernels/read.hpp"
#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

namespace hdf5 = base::hdf5;
namespace {

using hdf5::any;

constexpr const char* kAdvice = "Compute it again with ricochet-kernel.";

/// Whether the file is marked as a kernel; its version is checked separately.
bool is_kernel(const hdf5::Reader& file) {
  return file.has_attribute("/", "format") && file.string_attribute("/", "format") == kFormat;
}

bool read_flag(const hdf5::Reader& file, const std::string& object, const std::string& name) {
  const std::int64_t flag = file.integer_attribute(object, name);
  if (flag != 0 && flag != 1)
    file.fail(fmt::format("attribute \"{}\" of \"{}\" is {}, not 0 or 1.", name, object, flag));
  return flag == 1;
}

void read_root(const hdf5::Reader& file, Kernel& kernel) {
  if (!is_kernel(file)) file.fail("is not a Ricochet kernel (no attribute format = \"ricochet-kernel\").");
  const std::int64_t version = file.integer_attribute("/", "version");
  if (version > kVersion)
    file.fail(
        fmt::format("has format version {}, but this program reads versions up to {}. Use a newer Ricochet.",
                    version, kVersion));
  if (version < 1) file.fail(fmt::format("has format version {}, which never existed.", version));
  kernel.body = file.string_attribute("/", "body");
  kernel.hash = file.string_attribute("/", "hash");
  kernel.scene = file.string_attribute("/", "scene");
  kernel.mesh_sha256 = file.string_attribute("/", "mesh_sha256");
  kernel.created_by = file.string_attribute("/", "created_by");
  kernel.dofs = file.integer_attribute("/", "dofs");
  kernel.elements = file.integer_attribute("/", "elements");
  const std::int64_t order = file.integer_attribute("/", "order");
  if (order < 0 || order > std::numeric_limits<int>::max())
    file.fail(fmt::format("attribute \"order\" is {}.", order));
  kernel.order = static_cast<int>(order);
  kernel.mass = file.double_attribute("/", "mass");
  kernel.supported = read_flag(file, "/", "supported");
  std::ranges::copy(file.read<double>("/body/centre", {3}), kernel.centre.begin());
  std::ranges::copy(file.read<double>("/body/inertia", {3, 3}), kernel.inertia.begin());
}

Modes read_modes(const hdf5::Reader& file) {
  Modes modes;
  modes.angular_frequency = file.read<double>("/modes/angular_frequency", {any});
  const std::size_t n = modes.size();
  modes.basis = file.string_attribute("/modes", "basis");
  modes.decay_rate = file.read<double>("/modes/decay_rate", {n});
  modes.residual = file.read<double>("/modes/residual", {n});

  const std::string group = "/modes/certificate";
  Certificate& certificate = modes.certificate;
  certificate.below = file.integer_attribute(group, "below");
  certificate.upto_hz = file.double_attribute(group, "upto_hz");
  certificate.count_by_inertia = file.integer_attribute(group, "count_by_inertia");
  certificate.count_found = file.integer_attribute(group, "count_found");
  certificate.left_out = file.integer_attribute(group, "left_out");
  certificate.complete = read_flag(file, group, "complete");
  certificate.orthonormality = file.double_attribute(group, "orthonormality");
  certificate.flexibility_error = file.double_attribute(group, "flexibility_error");
  if (file.has_attribute(group, "approximate"))
    certificate.approximate = file.integer_attribute(group, "approximate");
  if (!certificate.complete && !modes.imported())
    file.fail(fmt::format("its certificate is not complete ({} modes found, {} proved).",
                          certificate.count_found, certificate.count_by_inertia));
  if (certificate.count_found < 0 || certificate.left_out < 0)
    file.fail("its certificate contains a negative count.");
  const std::int64_t kept = certificate.count_found - certificate.left_out;
  if (kept < 0 || static_cast<std::uint64_t>(kept) != n)
    file.fail(
        fmt::format("its certificate is for {} modes, but \"/modes/angular_frequency\" has {}.", kept, n));
  return modes;
}

/// Corners of the elements in a dataset; 4 means more than 3.
int corners_of(const hdf5::Reader& file, const std::string& dataset) {
  return static_cast<int>(std::min<std::size_t>(file.shape(dataset)[1], 4));
}

WholeSurface read_whole(const hdf5::Reader& file) {
  const std::string group = "/surface/whole";
  WholeSurface whole;
  whole.area = file.read<double>(group + "/area", {any});
  const std::size_t w = whole.area.size();
  whole.node = file.read<double>(group + "/node", {w, 3});
  if (file.exists(group + "/centroid")) whole.centroid = file.read<double>(group + "/centroid", {w, 3});
  whole.normal = file.read<double>(group + "/normal", {w, 3});
  whole.element = file.read<std::int64_t>(group + "/element", {any, any});
  whole.element_corners = corners_of(file, group + "/element");
  whole.held = file.read<std::int64_t>(group + "/held", {any});
  return whole;
}

Surface read_surface(const hdf5::Reader& file, std::size_t n) {
  Surface surface;
  surface.area = file.read<double>("/surface/area", {any});
  const std::size_t m = surface.size();
  surface.node = file.read<double>("/surface/node", {m, 3});
  if (file.exists("/surface/centroid")) surface.centroid = file.read<double>("/surface/centroid", {m, 3});
  surface.group = file.read_strings("/surface/group", m);
  surface.normal = file.read<double>("/surface/normal", {m, 3});
  surface.element = file.read<std::int64_t>("/surface/element", {any, any});
  surface.element_corners = corners_of(file, "/surface/element");
  if (file.has_attribute("/surface/shape", "direction")) {
    surface.components = 1;
    const std::vector<double> direction = file.doubles_attribute("/surface/shape", "direction", 3);
    surface.direction = Vector3{direction[0], direction[1], direction[2]};
  }
  surface.shape =
      file.read<double>("/surface/shape", surface.direction ? hdf5::Shape{m, n} : hdf5::Shape{m, 3, n});
  const std::size_t rows = static_cast<std::size_t>(surface.components) * m;
  if (file.exists("/surface/residual_flexibility"))
    surface.residual_flexibility = file.read<double>("/surface/residual_flexibility", {rows, rows});
  if (file.exists("/surface/whole")) surface.whole = read_whole(file);
  return surface;
}

Loads read_loads(const hdf5::Reader& file, const Surface& surface, std::size_t n) {
  Loads loads;
  const std::size_t m = surface.size();
  loads.body_force = file.read<double>("/loads/body_force", {3, n});
  loads.rotation = file.read<double>("/loads/rotation", {3, n});
  if (file.exists("/loads/body_force_residual"))
    loads.body_force_residual = file.read<double>(
        "/loads/body_force_residual", surface.direction ? hdf5::Shape{m, 3} : hdf5::Shape{m, 3, 3});
  return loads;
}

/// Reads the names in a list, which may be missing. They become names of datasets and are therefore checked
/// first.
std::vector<std::string> read_names(const hdf5::Reader& file, const std::string& list) {
  if (!file.exists(list)) return {};
  const hdf5::Shape shape = file.shape(list);
  if (shape.size() != 1) file.fail(fmt::format("dataset \"{}\" is not a list.", list));
  std::vector<std::string> names = file.read_strings(list, shape[0]);
  for (const std::string& name : names)
    if (!is_free_name(name)) file.fail(fmt::format("dataset \"{}\" contains an invalid name.", list));
  return names;
}

template <hdf5::Element T = double>
std::vector<T> read_if_there(const hdf5::Reader& file, const std::string& dataset, const hdf5::Shape& shape) {
  return file.exists(dataset) ? file.read<T>(dataset, shape) : std::vector<T>{};
}

/// Reads loads with histories, motions of supports, and receivers.
void read_sources(const hdf5::Reader& file, Kernel& kernel) {
  const std::size_t m = kernel.surface.size(), n = kernel.modes.size();
  const bool directed = kernel.surface.direction.has_value();
  const hdf5::Shape on_surface = directed ? hdf5::Shape{m, 3} : hdf5::Shape{m, 3, 3};
  for (const std::string& name : read_names(file, "/names/loads")) {
    const std::string dataset = "/loads/" + name, data = "/load_data/" + name;
    Load load;
    load.name = name;
    load.participation = file.read<double>(dataset, {3, n});
    const std::string unit = file.string_attribute(dataset, "unit");
    load.unit = unit == kTractionUnit ? "Pa" : unit == kForceUnit ? "N" : "";
    load.total = file.read<double>(data + "/total", {3, 3});
    load.moment = file.read<double>(data + "/moment", {3, 3});
    load.residual = read_if_there(file, data + "/residual", on_surface);
    kernel.applied.push_back(std::move(load));
  }
  for (const std::string& name : read_names(file, "/names/motions")) {
    const std::string data = "/motions/" + name;
    kernel.motions.push_back({name, file.read<double>(data + "/participation", {3, n}),
                              file.read<double>(data + "/residual", on_surface),
                              file.read<double>(data + "/momentum", {3, 3})});
  }
  const std::size_t loads = kernel.applied.size(), motions = kernel.motions.size();
  for (const std::string& name : read_names(file, "/names/receivers")) {
    const std::string data = "/receiver_data/" + name;
    Receiver receiver;
    receiver.name = name;
    receiver.shape = file.read<double>("/receivers/" + name, {3, n});
    std::ranges::copy(file.read<double>(data + "/point", {3}), receiver.point.begin());
    receiver.residual_flexibility = read_if_there(file, data + "/residual_flexibility",
                                                  directed ? hdf5::Shape{3, m} : hdf5::Shape{3, m, 3});
    receiver.body_force_residual = read_if_there(file, data + "/body_force_residual", {3, 3});
    receiver.load_residual = read_if_there(file, data + "/load_residual", {3, loads, 3});
    receiver.motion_residual = read_if_there(file, data + "/motion_residual", {3, motions, 3});
    kernel.receivers.push_back(std::move(receiver));
  }
}

View read_view(const hdf5::Reader& file, const Kernel& kernel) {
  const std::size_t m = kernel.surface.size(), n = kernel.modes.size();
  View view;
  view.node = file.read<double>("/view/node", {any, 3});
  view.element = file.read<std::int64_t>("/view/element", {any, any});
  view.element_corners = corners_of(file, "/view/element");
  const std::size_t nodes = view.node.size() / 3;
  view.shape = file.read<float>("/view/shape", {nodes, 3, n});
  view.residual_flexibility =
      read_if_there<float>(file, "/view/residual_flexibility",
                           kernel.surface.direction ? hdf5::Shape{nodes, 3, m} : hdf5::Shape{nodes, 3, m, 3});
  view.body_force_residual = read_if_there<float>(file, "/view/body_force_residual", {nodes, 3, 3});
  view.load_residual =
      read_if_there<float>(file, "/view/load_residual", {nodes, 3, kernel.applied.size(), 3});
  view.motion_residual =
      read_if_there<float>(file, "/view/motion_residual", {nodes, 3, kernel.motions.size(), 3});
  return view;
}

}  // namespace

Kernel read(const std::filesystem::path& path, bool view) {
  const hdf5::Reader file(path, kAdvice);
  Kernel kernel;
  read_root(file, kernel);
  kernel.modes = read_modes(file);
  const std::size_t n = kernel.modes.size();
  kernel.surface = read_surface(file, n);
  kernel.loads = read_loads(file, kernel.surface, n);
  read_sources(file, kernel);
  if (view && file.exists("/view")) kernel.view = read_view(file, kernel);
  validate(kernel, path.string());
  return kernel;
}

std::optional<Header> read_header(const std::filesystem::path& path) noexcept {
  try {
    const hdf5::Reader file(path, kAdvice);
    if (!is_kernel(file) || file.integer_attribute("/", "version") > kVersion) return std::nullopt;
    Header header{file.string_attribute("/", "hash"), file.string_attribute("/", "scene"),
                  file.string_attribute("/", "mesh_sha256")};
    if (file.exists("/surface/whole")) header.held = file.read<std::int64_t>("/surface/whole/held", {any});
    return header;
  } catch (...) {
    return std::nullopt;
  }
}

std::string read_hash(const std::filesystem::path& path) noexcept {
  const auto header = read_header(path);
  return header ? header->hash : "";
}

bool has_newer_format(const std::filesystem::path& path) noexcept {
  try {
    const hdf5::Reader file(path, kAdvice);
    return is_kernel(file) && file.integer_attribute("/", "version") > kVersion;
  } catch (...) {
    return false;
  }
}

}  // namespace ricochet::kernels
