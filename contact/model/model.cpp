// SPDX-License-Identifier: BSD-2-Clause
#include "contact/model/model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/format.hpp"
#include "contact/model/forcing.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// Share of the kinetic energy of a rigid velocity that the rigid modes may miss because of round-off in the
/// eigensolver.
constexpr double rigid_slack = 1e-6;

/// Cosine of the angle up to which faces that meet are one smooth face, as those of the kernels are.
const double smooth = std::cos(29 * std::numbers::pi / 180);

/// Loads of a kernel as (3,N).
auto three_rows(const std::vector<double>& values, int modes) {
  return Eigen::Map<const Matrix>(values.data(), 3, modes);
}

Model::BodyBlock block_of(const PlacedBody& body, int first_mode, const Vector3d& gravity) {
  const kernels::Kernel& kernel = *body.kernel;
  Model::BodyBlock block;
  block.name = body.name;
  block.first_mode = first_mode;
  block.modes = static_cast<int>(kernel.modes.size());
  block.mass = kernel.mass;
  block.centre = body.rotation * Eigen::Map<const Vector3d>(kernel.centre.data()) + body.translation;
  const Eigen::Matrix3d inertia =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(kernel.inertia.data());
  block.inertia = body.rotation * inertia * body.rotation.transpose();
  // p = ∫ρ v,  L = ∫ρ (Q x + t) × Q v = Q ∫ρ x × v + t × p
  block.momentum = body.rotation * three_rows(kernel.loads.body_force, block.modes);
  block.angular_momentum = body.rotation * three_rows(kernel.loads.rotation, block.modes);
  for (int n = 0; n < block.modes; ++n)
    block.angular_momentum.col(n) += body.translation.cross(Vector3d(block.momentum.col(n)));
  block.supported = kernel.supported;
  block.weight = kernel.mass * gravity;
  block.kernel = body.kernel;
  block.rotation = body.rotation;
  block.translation = body.translation;
  return block;
}

/// v_n = φ_nᵀ M v for the modes with ω_n = 0, of a velocity or a displacement v. This is exact, because these
/// modes span the rigid motions that the supports leave free.
/// @param momentum  (3,modes) of each mode along and about the axes; @param velocity  along or about them
/// @param energy  twice the kinetic energy of the rigid motion
Vector rigid_rates(const PlacedBody& body, const Model::BodyBlock& block,
                   const Eigen::Matrix<double, 3, Eigen::Dynamic>& momentum, const Vector3d& velocity,
                   double energy, const char* key) {
  Vector out = Vector::Zero(block.modes);
  if (velocity.isZero(0)) return out;
  for (int n = 0; n < block.modes; ++n)
    if (body.kernel->modes.angular_frequency[n] == 0) out(n) = momentum.col(n).dot(velocity);
  if (!(energy > 0) || std::abs(out.squaredNorm() - energy) > rigid_slack * energy)
    throw InputError(base::format(
        "bodies.{}.{}: {} cannot move rigidly that way ({:.3g} of the kinetic energy is in its rigid "
        "modes). {}",
        body.name, key, block.supported ? "a supported body" : "this body",
        energy > 0 ? out.squaredNorm() / energy : 0,
        block.supported
            ? base::format("Set {} = [0, 0, 0], or take its support out.", key)
            : "A rod moves along its axis alone; otherwise compute its kernel again with ricochet-kernel."));
  return out;
}

/// The modal rates of the initial velocity V of the centre and the angular velocity ω about it:
/// v(x) = V + ω × (x − c), φ_nᵀ M v = V·p_n + ω·(L_n − c × p_n)
Vector rigid_velocity(const PlacedBody& body, const Model::BodyBlock& block) {
  const Vector3d &V = body.velocity, &w = body.angular_velocity;
  Eigen::Matrix<double, 3, Eigen::Dynamic> about = block.angular_momentum;
  for (int n = 0; n < block.modes; ++n) about.col(n) -= block.centre.cross(Vector3d(block.momentum.col(n)));
  return rigid_rates(body, block, block.momentum, V, block.mass * V.squaredNorm(), "velocity") +
         rigid_rates(body, block, about, w, w.dot(block.inertia * w), "angular_velocity");
}

