// SPDX-License-Identifier: BSD-2-Clause
// The kernel file (docs/formats/kernel.md): its attributes and datasets, listed once for the writer, the
// reader and the validation.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

inline constexpr const char* kFormat = "ricochet-kernel";
inline constexpr std::int64_t kVersion = 3;

/// Group of the residual flexibility that is compressed. Such files have version 3, others version 2, because
/// a reader of version 2 would take the body for one without residual flexibility.
inline constexpr const char* kCompressed = "/surface/compressed_flexibility";

/// Unit of the participation of a load, from which the reader recognises the kind of load.
inline constexpr const char* kTractionUnit = "kg^-1/2 m^2";
inline constexpr const char* kForceUnit = "kg^-1/2";

/// Attribute of the residual flexibility that is stored along the normals, and its value.
inline constexpr const char* kComponents = "components";
inline constexpr const char* kNormal = "normal";
inline constexpr const char* kActs = "acts";  // of a load that is a pressure
inline constexpr const char* kInward = "inward";

using Shape = std::vector<std::size_t>;

/// The lengths of `front`, then those of `back`.
inline Shape joined(Shape front, const Shape& back) {
  front.insert(front.end(), back.begin(), back.end());
  return front;
}

/// The lengths of `front`, then 3 for the components unless there is only one, then the lengths of `back`.
inline Shape over_components(const Surface& surface, Shape front, const Shape& back = {}) {
  if (!surface.direction) front.push_back(3);
  return joined(front, back);
}

/// The same for static corrections, which may be stored along the normals alone.
inline Shape over_residual(const Surface& surface, Shape front, const Shape& back = {}) {
  if (surface.residual_components() > 1) front.push_back(3);
  return joined(front, back);
}

// Below, `file` is a writer, a reader or a validator with these functions:
//   attribute(object, name, value), dataset(name, values, shape, unit)
//   optional_attribute, optional_dataset     absent if the value is 0, or the dataset is empty
//   group(name)                              a group that has attributes before it has datasets
//   strings(name, values, length)
//   elements(name, element, corners, fewest corners, number of nodes)
//   names(kind, items)                       the names of all loads, motions, receivers or gauges
//   choose(group, optional)                  a reader sets a value that the file holds
//   rows(dataset, values, width)             returns the first length of a dataset
//   constant(object, name, value)            an attribute that only a writer handles

void list_root(auto& file, auto& kernel) {
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
  file.dataset("/body/centre", kernel.centre, {3}, "m");
  file.dataset("/body/inertia", kernel.inertia, {3, 3}, "kg m^2");
  file.optional_attribute("/", "parts", kernel.parts);
  file.optional_attribute("/", "held_on_lines", kernel.held_on_lines);
  const std::size_t outline = file.rows("/body/outline", kernel.outline, 3);
  file.optional_dataset("/body/outline", kernel.outline, {outline, 3}, "m");
  const std::size_t pieces = file.rows("/body/piece_elements", kernel.piece_elements, 1);
  file.optional_dataset("/body/piece_elements", kernel.piece_elements, {pieces}, "1");
  file.optional_dataset("/body/piece_box", kernel.piece_box, {pieces, 2, 3}, "m");
}

void list_modes(auto& file, auto& modes) {
  const std::size_t n = file.rows("/modes/angular_frequency", modes.angular_frequency, 1);
  file.dataset("/modes/angular_frequency", modes.angular_frequency, {n}, "rad/s");
  file.dataset("/modes/decay_rate", modes.decay_rate, {n}, "1/s");
  file.dataset("/modes/residual", modes.residual, {n}, "1");
  file.optional_dataset("/modes/stiffness_error", modes.stiffness_error, {n, n}, "1");
  file.attribute("/modes", "basis", modes.basis);
  const std::string group = "/modes/certificate";
  auto& certificate = modes.certificate;
  file.group(group);
  file.attribute(group, "below", certificate.below);
  file.attribute(group, "upto_hz", certificate.upto_hz);
  file.attribute(group, "count_by_inertia", certificate.count_by_inertia);
  file.attribute(group, "count_found", certificate.count_found);
  file.attribute(group, "left_out", certificate.left_out);
  file.attribute(group, "complete", certificate.complete);
  file.attribute(group, "orthonormality", certificate.orthonormality);
  file.attribute(group, "flexibility_error", certificate.flexibility_error);
  const std::size_t shifts = file.rows(group + "/shift", certificate.shift, 1);
  file.optional_dataset(group + "/shift", certificate.shift, {shifts}, "rad^2/s^2");
  file.optional_dataset(group + "/modes_below", certificate.modes_below, {shifts}, "1");
  const std::size_t pairs = file.rows("/modes/coriolis_pair", modes.coriolis.pair, 2);
  file.optional_dataset("/modes/coriolis_pair", modes.coriolis.pair, {pairs, 2}, "1");
  file.optional_dataset("/modes/coriolis_coupling", modes.coriolis.coupling, {pairs, 3}, "1");
}

