// SPDX-License-Identifier: BSD-2-Clause
// The components of the kernel of a body with loads, receivers and moving supports.
#pragma once

#include "src/mesh/partition.hpp"
#include "src/mesh/read.hpp"
#include "src/reduction/contact_basis.hpp"
#include "src/scene/request.hpp"
#include "src/surface/patches.hpp"
#include "src/surface/sources.hpp"
#include "src/surface/trace.hpp"
#include "tests/meshes.hpp"

namespace ricochet::test {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Point = Eigen::Vector3d;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline const Matrix3d gradient = (Matrix3d() << 0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.25, 0.6, -0.1).finished();
inline const Point offset(0.2, -0.4, 0.9);

/// Row-major values as a matrix with the given number of rows.
inline MatrixXd rows(const std::vector<double>& values, std::size_t count) {
  return Eigen::Map<const RowMajor>(values.data(), static_cast<Eigen::Index>(count),
                                    static_cast<Eigen::Index>(values.size() / count));
}

inline scene::Forcing load(const std::string& name, const std::string& group, const Vector3& at = {}) {
  scene::Forcing driven;
  driven.name = name;
  driven.group = group;
  driven.at = at;
  return driven;
}

inline scene::Receiver receiver(const std::string& name, const Vector3& at) { return {name, "body", at}; }

/// All components of a kernel.
struct Made {
  Made(const std::string& geo, int order, scene::KernelRequest asked, double poisson = 0.3)
      : request(std::move(asked)) {
    const SharedFile file(".geo", geo);
    scene::Body body = body_of(file.path(), order);
    body.contact = request.body.contact;
    body.support = request.body.support;
    body.rotate_deg = request.body.rotate_deg;
    body.translate = request.body.translate;
    body.scale = request.body.scale;
    body.materials[0].poisson = poisson;
    if (!request.body.materials.empty()) body.materials = request.body.materials;
    request.body = body;
    mesh::GlobalMesh global;
    const mesh::RequestedGroups wanted = surface::requested_groups(request);
    parallel::on_first_rank(PETSC_COMM_WORLD, [&] { global = mesh::read_mesh(body, {}, wanted); });
    mesh = mesh::distribute(std::move(global), PETSC_COMM_WORLD);
    std::vector<std::string> moved;
    for (const std::string& support : wanted.moved) moved.push_back(body.support.at(support));
    matrices = elasticity::assemble(mesh, body.materials, "test", {}, moved);
    sources = surface::make_sources(mesh, request);
    patches = surface::make_patches(mesh, body.contact, {.direction = request.direction});
  }

  /// The kernel with modes or with a contact-adapted basis.
  kernels::Kernel kernel(const modes::Request& wanted) {
    modes::Factorisation factor(matrices.stiffness, matrices.mass);
    modes::ModeSet set = modes::compute_modes(one_team(), mesh, matrices, factor, wanted);
    sources.lift = reduction::static_lift(one_team(), mesh, matrices, factor, set.static_shift);
    return trace(factor, set);
  }
  kernels::Kernel fitted_kernel(Hertz band) {
    modes::Factorisation factor(matrices.stiffness, matrices.mass);
    sources.lift =
        reduction::static_lift(one_team(), mesh, matrices, factor, reduction::shift_near_zero(band));
    const MatrixXd loads = surface::patch_loads(mesh, patches);
    MatrixXd all(loads.rows(), loads.cols() + sources.load.cols() + sources.lift.inertia.cols());
    all << loads, sources.load, sources.lift.inertia;
    return trace(factor, reduction::contact_basis(one_team(), mesh, matrices, factor, all, loads.cols(),
                                                  {.band = band, .flexibility_error = 1e-2}));
  }
  kernels::Kernel trace(modes::Factorisation& factor, const modes::ModeSet& set) {
    kernels::Kernel made;
    surface::trace(one_team(), mesh, matrices, factor, set, patches, surface::patch_loads(mesh, patches),
                   surface::Correction::all, false, made, sources);
    made.modes.angular_frequency = set.angular_frequency;
    return made;
  }
  /// The fields u = G x + o and −2 u at the nodes of this rank, used as modes.
  modes::ModeSet linear_fields() const {
    modes::ModeSet set;
    set.angular_frequency = {0, 0};
    set.index = {0, 1};
    set.shape.resize(matrices.local_rows, 2);
    for (std::size_t i = 0; i < mesh.node.size(); ++i) {
      const std::int64_t own = mesh.node[i] - mesh.first_node;
      if (own < 0 || own >= mesh.owned_nodes) continue;
      set.shape.block<3, 1>(3 * own, 0) = gradient * Point(&mesh.position[3 * i]) + offset;
    }
    set.shape.col(1) = -2 * set.shape.col(0);
    return set;
  }

  scene::KernelRequest request;
  mesh::GmshSession gmsh;
  mesh::Mesh mesh;
  elasticity::Body matrices;
  surface::Sources sources;
  surface::Patches patches;
};

inline scene::KernelRequest request_of(const std::vector<std::string>& contact,
                                       const std::map<std::string, std::string>& support) {
  scene::KernelRequest request;
  request.body.contact = contact;
  request.body.support = support;
  return request;
}

/// Σ seen_n acting_nᵀ/ω² over the elastic modes.
inline MatrixXd modal(const kernels::Kernel& kernel, const MatrixXd& seen, const MatrixXd& acting) {
  MatrixXd sum = MatrixXd::Zero(seen.rows(), acting.rows());
  for (std::size_t n = 0; n < kernel.modes.size(); ++n) {
    const double omega = kernel.modes.angular_frequency[n];
    const auto k = static_cast<Eigen::Index>(n);
    if (omega > 0) sum += seen.col(k) * acting.col(k).transpose() / (omega * omega);
  }
  return sum;
}

inline MatrixXd shape_of(const kernels::Kernel& kernel) {
  return rows(kernel.surface.shape, kernel.surface.size() * 3);
}

}  // namespace ricochet::test