/// q0_n = f_n/ω_n²
Vector static_coordinates(const Model& model) {
  Vector force = model.load;
  for (const Model::Forcing& one : model.forcing)
    if (!one.support && one.history.dead())
      force.segment(one.first_mode, one.force.size()) += one.history.at(0) * one.force;
  return (model.omega.array() > 0).select(force.array() / model.omega.array().square(), 0.0);
}

/// Index in the kernel of each candidate of the whole surface, or −1. Empty if the kernel contains all
/// candidates.
std::vector<int> held_candidates(const kernels::Surface& surface) {
  if (!surface.whole) return {};
  std::vector<int> out(surface.whole->area.size(), -1);
  for (std::size_t i = 0; i < surface.whole->held.size(); ++i)
    out[surface.whole->held[i]] = static_cast<int>(i);
  return out;
}

[[noreturn]] void refuse_missing(const PlacedBody& body, const PairRequest& request, int candidate) {
  throw InputError(base::format(
      "contact between \"{}\" and \"{}\": the kernel of \"{}\" holds too few candidates: candidate {} of "
      "{}, which faces \"{}\", is missing. Run ricochet-kernel for this scene, or lower contact.reach or "
      "contact.zone.",
      request.a, request.b, body.name, candidate, body.kernel->surface.whole->area.size(),
      body.name == request.a ? request.b : request.a));
}

[[noreturn]] void refuse_tilt(const PlacedBody& body, const PairRequest& request, double cosine) {
  throw InputError(base::format(
      "contact between \"{}\" and \"{}\": the kernel of \"{}\" holds the residual flexibility along its own "
      "normals alone, but a pair is tilted by {:.2g} degrees. Run ricochet-kernel for this scene, or set "
      "modes.residual_components = \"all\".",
      request.a, request.b, body.name, std::acos(cosine) * 180 / std::numbers::pi));
}

[[noreturn]] void refuse_normals(const PlacedBody& body, const PairRequest& request) {
  throw InputError(
      base::format("contact between \"{}\" and \"{}\": friction needs all components, but the kernel of "
                   "\"{}\" holds {}. Run "
                   "ricochet-kernel for this scene, or leave contact.friction out.",
                   request.a, request.b, body.name,
                   body.kernel->surface.direction ? "the motion along one direction alone"
                                                  : "the residual flexibility along its normals alone"));
}

/// How many smooth faces meet at each candidate of the whole surface.
std::vector<int> faces_at(const kernels::Surface& surface) {
  const auto count = [](std::size_t candidates, const std::vector<std::int64_t>& element,
                        const std::vector<double>& element_normal) {
    std::vector<std::vector<Vector3d>> seen(candidates);
    for (std::size_t k = 0; 3 * k < element_normal.size(); ++k) {
      const Vector3d n = Eigen::Map<const Vector3d>(&element_normal[3 * k]);
      auto& here = seen[static_cast<std::size_t>(element[k])];
      if (std::ranges::none_of(here, [&](const Vector3d& other) { return other.dot(n) > smooth; }))
        here.push_back(n);
    }
    std::vector<int> out;
    for (const auto& here : seen) out.push_back(std::max(1, static_cast<int>(here.size())));
    return out;
  };
  return surface.whole
             ? count(surface.whole->area.size(), surface.whole->element, surface.whole->element_normal)
             : count(surface.size(), surface.element, surface.element_normal);
}

/// The number of faces at each point, of the body that has a candidate there.
std::vector<int> faces_of_points(const std::vector<PlacedBody>& bodies,
                                 const std::vector<ContactPair>& pairs) {
  constexpr double itself = 1 - 1e-9;  // weight of a candidate at the point
  std::vector<std::vector<int>> faces;
  for (const PlacedBody& body : bodies) faces.push_back(faces_at(body.kernel->surface));
  std::vector<int> out;
  for (const ContactPair& pair : pairs)
    for (const Pairing::Point& point : pair.pairing.points) {
      out.push_back(1);
      const auto see = [&](int body, const Pairing::Weights& weights) {
        for (const auto& [candidate, weight] : weights)
          if (body >= 0 && weight > itself)
            out.back() = std::max(out.back(),
                                  faces[static_cast<std::size_t>(body)][static_cast<std::size_t>(candidate)]);
      };
      see(pair.a, point.of_a);
      see(pair.b, point.of_b);
    }
  return out;
}

