// SPDX-License-Identifier: BSD-2-Clause
#include "src/kernel/imported_modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kernels/algebra.hpp"
#include "src/kernel/candidates.hpp"
#include "src/mesh/body_file.hpp"
#include "src/mesh/extent.hpp"
#include "src/mesh/partition.hpp"
#include "src/reduction/residual.hpp"
#include "src/surface/trace.hpp"

namespace ricochet::kernel {

namespace {

using base::hdf5::any;
using base::hdf5::Reader;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Modes at all nodes of a body file. Rigid modes come first.
struct Imported {
  double mass = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  bool supported = false;
  Eigen::VectorXd omega, residual;  ///< (N) [rad/s]; [1]
  Eigen::MatrixXd shape;            ///< (3n,N) [kg^-1/2]
  Eigen::MatrixXd participation;    ///< (6,N) ΦᵀM e_i, ΦᵀM (e_i × x)
};

/// Reads a dataset of finite numbers as a matrix with so many rows. @param shape  shape in the file
Eigen::MatrixXd read_matrix(const Reader& file, const std::string& name, const base::hdf5::Shape& shape,
                            Eigen::Index rows) {
  const std::vector<double> values = file.read<double>(name, shape);
  if (!std::ranges::all_of(values, [](double x) { return std::isfinite(x); }))
    file.fail(fmt::format("dataset \"{}\" contains a number that is not finite.", name));
  return Eigen::Map<const RowMajor>(values.data(), rows, rows == 0 ? 0 : std::ssize(values) / rows);
}

void refuse_what_modes_fix(const scene::KernelRequest& request, const Reader& file) {
  const scene::Modes& modes = request.modes;
  if (modes.basis == scene::Basis::contact || modes.flexibility_error)
    file.fail("contains modes: a contact-adapted basis and modes.flexibility_error need matrices.");
  if (!request.body.support.empty() || !request.loads.motions.empty())
    file.fail(
        fmt::format("contains modes, which already include their supports: leave out bodies.{}.support and "
                    "moving supports.",
                    request.body.name));
}

Imported read_inertia(const Reader& file) {
  Imported body;
  body.mass = file.double_attribute("/", "mass");
  body.centre = Eigen::Map<const Eigen::Vector3d>(file.doubles_attribute("/", "centre", 3).data());
  body.inertia = Eigen::Map<const Eigen::Matrix3d>(file.doubles_attribute("/", "inertia", 9).data());
  body.supported = file.integer_attribute("/", "supported") != 0;
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(body.inertia).eigenvalues()[0];
  if (!(body.mass > 0) || !body.centre.allFinite() ||
      !body.inertia.isApprox(body.inertia.transpose(), 1e-9) || !(least > 0))
    file.fail(
        "attributes \"mass\", \"centre\" and \"inertia\" must be positive, finite, and symmetric and "
        "positive definite.");
  return body;
}

/// Adds three translations and three rotations about the principal axes, M-orthonormal.
void add_rigid_modes(const std::vector<double>& position, Imported& body) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(body.inertia);
  Eigen::MatrixXd shape(std::ssize(position), 6), participation = Eigen::MatrixXd::Zero(6, 6);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d e = Eigen::Vector3d::Unit(k) / std::sqrt(body.mass);
    const Eigen::Vector3d turn = principal.eigenvectors().col(k) / std::sqrt(principal.eigenvalues()[k]);
    for (Eigen::Index row = 0; row < shape.rows(); row += 3) {
      const Eigen::Vector3d x = Eigen::Map<const Eigen::Vector3d>(&position[static_cast<std::size_t>(row)]);
      shape.block<3, 1>(row, k) = e;
      shape.block<3, 1>(row, 3 + k) = turn.cross(x - body.centre);
    }
    participation.block<3, 1>(0, k) = body.mass * e;
    participation.block<3, 1>(3, k) = body.mass * body.centre.cross(e);
    participation.block<3, 1>(3, 3 + k) = body.inertia * turn;
  }
  const auto joined = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    Eigen::MatrixXd both(a.rows(), a.cols() + b.cols());
    both << a, b;
    return both;
  };
  body.shape = joined(shape, body.shape);
  body.participation = joined(participation, body.participation);
  body.omega = joined(Eigen::RowVectorXd::Zero(6), body.omega.transpose()).transpose();
  body.residual = joined(Eigen::RowVectorXd::Zero(6), body.residual.transpose()).transpose();
}

void keep_first(Imported& body, Eigen::Index count) {
  body.omega.conservativeResize(count);
  body.residual.conservativeResize(count);
  body.shape.conservativeResize(Eigen::NoChange, count);
  body.participation.conservativeResize(Eigen::NoChange, count);
}

