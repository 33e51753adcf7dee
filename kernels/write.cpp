// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/write.hpp"
#include "base/hdf5_writer.hpp"
#include "kernels/format.hpp"
#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

namespace hdf5 = base::hdf5;
namespace {

void write_root(hdf5::Writer& file, const Kernel& kernel) {
  file.attribute("/", "format", kFormat);
  file.attribute("/", "version", kVersion);
  file.attribute("/", "body", kernel.body);
  file.attribute("/", "hash", kernel.hash);
  file.attribute("/", "scene", kernel.scene);
  file.attribute("/", "mesh_sha256", kernel.mesh_sha256);
  file.attribute("/", "created_by", kernel.created_by);
  file.attribute("/", "dofs", kernel.dofs);
  file.attribute("/", "elements", kernel.elements);
  file.attribute("/", "order", kernel.order);
  file.attribute("/", "mass", kernel.mass);
  file.attribute("/", "supported", kernel.supported);
  file.write<double>("/body/centre", kernel.centre, {3}, "m");
  file.write<double>("/body/inertia", kernel.inertia, {3, 3}, "kg m^2");
}

void write_modes(hdf5::Writer& file, const Modes& modes) {
  const hdf5::Shape n = {modes.size()};
  file.write("/modes/angular_frequency", modes.angular_frequency, n, "rad/s");
  file.write("/modes/decay_rate", modes.decay_rate, n, "1/s");
  file.write("/modes/residual", modes.residual, n, "1");
  file.attribute("/modes", "basis", modes.basis);
  const std::string certificate = "/modes/certificate";
  file.group(certificate);
  file.attribute(certificate, "below", modes.certificate.below);
  file.attribute(certificate, "upto_hz", modes.certificate.upto_hz);
  file.attribute(certificate, "count_by_inertia", modes.certificate.count_by_inertia);
  file.attribute(certificate, "count_found", modes.certificate.count_found);
  file.attribute(certificate, "left_out", modes.certificate.left_out);
  file.attribute(certificate, "complete", modes.certificate.complete);
  file.attribute(certificate, "orthonormality", modes.certificate.orthonormality);
  file.attribute(certificate, "flexibility_error", modes.certificate.flexibility_error);
  if (modes.certificate.approximate > 0)
    file.attribute(certificate, "approximate", modes.certificate.approximate);
}

void write_whole(hdf5::Writer& file, const WholeSurface& whole) {
  const std::size_t w = whole.area.size(), corners = static_cast<std::size_t>(whole.element_corners);
  const std::string group = "/surface/whole";
  file.write(group + "/node", whole.node, {w, 3}, "m");
  if (!whole.centroid.empty()) file.write(group + "/centroid", whole.centroid, {w, 3}, "m");
  file.write(group + "/normal", whole.normal, {w, 3}, "1");
  file.write(group + "/area", whole.area, {w}, "m^2");
  file.write(group + "/element", whole.element, {whole.element.size() / corners, corners}, "1");
  file.write(group + "/held", whole.held, {whole.held.size()}, "1");
}

void write_surface(hdf5::Writer& file, const Surface& surface, std::size_t n) {
  const std::size_t m = surface.size(), rows = static_cast<std::size_t>(surface.components) * m;
  const std::size_t corners = static_cast<std::size_t>(surface.element_corners);
  const bool directed = surface.direction.has_value();
  file.write("/surface/node", surface.node, {m, 3}, "m");
  if (!surface.centroid.empty()) file.write("/surface/centroid", surface.centroid, {m, 3}, "m");
  file.write_strings("/surface/group", surface.group);
  file.write("/surface/normal", surface.normal, {m, 3}, "1");
  file.write("/surface/area", surface.area, {m}, "m^2");
  file.write("/surface/element", surface.element, {surface.element.size() / corners, corners}, "1");
  file.write("/surface/shape", surface.shape, directed ? hdf5::Shape{m, n} : hdf5::Shape{m, 3, n}, "kg^-1/2");
  if (directed) file.attribute("/surface/shape", "direction", *surface.direction);
  if (!surface.residual_flexibility.empty())
    file.write("/surface/residual_flexibility", surface.residual_flexibility, {rows, rows}, "m/N");
  if (surface.whole) write_whole(file, *surface.whole);
}

void write_loads(hdf5::Writer& file, const Kernel& kernel) {
  const std::size_t m = kernel.surface.size(), n = kernel.modes.size();
  const hdf5::Shape residual = kernel.surface.direction ? hdf5::Shape{m, 3} : hdf5::Shape{m, 3, 3};
  file.write("/loads/body_force", kernel.loads.body_force, {3, n}, "kg^1/2");
  file.write("/loads/rotation", kernel.loads.rotation, {3, n}, "kg^1/2 m");
  if (!kernel.loads.body_force_residual.empty())
    file.write("/loads/body_force_residual", kernel.loads.body_force_residual, residual, "s^2");
}

template <class Item>
void write_names(hdf5::Writer& file, const std::string& dataset, const std::vector<Item>& items) {
  std::vector<std::string> names;
  for (const Item& item : items) names.push_back(item.name);
  if (!names.empty()) file.write_strings(dataset, names);
}

/// Writes a dataset unless it is empty.
template <hdf5::Element T>
void write_some(hdf5::Writer& file, const std::string& dataset, const std::vector<T>& values,
                const hdf5::Shape& shape, const std::string& unit) {
  if (!values.empty()) file.write(dataset, values, shape, unit);
}

void write_sources(hdf5::Writer& file, const Kernel& kernel) {
  const std::size_t m = kernel.surface.size(), n = kernel.modes.size();
  const bool directed = kernel.surface.direction.has_value();
  const hdf5::Shape on_surface = directed ? hdf5::Shape{m, 3} : hdf5::Shape{m, 3, 3};
  write_names(file, "/names/loads", kernel.applied);
  write_names(file, "/names/motions", kernel.motions);
  write_names(file, "/names/receivers", kernel.receivers);
  for (const Load& load : kernel.applied) {
    const bool traction = load.unit == "Pa";
    const std::string data = "/load_data/" + load.name;
    file.write("/loads/" + load.name, load.participation, {3, n}, traction ? kTractionUnit : kForceUnit);
    file.write(data + "/total", load.total, {3, 3}, traction ? "m^2" : "1");
    file.write(data + "/moment", load.moment, {3, 3}, traction ? "m^3" : "m");
    write_some(file, data + "/residual", load.residual, on_surface, "m/" + load.unit);
  }
  for (const Motion& motion : kernel.motions) {
    const std::string data = "/motions/" + motion.name;
    file.write(data + "/participation", motion.participation, {3, n}, "kg^1/2");
    file.write(data + "/residual", motion.residual, on_surface, "1");
    file.write(data + "/momentum", motion.momentum, {3, 3}, "kg");
  }
  const std::size_t loads = kernel.applied.size(), motions = kernel.motions.size();
  for (const Receiver& receiver : kernel.receivers) {
    const std::string data = "/receiver_data/" + receiver.name;
    file.write("/receivers/" + receiver.name, receiver.shape, {3, n}, "kg^-1/2");
    file.write<double>(data + "/point", receiver.point, {3}, "m");
    write_some(file, data + "/residual_flexibility", receiver.residual_flexibility,
               directed ? hdf5::Shape{3, m} : hdf5::Shape{3, m, 3}, "m/N");
    write_some(file, data + "/body_force_residual", receiver.body_force_residual, {3, 3}, "s^2");
    write_some(file, data + "/load_residual", receiver.load_residual, {3, loads, 3},
               "m per unit of the load");
    write_some(file, data + "/motion_residual", receiver.motion_residual, {3, motions, 3}, "1");
  }
}

void write_view(hdf5::Writer& file, const Kernel& kernel) {
  const View& view = *kernel.view;
  const std::size_t m = kernel.surface.size(), nodes = view.node.size() / 3,
                    corners = static_cast<std::size_t>(view.element_corners);
  file.write("/view/node", view.node, {nodes, 3}, "m");
  file.write("/view/element", view.element, {view.element.size() / corners, corners}, "1");
  file.write("/view/shape", view.shape, {nodes, 3, kernel.modes.size()}, "kg^-1/2");
  write_some(file, "/view/residual_flexibility", view.residual_flexibility,
             kernel.surface.direction ? hdf5::Shape{nodes, 3, m} : hdf5::Shape{nodes, 3, m, 3}, "m/N");
  write_some(file, "/view/body_force_residual", view.body_force_residual, {nodes, 3, 3}, "s^2");
  write_some(file, "/view/load_residual", view.load_residual, {nodes, 3, kernel.applied.size(), 3},
             "m per unit of the load");
  write_some(file, "/view/motion_residual", view.motion_residual, {nodes, 3, kernel.motions.size(), 3}, "1");
}

}  // namespace

void write(const Kernel& kernel, const std::filesystem::path& path) {
  validate(kernel, path.string());
  hdf5::Writer file(path);
  write_root(file, kernel);
  write_modes(file, kernel.modes);
  write_surface(file, kernel.surface, kernel.modes.size());
  write_loads(file, kernel);
  write_sources(file, kernel);
  if (kernel.view) write_view(file, kernel);
  file.commit();
}

}  // namespace ricochet::kernels