/// Returns P (n, cM) with u = Σ_bodies P · (displacement of the candidates of the body in its own frame).
/// Normal rows contain n for body a and −n W for body b; tangential rows contain the tangents instead.
/// @param c  3, or 1 for displacements along the direction of the kernel or along the normals
Selection selection(const PlacedBody& body, int index, const std::vector<ContactPair>& pairs,
                    const Model& model, int c) {
  const kernels::Surface& surface = body.kernel->surface;
  const bool along_normals = c == 1 && !surface.direction;
  Selection out(model.rows(), c * static_cast<int>(surface.size()));
  std::vector<Eigen::Triplet<double>> entries;
  int row = 0;
  std::size_t next = 0;  // of model.friction
  const std::vector<int> held = held_candidates(surface);
  for (const ContactPair& pair : pairs)
    for (const Pairing::Point& point : pair.pairing.points) {
      const Vector3d n = body.rotation.transpose() * point.normal;
      const auto add = [&](int number, double weight) {
        const int candidate = held.empty() ? number : held[number];
        if (candidate < 0) refuse_missing(body, pair.request, number);
        if (pair.request.friction) {
          if (c == 1) refuse_normals(body, pair.request);
          const int first = model.friction[next].tangential;
          const Eigen::Matrix<double, 2, 3> t = tangents_of(point.normal) * body.rotation;
          for (int along = 0; along < 2; ++along)
            for (int k = 0; k < 3; ++k)
              entries.emplace_back(first + along, 3 * candidate + k, weight * t(along, k));
        }
        if (along_normals) {
          const double cosine = n.dot(Eigen::Map<const Vector3d>(&surface.normal[3 * candidate]));
          if (std::abs(cosine) < std::cos(most_tilt)) refuse_tilt(body, pair.request, std::abs(cosine));
          entries.emplace_back(row, candidate, std::copysign(weight, weight * cosine));
        } else if (c == 1)  // check_component ensures that n is ± the stored direction
          entries.emplace_back(
              row, candidate,
              std::copysign(weight, weight * n.dot(Eigen::Map<const Vector3d>(surface.direction->data()))));
        else
          for (int k = 0; k < 3; ++k) entries.emplace_back(row, 3 * candidate + k, weight * n(k));
      };
      if (pair.a == index)
        for (const auto& [candidate, weight] : point.of_a) add(candidate, weight);
      if (pair.b == index)
        for (const auto& [candidate, weight] : point.of_b) add(candidate, -weight);
      ++row;
      if (pair.request.friction) ++next;
    }
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

/// Adds P (F + Fᵀ)/2 Pᵀ of a body to R and R_a, with F the flexibility in its kernel. A few rows at a time
/// need no further memory of the size of R.
void add_residual(Model& model, int body, const Selection& P, const Eigen::Map<const Matrix>& F) {
  constexpr Eigen::Index panel = 64;
  std::vector<char> is_a(static_cast<std::size_t>(P.rows()), 0);
  if (model.R_a.size() > 0)
    for (const Model::PairBlock& pair : model.pairs)
      if (pair.a == body) {
        std::fill_n(is_a.begin() + pair.first_point, pair.points, 1);
        if (pair.first_tangential >= 0) std::fill_n(is_a.begin() + pair.first_tangential, 2 * pair.points, 1);
      }
  for (Eigen::Index first = 0; first < P.rows(); first += panel) {
    const Eigen::Index rows = std::min(panel, P.rows() - first), end = first + rows;
    const Selection of_panel = P.middleRows(first, rows), so_far = P.topRows(end);
    const Matrix half = 0.5 * (of_panel * F + of_panel * F.transpose());
    const Matrix part = half * so_far.transpose();
    for (Eigen::Index i = first; i < end; ++i)
      for (Eigen::Index j = 0; j <= i; ++j) {
        const double value = part(i - first, j);
        model.R(i, j) += value;
        if (j < i) model.R(j, i) += value;
        if (is_a[i] != 0) model.R_a(i, j) += value;
        if (is_a[j] != 0 && j < i) model.R_a(j, i) += value;
      }
  }
}

}  // namespace

/// The first tangent is perpendicular to the axis of the world that is closest to the tangent plane.
Eigen::Matrix<double, 2, 3> tangents_of(const Vector3d& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  Eigen::Matrix<double, 2, 3> out;
  out.row(0) = normal.cross(Vector3d::Unit(axis)).normalized();
  out.row(1) = normal.cross(Vector3d(out.row(0)));
  return out;
}