/// Keeps the modes that the scene requests. A multiple mode at the end is kept whole.
void keep_wanted(const scene::Modes& wanted, const Reader& file, Imported& body) {
  const Eigen::Index all = body.omega.size();
  const double end = all > 0 ? body.omega[all - 1] : 0;
  if (wanted.count && *wanted.count > all)
    file.fail(
        fmt::format("has {} modes, rigid ones included, but modes.count requests {}.", all, *wanted.count));
  if (wanted.up_to && RadPerSecond(*wanted.up_to).value > end)
    file.fail(fmt::format("has modes up to {:.6g} Hz, but modes.up_to_hz requests {:.6g}.",
                          to_hertz(RadPerSecond{end}).value, wanted.up_to->value));
  Eigen::Index kept = wanted.count.value_or(0);
  if (wanted.up_to)
    kept = std::ranges::upper_bound(body.omega, RadPerSecond(*wanted.up_to).value) - body.omega.begin();
  else
    while (kept > 0 && kept < all &&
           std::pow(body.omega[kept], 2) < (1 + kernels::multiple_mode) * std::pow(body.omega[kept - 1], 2))
      ++kept;
  keep_first(body, kept);
}

Imported read_modes(const scene::KernelRequest& request, const Reader& file,
                    const std::vector<double>& position) {
  Imported body = read_inertia(file);
  const std::size_t nodes = position.size() / 3;
  const std::size_t n = file.shape("/modes/angular_frequency").front();
  body.omega = read_matrix(file, "/modes/angular_frequency", {n}, static_cast<Eigen::Index>(n));
  if (n == 0 || body.omega[0] < 0 || !std::ranges::is_sorted(body.omega))
    file.fail("dataset \"/modes/angular_frequency\" must ascend from 0 or more.");
  body.shape = read_matrix(file, "/modes/shape", {nodes, 3, n}, static_cast<Eigen::Index>(3 * nodes));
  body.residual =
      file.exists("/modes/residual")
          ? Eigen::VectorXd(read_matrix(file, "/modes/residual", {n}, static_cast<Eigen::Index>(n)))
          : Eigen::VectorXd::Ones(static_cast<Eigen::Index>(n));

  // Computed rigid modes have frequencies below this fraction of the lowest elastic one, due to round-off.
  constexpr double near_zero = 1e-3;
  const Eigen::Index seventh = std::min<Eigen::Index>(6, std::ssize(body.omega) - 1);
  const Eigen::Index rigid = (body.omega.array() <= near_zero * body.omega[seventh]).count();
  if (rigid != 0 && (body.supported || rigid != 6))
    file.fail(
        fmt::format("has {} modes near zero frequency: a supported body has none, a free one 6, which "
                    "may be left out.",
                    rigid));
  if (body.supported) {
    body.participation.resize(6, body.omega.size());
    body.participation << read_matrix(file, "/modes/body_force", {3, n}, 3),
        read_matrix(file, "/modes/rotation", {3, n}, 3);
  } else {
    body.omega = body.omega.tail(body.omega.size() - rigid).eval();
    body.residual = body.residual.tail(body.omega.size()).eval();
    body.shape = body.shape.rightCols(body.omega.size()).eval();
    // Elastic modes of a free body are orthogonal to its rigid motions.
    body.participation = Eigen::MatrixXd::Zero(6, body.omega.size());
    add_rigid_modes(position, body);
  }
  keep_wanted(request.modes, file, body);
  return body;
}

/// Static responses minus those of the modes. @param seen  (3n,b) unit forces at candidates and receivers
Eigen::MatrixXd residual_response(const Reader& file, const Imported& body, const Eigen::MatrixXd& seen,
                                  const Eigen::MatrixXd& load) {
  const auto n = static_cast<std::size_t>(seen.rows());
  if (!file.exists("/static/flexibility"))
    file.fail(
        "has no dataset \"/static/flexibility\", from which the residual flexibility follows: add it, or set "
        "modes.residual_flexibility = false.");
  const Eigen::MatrixXd flexibility = read_matrix(file, "/static/flexibility", {n, n}, seen.rows());
  if (!flexibility.isApprox(flexibility.transpose(), 1e-6))
    file.fail("dataset \"/static/flexibility\" is not symmetric.");
  const Eigen::Index b = seen.cols();
  Eigen::MatrixXd response(b, b + 3 + load.cols()), by_column(response.cols(), body.omega.size());
  const Eigen::MatrixXd moved = flexibility * seen;
  response.leftCols(b) = seen.transpose() * moved;
  response.middleCols(b, 3).setZero();
  if (body.supported)
    response.middleCols(b, 3) =
        seen.transpose() * read_matrix(file, "/static/body_force", {n, 3}, seen.rows());
  response.rightCols(load.cols()) = moved.transpose() * load;
  by_column << seen.transpose() * body.shape, body.participation.topRows(3), load.transpose() * body.shape;
  const Eigen::VectorXd compliance =
      body.omega.unaryExpr([](double omega) { return omega > 0 ? 1 / (omega * omega) : 0; });
  response -= by_column.topRows(b) * compliance.asDiagonal() * by_column.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> left(response.leftCols(b), Eigen::EigenvaluesOnly);
  const double whole = moved.cwiseProduct(seen).colwise().sum().maxCoeff();
  if (b > 0 && left.eigenvalues()[0] < -1e-6 * whole)
    file.fail(
        "dataset \"/static/flexibility\" is smaller than the flexibility of the modes: for a free body, "
        "subtract rigid inertia from the loads and rigid motion from the displacements; shapes must be "
        "mass-normalised.");
  return response;
}

