// SPDX-License-Identifier: BSD-2-Clause
#include "contact/model/folding.hpp"

#include <cassert>

#include "contact/model/forcing.hpp"

namespace ricochet::contact {
namespace {

/// Moves a mode of a body into R, the static displacements, the forcing and the receivers.
void fold_mode(Model& model, int k, int n) {
  const double stiffness = model.omega(n) * model.omega(n);
  const Vector B = model.B.col(n), flexible = B / stiffness;
  const bool apart = model.static_a.size() > 0;  // whether the shares of body a are known
  const Vector of_a = apart ? share_of_a(model, k, flexible) : Vector();
  model.R.noalias() += B * B.transpose() / stiffness;
  model.static_displacement += flexible * model.load(n);
  if (apart) {
    if (model.R_a.size() > 0) model.R_a.noalias() += of_a * B.transpose();
    model.static_a += of_a * model.load(n);
  }
  for (Model::Receiver& receiver : model.receivers) {
    if (receiver.body != k) continue;
    const int i = n - model.bodies[k].first_mode;
    const Eigen::Vector3d motion = receiver.shape.col(i) / stiffness;
    receiver.constant += motion * model.load(n);
    receiver.flexibility -= motion * B.transpose();
    for (std::size_t d = 0; d < model.forcing.size(); ++d)
      if (model.forcing[d].body == k) receiver.forcing.col(d) += motion * model.forcing[d].force(i);
    receiver.shape.col(i).setZero();
  }
  for (Model::Forcing& one : model.forcing) {
    const Eigen::Index i = n - one.first_mode;
    if (i < 0 || i >= one.force.size()) continue;
    one.displacement += flexible * one.force(i);
    if (apart) one.displacement_a += of_a * one.force(i);
    one.force(i) = 0;
  }
  model.B.col(n).setZero();
  model.load(n) = model.q0(n) = model.v0(n) = 0;
}

}  // namespace

std::shared_ptr<const Model> fold(std::shared_ptr<const Model> model, const StepOptions& options) {
  std::vector<int> modes;
  for (int n = 0; n < model->omega.size() && options.contact.scheme == Scheme::compliant; ++n)
    if (!sampled(model->omega(n), options.step)) modes.push_back(n);
  if (modes == model->folded.modes) return model;
  assert(model->folded.modes.empty());
  const auto out = std::make_shared<Model>(*model);
  Model::Folded& folded = out->folded;
  if (model->turns) {  // steps compute R and the response to loads themselves
    folded.load = model->load(modes);
    for (const int n : modes) out->load(n) = out->q0(n) = out->v0(n) = 0;
    folded.modes = std::move(modes);
    return out;
  }
  folded.B = model->B(Eigen::all, modes);
  folded.load = model->load(modes);
  folded.force.setZero(std::ssize(modes), std::ssize(model->forcing));
  folded.R = model->R.diagonal();
  folded.R_a = model->residual_of_a().diagonal();
  for (std::size_t j = 0; j < modes.size(); ++j)
    for (std::size_t d = 0; d < model->forcing.size(); ++d) {
      const Model::Forcing& one = model->forcing[d];
      if (const Eigen::Index i = modes[j] - one.first_mode; i >= 0 && i < one.force.size())
        folded.force(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(d)) = one.force(i);
    }
  int k = 0;
  for (const int n : modes) {
    while (static_cast<std::size_t>(k) + 1 < model->bodies.size() && n >= model->bodies[k + 1].first_mode)
      ++k;
    fold_mode(*out, k, n);
  }
  folded.modes = std::move(modes);
  return out;
}

void set_folded(const Model& model, double t, const Vector& p, Vector& q, Vector* v) noexcept {
  const Model::Folded& folded = model.folded;
  for (std::size_t j = 0; j < folded.modes.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const int n = folded.modes[j];
    const double stiffness = model.omega(n) * model.omega(n);
    double force = folded.load(column) - folded.B.col(column).dot(p), slope = 0;
    for (std::size_t d = 0; d < model.forcing.size(); ++d) {
      const double of_one = folded.force(column, static_cast<Eigen::Index>(d));
      force += model.forcing[d].history.at(t) * of_one;
      slope += model.forcing[d].history.slope(t) * of_one;
    }
    q(n) = force / stiffness;
    if (v != nullptr) (*v)(n) = slope / stiffness;
  }
}

}  // namespace ricochet::contact