std::vector<PatchSpring> Model::springs() const {
  std::vector<PatchSpring> out;
  const Vector flexibility = patch_flexibility();
  for (Eigen::Index i = 0; i < bulge.size(); ++i) {
    if (!(bulge(i) > 0) || !(flexibility(i) > 0)) continue;
    out.resize(static_cast<std::size_t>(points()));
    out[static_cast<std::size_t>(i)] = PatchSpring::of(bulge(i), flexibility(i));
  }
  return out;
}

void use_mean_gaps(Model& model) {
  if (model.bulge.size() == 0) return;
  model.gap += model.bulge;
  model.bulge.setZero();
}

Vector Model::PairBlock::part_of(const Vector& x) const {
  Vector out = Vector::Zero(x.size());
  out.segment(first_point, points) = x.segment(first_point, points);
  if (first_tangential >= 0)
    out.segment(first_tangential, 2 * points) = x.segment(first_tangential, 2 * points);
  return out;
}

Vector3d Model::friction_resultant(const PairBlock& pair, const Vector& force) const {
  if (pair.first_tangential < 0) return Vector3d::Zero();
  return tangent.middleRows(pair.first_tangential - points(), 2 * pair.points).transpose() *
         force.segment(pair.first_tangential, 2 * pair.points);
}

Vector3d Model::resultant(const PairBlock& pair, const Vector& force) const {
  return normal.middleRows(pair.first_point, pair.points).transpose() *
             force.segment(pair.first_point, pair.points) +
         friction_resultant(pair, force);
}

void add_belt(Model& model, const std::string& obstacle, const Vector3d& vector, History history) {
  Model::Belt belt{obstacle, Vector::Zero(model.rows()), std::move(history)};
  for (const Model::PairBlock& pair : model.pairs) {
    if (pair.obstacle != obstacle || pair.first_tangential < 0) continue;
    const Vector3d normal = model.normal.row(pair.first_point);
    if (std::abs(normal.dot(vector)) > 1e-9 * vector.norm())
      throw InputError(base::format(
          "obstacles.{}: it moves by [{:.6g}, {:.6g}, {:.6g}], which is not along its surface. Leave out the "
          "part along its normal [{:.6g}, {:.6g}, {:.6g}].",
          obstacle, vector.x(), vector.y(), vector.z(), -normal.x(), -normal.y(), -normal.z()));
    belt.slide.segment(pair.first_tangential, 2 * pair.points) =
        model.tangent.middleRows(pair.first_tangential - model.points(), 2 * pair.points) * vector;
  }
  if (belt.history.time.front() > 0 && belt.history.value.front() != 0)
    throw InputError(
        base::format("obstacles.{}: its history begins with the factor {} at t = {} s, so the obstacle would "
                     "jump. Begin it "
                     "with a factor of 0, or at t = 0.",
                     obstacle, belt.history.value.front(), belt.history.time.front()));
  if (!belt.slide.isZero(0)) model.belts.push_back(std::move(belt));
}