void add_view(const mesh::Mesh& mesh, const Imported& body, kernels::Kernel& kernel) {
  kernels::View view;
  view.node = mesh.visualisation.position;
  view.element = mesh.visualisation.blocks.front().node;
  for (const std::int64_t node : mesh.visualisation.node)
    for (Eigen::Index k = 0; k < 3; ++k)
      for (Eigen::Index n = 0; n < body.omega.size(); ++n)
        view.shape.push_back(static_cast<float>(body.shape(3 * node + k, n)));
  kernel.view = std::move(view);
}

kernels::Kernel kernel_on_one_rank(const scene::KernelRequest& request) {
  const Reader file = mesh::open_body_file(request.body.mesh);
  refuse_what_modes_fix(request, file);
  const mesh::Mesh mesh =
      mesh::distribute(mesh::read_body_file(request.body, surface::requested_groups(request)), MPI_COMM_SELF);
  surface::Patches patches = patches_of(request, mesh);
  if (request.points) surface::restrict_to(patches, *request.points);
  const surface::Sources sources = surface::make_sources(mesh, request);
  const Eigen::MatrixXd loads = surface::patch_loads(mesh, patches);
  const Imported body = read_modes(request, file, mesh.position);

  kernels::Kernel kernel;
  kernel.body = request.body.name;
  kernel.hash = request.hash;
  kernel.scene = request.toml;
  kernel.mesh_sha256 = request.mesh_sha256;
  kernel.created_by = "ricochet-kernel " RICOCHET_VERSION;
  kernel.dofs = 3 * mesh.total_nodes;
  kernel.order = mesh.order;
  kernel.mass = body.mass;
  Eigen::Map<Eigen::Vector3d>(kernel.centre.data()) = body.centre;
  Eigen::Map<Eigen::Matrix3d>(kernel.inertia.data()) = body.inertia;
  kernel.supported = body.supported;
  kernel.outline = mesh::outline_of(mesh);
  kernel.modes.basis = "imported";
  kernel.modes.angular_frequency.assign(body.omega.begin(), body.omega.end());
  kernel.modes.residual.assign(body.residual.begin(), body.residual.end());
  kernel.modes.decay_rate = kernels::decay_rates(request.body.damping, kernel.modes.angular_frequency);
  kernel.modes.certificate.count_found = body.omega.size();
  kernel.modes.certificate.upto_hz =
      request.modes.up_to ? request.modes.up_to->value
                          : to_hertz(RadPerSecond{body.omega.size() > 0 ? body.omega.tail(1)[0] : 0}).value;
  surface::take_traces(patches,
                       {loads.transpose() * body.shape, body.participation,
                        sources.load.transpose() * body.shape, sources.receiver.transpose() * body.shape},
                       sources, kernel);
  if (request.modes.residual_flexibility) {
    kernel.surface.normal_residual = request.normal_residual;
    const Eigen::MatrixXd pressed =
        request.normal_residual
            ? Eigen::MatrixXd(surface::along_normals(loads.sparseView(), patches.geometry))
            : loads;
    Eigen::MatrixXd seen(loads.rows(), pressed.cols() + sources.receiver.cols());
    seen << pressed, sources.receiver;
    surface::take_corrections(residual_response(file, body, seen, sources.load), pressed.cols(), sources,
                              kernel);
  }
  if (request.turns) kernel = kernels::compacted(std::move(kernel));
  if (request.view) add_view(mesh, body, kernel);
  return kernel;
}

}  // namespace

bool holds_modes(const scene::Body& body, MPI_Comm comm) {
  bool found = false;
  parallel::on_first_rank(comm, [&] { found = mesh::open_body_file(body.mesh).exists("/modes"); });
  return parallel::of_rank(comm, 0, found);
}

kernels::Kernel kernel_of_modes(const scene::KernelRequest& request, MPI_Comm comm,
                                console::Console& console) {
  kernels::Kernel kernel;
  console.begin(request.body.name + ": modes from its file");
  parallel::on_first_rank(comm, [&] { kernel = kernel_on_one_rank(request); });
  console.end(fmt::format("{} modes, not proved to be all", kernel.modes.size()));
  return kernel;
}

}  // namespace ricochet::kernel