/// @param surface  Surface or WholeSurface
void list_candidates(auto& file, const std::string& group, auto& surface) {
  const std::size_t m = file.rows(group + "/area", surface.area, 1);
  file.dataset(group + "/node", surface.node, {m, 3}, "m");
  file.optional_dataset(group + "/centroid", surface.centroid, {m, 3}, "m");
  file.optional_dataset(group + "/bulge", surface.bulge, {m}, "m");
  if constexpr (requires { surface.group; }) file.strings(group + "/group", surface.group, m);
  file.dataset(group + "/normal", surface.normal, {m, 3}, "1");
  file.dataset(group + "/area", surface.area, {m}, "m^2");
  file.elements(group + "/element", surface.element, surface.element_corners, 1, m);
  const auto corners = static_cast<std::size_t>(std::max(surface.element_corners, 1));
  file.optional_dataset(group + "/element_normal", surface.element_normal,
                        {surface.element.size() / corners, corners, 3}, "1");
}

/// @param m  number of candidates
void list_compressed(auto& file, auto& compact, std::size_t m) {
  const std::string group = kCompressed;
  const std::size_t near = file.rows(group + "/near_candidate", compact.near_candidate, 1);
  file.group(group);
  file.attribute(group, "error", compact.error);
  file.attribute(group, "columns", compact.columns);
  file.dataset(group + "/global", compact.global, {3 * m, static_cast<std::size_t>(compact.columns)},
               "m^1/2 N^-1/2");
  file.dataset(group + "/near_first", compact.near_first, {m + 1}, "1");
  file.dataset(group + "/near_candidate", compact.near_candidate, {near}, "1");
  file.dataset(group + "/near_block", compact.near_block, {near, 3, 3}, "m/N");
}

void list_surface(auto& file, auto& surface, std::size_t n) {
  list_candidates(file, "/surface", surface);
  const std::size_t m = surface.size(), rows = static_cast<std::size_t>(surface.residual_components()) * m;
  file.dataset("/surface/shape", surface.shape, over_components(surface, {m}, {n}), "kg^-1/2");
  if (surface.direction) file.attribute("/surface/shape", "direction", *surface.direction);
  file.optional_dataset("/surface/mesh_error", surface.mesh_error, {m}, "m/N");
  file.optional_attribute("/surface", "mesh_error_coupling", surface.mesh_error_coupling);
  const std::string flexibility = "/surface/residual_flexibility";
  if (!surface.compact) {
    file.optional_dataset(flexibility, surface.residual_flexibility, {rows, rows}, "m/N");
  } else {
    file.optional_dataset(flexibility, surface.compact->whole, {rows, rows}, "m/N");
    if (surface.compact->compressed()) list_compressed(file, *surface.compact, m);
  }
  if (surface.normal_residual) file.constant(flexibility, kComponents, kNormal);
  if (!surface.whole) return;
  list_candidates(file, "/surface/whole", *surface.whole);
  file.dataset("/surface/whole/held", surface.whole->held, {m}, "1");
}

/// Static corrections of a receiver or the visualisation surface. @param at  shape of its displacement
void list_residuals(auto& file, const std::string& group, auto& seen, const Shape& at, auto& kernel) {
  const std::size_t m = kernel.surface.size(), loads = kernel.applied.size(), motions = kernel.motions.size();
  file.optional_dataset(group + "/residual_flexibility", seen.residual_flexibility,
                        over_residual(kernel.surface, joined(at, {m})), "m/N");
  file.optional_dataset(group + "/body_force_residual", seen.body_force_residual, joined(at, {3}), "s^2");
  file.optional_dataset(group + "/load_residual", seen.load_residual, joined(at, {loads, 3}),
                        "m per unit of the load");
  file.optional_dataset(group + "/motion_residual", seen.motion_residual, joined(at, {motions, 3}), "1");
}