Model build_model(const Placement& placement, const Vector3d& gravity,
                  const std::vector<ForcingRequest>& forcing) {
  const auto& [bodies, pairs] = placement;
  Model model;
  model.gravity = gravity;
  for (const ForcingRequest& request : forcing)
    if (index_of(request.body, bodies) < 0)
      throw InputError(base::format("loads: \"{}\" is not a body. Name one of bodies.*.", request.body));

  int points = 0, modes = 0;
  for (const ContactPair& pair : pairs) {
    const int count = static_cast<int>(pair.pairing.points.size());
    model.pairs.push_back({points, count, pair.pairing.unpaired, pair.a, pair.b, {}});
    if (pair.pairing.beyond_reach > 0) model.pairs.back().reach = pair.pairing.reach;
    if (count > 0)
      model.pairs.back().initial_gap = std::ranges::min(pair.pairing.points, {}, &Pairing::Point::gap).gap;
    model.pairs.back().apart = pair.apart;
    if (pair.b < 0)
      model.pairs.back().obstacle = pair.request.a == bodies[pair.a].name ? pair.request.b : pair.request.a;
    points += count;
  }
  int rows = points;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (const auto& law = pairs[k].request.friction) {
      Model::PairBlock& block = model.pairs[k];
      block.first_tangential = rows;
      for (int i = 0; i < block.points; ++i, rows += 2)
        model.friction.push_back({block.first_point + i, rows, *law});
    }
  for (const PlacedBody& body : bodies) {
    model.bodies.push_back(block_of(body, modes, gravity));
    modes += model.bodies.back().modes;
  }

  for (Vector* v : {&model.gap, &model.bulge, &model.area}) v->setZero(points);
  for (Vector* v : {&model.static_displacement, &model.static_a}) v->setZero(rows);
  for (Matrix* x : {&model.point_a, &model.point_b, &model.normal}) x->setZero(points, 3);
  int i = 0;
  for (const ContactPair& pair : pairs)
    for (const Pairing::Point& point : pair.pairing.points) {
      model.gap(i) = point.gap;
      model.bulge(i) = point.bulge;
      model.area(i) = point.area;
      model.point_a.row(i) = point.a;
      model.point_b.row(i) = point.b;
      model.normal.row(i++) = point.normal;
    }
  model.faces = faces_of_points(bodies, pairs);
  model.tangent.resize(rows - points, 3);
  for (const Model::FrictionPoint& point : model.friction)
    model.tangent.middleRows(point.tangential - points, 2) =
        tangents_of(model.normal.row(point.point).transpose());

  for (Vector* v : {&model.omega, &model.decay, &model.load, &model.q0, &model.v0}) v->setZero(modes);
  model.B.setZero(rows, modes);
  model.R.setZero(rows, rows);
  if (std::ranges::any_of(model.pairs, [](const Model::PairBlock& pair) { return pair.b >= 0; }))
    model.R_a.setZero(rows, rows);
  model.has_residual = true;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const kernels::Kernel& kernel = *bodies[k].kernel;
    const Model::BodyBlock& block = model.bodies[k];
    const int first = block.first_mode, n = block.modes;
    model.omega.segment(first, n) = Eigen::Map<const Vector>(kernel.modes.angular_frequency.data(), n);
    model.decay.segment(first, n) = Eigen::Map<const Vector>(kernel.modes.decay_rate.data(), n);
    model.load.segment(first, n) = block.momentum.transpose() * gravity;
    model.v0.segment(first, n) = rigid_velocity(bodies[k], block);

    const auto select = [&, &bodies = bodies, &pairs = pairs](int c) {
      return selection(bodies[k], static_cast<int>(k), pairs, model, c);
    };
    const Selection& whole = model.bodies[k].selection = select(kernel.surface.components);
    model.B.middleCols(first, n) =
        whole * Eigen::Map<const Matrix>(kernel.surface.shape.data(), whole.cols(), n);
    const Selection& P = model.bodies[k].static_selection =
        kernel.surface.normal_residual ? select(1) : whole;
    const Eigen::Index held = P.cols();

    const auto& flexibility = kernel.surface.residual_flexibility;
    const auto& settling = kernel.loads.body_force_residual;
    model.has_residual = model.has_residual && !flexibility.empty();
    Vector s = Vector::Zero(rows);
    if (!flexibility.empty())
      add_residual(model, static_cast<int>(k), P, Eigen::Map<const Matrix>(flexibility.data(), held, held));
    if (!settling.empty())
      s = P * (Eigen::Map<const Matrix>(settling.data(), held, 3) * (block.rotation.transpose() * gravity))
                  .eval();
    model.static_displacement += s;
    for (const Model::PairBlock& pair : model.pairs)
      if (pair.a == static_cast<int>(k)) model.static_a += pair.part_of(s);
    add_forcing(model, static_cast<int>(k), forcing);
  }
  for (int k = 0; k < points; ++k)
    if (!(model.R(k, k) > 0)) model.gap(k) += std::exchange(model.bulge(k), 0.0);
  refuse_overlap(model);
  model.q0 = static_coordinates(model);
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Model::BodyBlock& block = model.bodies[k];
    const Vector3d& d = bodies[k].displacement;
    model.q0.segment(block.first_mode, block.modes) +=
        rigid_rates(bodies[k], block, block.momentum, d, block.mass * d.squaredNorm(), "velocity");
  }
  for (std::size_t k = 0; k < bodies.size(); ++k) add_receivers(model, static_cast<int>(k));
  return model;
}

}  // namespace ricochet::contact
