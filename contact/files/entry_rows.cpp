// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/entry_rows.hpp"

#include <span>
#include <string>

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

void append(base::hdf5::Rows& rows, const Vector3d& row) {
  rows.append(std::span<const double>(row.data(), 3));
}

}  // namespace

EntryRows::EntryRows(base::hdf5::Writer& file, const Model& model)
    : model_(model),
      time_(file.rows("/contact/time", {}, "s")),
      first_(file.rows("/contact/first", {}, "1")),
      point_(file.rows("/contact/point", {}, "1")),
      force_(file.rows("/contact/force", {}, "N")),
      gap_(file.rows("/contact/gap", {}, "m")),
      place_(file.rows("/contact/place", {3}, "m")),
      normal_(file.rows("/contact/normal_now", {3}, "1")),
      friction_of_(static_cast<std::size_t>(model.points()), -1) {
  std::vector<std::string> a, b;
  for (const Model::PairBlock& pair : model.pairs) {
    a.push_back(model.bodies[pair.a].name);
    b.push_back(pair.b < 0 ? pair.obstacle : model.bodies[pair.b].name);
  }
  file.write_strings("/contact/side_a", a);
  file.write_strings("/contact/side_b", b);
  if (model.friction.empty()) return;
  tangential_force_ = &file.rows("/contact/tangential_force", {3}, "N");
  tangential_displacement_ = &file.rows("/contact/tangential_displacement", {3}, "m");
  state_ = &file.rows("/contact/state", {}, "1");
  for (std::size_t f = 0; f < model.friction.size(); ++f)
    friction_of_[static_cast<std::size_t>(model.friction[f].point)] = static_cast<int>(f);
}

void EntryRows::append(const Stepper& stepper) {
  const RowFrames& frames = stepper.turning()->frames;
  const Vector& u = stepper.displacement();
  time_.append(stepper.time());
  first_.append(static_cast<double>(count_));
  for (Eigen::Index i = 0; i < model_.points(); ++i) {
    const int f = friction_of_[static_cast<std::size_t>(i)];
    const bool closed = f >= 0 && stepper.slip().states()[static_cast<std::size_t>(f)] != ContactState::open;
    if (stepper.force()(i) == 0 && !closed) continue;
    point_.append(static_cast<double>(i));
    force_.append(stepper.force()(i));
    const double gap = model_.gap(i) - u(i);
    const Vector3d normal = frames.normal.row(i);
    gap_.append(gap);
    contact::append(place_, frames.point_b.row(i).transpose() - gap * normal);
    contact::append(normal_, normal);
    if (state_ != nullptr) append_friction(stepper, u, i);
    ++count_;
  }
}

/// Force τ on b, displacement of a relative to b, and state of a point; 0 without friction.
void EntryRows::append_friction(const Stepper& stepper, const Vector& u, Eigen::Index point) {
  Vector3d pushed = Vector3d::Zero(), moved = pushed;
  ContactState state = ContactState::open;
  if (const int f = friction_of_[static_cast<std::size_t>(point)]; f >= 0) {
    const int row = model_.friction[static_cast<std::size_t>(f)].tangential;
    const auto tangents = stepper.turning()->frames.tangent.middleRows<2>(row - model_.points());
    state = stepper.slip().states()[static_cast<std::size_t>(f)];
    pushed = tangents.transpose() * stepper.force().segment<2>(row);
    if (state != ContactState::open) moved = tangents.transpose() * u.segment<2>(row);
  }
  contact::append(*tangential_force_, pushed);
  contact::append(*tangential_displacement_, moved);
  state_->append(static_cast<double>(state));
}

}  // namespace ricochet::contact