/// A quantity of a gauge or of the visualisation surface. @param rows  its shape  @param unit  of the
/// quantity
void list_sensitivity(auto& file, const std::string& group, auto& seen, const Shape& rows,
                      const std::string& unit, auto& kernel) {
  const std::size_t m = kernel.surface.size(), n = kernel.modes.size(), loads = kernel.applied.size(),
                    motions = kernel.motions.size();
  file.dataset(group + "/shape", seen.shape, joined(rows, {n}), unit + " kg^-1/2 m^-1");
  file.optional_dataset(group + "/residual_flexibility", seen.residual_flexibility,
                        over_residual(kernel.surface, joined(rows, {m})), unit + "/N");
  file.optional_dataset(group + "/body_force_residual", seen.body_force_residual, joined(rows, {3}),
                        unit + " s^2/m");
  file.optional_dataset(group + "/load_residual", seen.load_residual, joined(rows, {loads, 3}),
                        unit + " per unit of the load");
  file.optional_dataset(group + "/motion_residual", seen.motion_residual, joined(rows, {motions, 3}),
                        unit + "/m");
}

/// Gravity, loads with histories, motions of supports, receivers and gauges.
void list_sources(auto& file, auto& kernel) {
  const std::size_t m = kernel.surface.size(), n = kernel.modes.size();
  const Shape on_surface = over_components(kernel.surface, {m}, {3}),
              static_part = over_residual(kernel.surface, {m}, {3});
  file.dataset("/loads/body_force", kernel.loads.body_force, {3, n}, "kg^1/2");
  file.dataset("/loads/rotation", kernel.loads.rotation, {3, n}, "kg^1/2 m");
  file.optional_dataset("/loads/body_force_residual", kernel.loads.body_force_residual, static_part, "s^2");
  file.names("loads", kernel.applied);
  file.names("motions", kernel.motions);
  file.names("receivers", kernel.receivers);
  file.names("gauges", kernel.gauges);
  for (auto& load : kernel.applied) {
    const bool traction = load.unit == "Pa";
    const std::string data = "/load_data/" + load.name;
    file.dataset("/loads/" + load.name, load.participation, {3, n}, traction ? kTractionUnit : kForceUnit);
    file.dataset(data + "/total", load.total, {3, 3}, traction ? "m^2" : "1");
    file.dataset(data + "/moment", load.moment, {3, 3}, traction ? "m^3" : "m");
    file.optional_dataset(data + "/residual", load.residual, static_part, "m/" + load.unit);
    if (load.inward) file.constant("/loads/" + load.name, kActs, kInward);
  }
  for (auto& motion : kernel.motions) {
    const std::string data = "/motions/" + motion.name;
    file.dataset(data + "/participation", motion.participation, {3, n}, "kg^1/2");
    file.dataset(data + "/residual", motion.residual, on_surface, "1");
    file.dataset(data + "/momentum", motion.momentum, {3, 3}, "kg");
  }
  for (auto& receiver : kernel.receivers) {
    const std::string data = "/receiver_data/" + receiver.name;
    file.dataset("/receivers/" + receiver.name, receiver.shape, {3, n}, "kg^-1/2");
    file.dataset(data + "/point", receiver.point, {3}, "m");
    list_residuals(file, data, receiver, {3}, kernel);
  }
  for (auto& gauge : kernel.gauges) {
    const std::string data = "/gauges/" + gauge.name;
    file.dataset(data + "/point", gauge.point, {3}, "m");
    list_sensitivity(file, data + "/stress", gauge.stress, {stress_rows}, "Pa", kernel);
    file.choose(data + "/strain", gauge.strain);
    if (gauge.strain) list_sensitivity(file, data + "/strain", *gauge.strain, {1}, "1", kernel);
  }
}

/// Lists a whole kernel. A reader must first set `direction`, `normal_residual`, `whole` and
/// `view` if the file contains them.
void list_kernel(auto& file, auto& kernel) {
  list_root(file, kernel);
  list_modes(file, kernel.modes);
  list_surface(file, kernel.surface, kernel.modes.size());
  list_sources(file, kernel);
  if (!kernel.view) return;
  auto& view = *kernel.view;
  const std::size_t nodes = file.rows("/view/node", view.node, 3);
  file.dataset("/view/node", view.node, {nodes, 3}, "m");
  file.elements("/view/element", view.element, view.element_corners, 2, nodes);
  file.dataset("/view/shape", view.shape, {nodes, 3, kernel.modes.size()}, "kg^-1/2");
  list_residuals(file, "/view", view, {nodes, 3}, kernel);
  file.choose("/view/stress", view.stress);
  if (view.stress) list_sensitivity(file, "/view/stress", *view.stress, {nodes, stress_rows}, "Pa", kernel);
}

}  // namespace ricochet::kernels
