// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/snapshot_rows.hpp"

namespace ricochet::contact {
namespace {

std::span<const double> span_of(const Vector& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

}  // namespace

SnapshotRows::SnapshotRows(base::hdf5::Writer& file, const Model& model, bool turns,
                           std::span<const ObstacleSurface> obstacles)
    : model_(model),
      coordinates_(model),
      time_(file.rows("/snapshots/time", {}, "s")),
      obstacles_(file, obstacles, "/pose") {
  for (const Bodies::Block& body : model.bodies) {
    const kernels::Kernel& kernel = *body.kernel;
    Body& rows = bodies_.emplace_back();
    rows.modal = &file.rows("/snapshots/" + body.name, {static_cast<std::size_t>(body.modes)}, "kg^1/2 m");
    const std::string group = "/static/" + body.name;
    file.group(group);
    const Vector gravity = body.rotation.transpose() * model.gravity;
    file.attribute(group, "gravity", span_of(gravity));
    if (kernel.surface.has_flexibility()) {
      const auto components = static_cast<std::size_t>(kernel.surface.residual_components());
      rows.snapshot = &file.rows(group + "/snapshot", {}, "1");
      rows.candidate = &file.rows(group + "/candidate", {}, "1");
      rows.force = &file.rows(group + "/force", {components}, "N");
    }
    if (!kernel.applied.empty())
      rows.load = &file.rows(group + "/load", {kernel.applied.size(), 3}, "Pa or N");
    if (!kernel.motions.empty()) rows.motion = &file.rows(group + "/motion", {kernel.motions.size(), 3}, "m");
    if (turns) rows.pose.emplace(file, "/pose/" + body.name);
  }
}

void SnapshotRows::append(double time, const Vector& q, const Vector& p, const Turning* turning) {
  time_.append(time);
  obstacles_.append(time);
  coordinates_.set(time, q, p, turning);
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Body& rows = bodies_[k];
    const BodyCoordinates& at = coordinates_[k];
    if (turning) rows.pose->append(turning->poses[k]);
    rows.modal->append(span_of(at.modal));
    if (rows.force != nullptr)
      append_forces(rows, at.force, model_.bodies[k].kernel->surface.residual_components());
    if (rows.load != nullptr) rows.load->append(span_of(at.load));
    if (rows.motion != nullptr) rows.motion->append(span_of(at.motion));
  }
  ++count_;
}

void SnapshotRows::append_forces(const Body& rows, const Vector& force, Eigen::Index components) {
  for (Eigen::Index j = 0; j < force.size(); j += components) {
    const auto own = force.segment(j, components);
    if ((own.array() == 0).all()) continue;
    rows.snapshot->append(static_cast<double>(count_));
    rows.candidate->append(static_cast<double>(j / components));
    rows.force->append({own.data(), static_cast<std::size_t>(components)});
  }
}

}  // namespace ricochet::contact
