// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/visualisation_surface.hpp"

#include "contact/figures/candidate_forces.hpp"
#include "contact/model/folding.hpp"
#include "contact/pairing/surface_projection.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Eigen::VectorXf;

/// View (3V, columns) of an array of a kernel, which may be empty.
auto columns_of(const std::vector<float>& values, Index rows) {
  using Values = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const Values>(values.data(), rows, rows > 0 ? values.size() / rows : 0);
}

}  // namespace

VisualisationSurface::VisualisationSurface(const Model& model, int body, const StepOptions& options)
    : model_(model),
      number_(body),
      body_(model.bodies[body]),
      view_(*body_.kernel->view),
      shape_(view_.shape.data(), view_.node.size(), body_.modes),
      constant_(VectorXf::Zero(shape_.rows())) {
  const Index rows = shape_.rows();
  const auto omega = model.omega.segment(body_.first_mode, body_.modes);
  while (rigid_ < omega.size() && omega(rigid_) == 0) ++rigid_;
  if (options.contact.scheme == Scheme::compliant && options.rigid.rotation == Rotation::linear) {
    const auto correction = columns_of(view_.residual_flexibility, rows);
    if (correction.cols() > 0)
      flexibility_ = -(correction * model.static_selection[body].transpose().cast<float>());
  }
  const auto to_body = [&](const Eigen::Vector3d& x) -> Eigen::Vector3f {
    return (body_.rotation.transpose() * x).cast<float>();
  };
  const auto settling = columns_of(view_.body_force_residual, rows);
  if (settling.cols() > 0) constant_ = settling * to_body(model.gravity);
  for (const Model::Forcing& one : model.forcing)
    if (one.body == body) of_body_.push_back(&one);
  forcing_.setZero(rows, of_body_.size());
  for (std::size_t d = 0; d < of_body_.size(); ++d)
    forcing_.col(static_cast<Index>(d)) = response(*of_body_[d], of_body_[d]->own);
}

/// (3V) Static displacement by a load or a support, for a history of value 1. @param along  body axes
VectorXf VisualisationSurface::response(const Model::Forcing& one, const Eigen::Vector3d& along) const {
  const auto correction =
      columns_of(one.support ? view_.motion_residual : view_.load_residual, shape_.rows());
  VectorXf out = shape_ * one.lift.cast<float>();  // of a support: Ψ = (Ψ − ΦΓ) + ΦΓ
  if (correction.cols() > 0) out += correction.middleCols(3 * one.entry, 3) * along.cast<float>();
  return out;
}

/// The motion in the floating frame of the body.
const SurfaceMotion& VisualisationSurface::in_frame(double t, const Turning& turning, const Vector& q,
                                                    const Vector& v) {
  using Places = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const Index rows = shape_.rows(), elastic = body_.modes - rigid_, first = body_.first_mode + rigid_;
  const Vector& on_candidates = turning.candidate_force[static_cast<std::size_t>(number_)];
  all_q_ = q;
  set_folded(model_, number_, turning, t, all_q_);
  VectorXf deformation = body_.supported ? constant_ : VectorXf::Zero(rows);
  deformation.noalias() += shape_.rightCols(elastic) * all_q_.segment(first, elastic).cast<float>();
  if (const auto correction = columns_of(view_.residual_flexibility, rows); correction.cols() > 0)
    deformation.noalias() += correction * on_candidates.cast<float>();
  VectorXf rate = shape_.rightCols(elastic) * v.segment(first, elastic).cast<float>();
  const Pose& pose = turning.poses[static_cast<std::size_t>(number_)];
  for (const Model::Forcing* const one : of_body_) {
    const VectorXf column = response(*one, one->along(pose.attitude));
    deformation += static_cast<float>(one->history.at(t)) * column;
    rate += static_cast<float>(one->history.slope(t)) * column;
  }
  const auto places = [&](const VectorXd& x) {
    return Places(Eigen::Map<const Places>(x.data(), rows / 3, 3));
  };
  const Eigen::Matrix3d A = pose.attitude.toRotationMatrix();
  const Eigen::Vector3d centre = body_.own_centre();
  const Places arm = (Eigen::Map<const Places>(view_.node.data(), rows / 3, 3).rowwise() -
                      centre.transpose() + places(deformation.cast<double>())) *
                     A.transpose();
  out_.position = (arm.rowwise() + pose.position.transpose()).cast<float>();
  out_.deformation = (places(deformation.cast<double>()) * A.transpose()).cast<float>();
  out_.velocity =
      ((places(rate.cast<double>()) * A.transpose() + arm.rowwise().cross(-pose.spin.transpose())).rowwise() +
       pose.velocity.transpose())
          .cast<float>();
  return out_;
}

const SurfaceMotion& VisualisationSurface::at(double t, const Vector& q, const Vector& v, const Vector& force,
                                              const Turning* turning) {
  if (turning) return in_frame(t, *turning, q, turning->rates);
  const Index rows = shape_.rows(), elastic = body_.modes - rigid_;
  all_q_ = q;
  all_v_ = v;
  set_folded(model_, t, force, all_q_, &all_v_);
  const VectorXd own = all_q_.segment(body_.first_mode, body_.modes),
                 rate = all_v_.segment(body_.first_mode, body_.modes);
  // A body may fly far, so the motion of its rigid modes is summed in double precision.
  const Eigen::MatrixXd rigid_shape = shape_.leftCols(rigid_).cast<double>();
  VectorXf deformation = constant_, velocity = shape_.rightCols(elastic) * rate.tail(elastic).cast<float>();
  deformation.noalias() += shape_.rightCols(elastic) * own.tail(elastic).cast<float>();
  if (flexibility_.cols() > 0) deformation.noalias() += flexibility_ * force.cast<float>();
  for (std::size_t d = 0; d < of_body_.size(); ++d) {
    const auto column = forcing_.col(d);
    deformation += static_cast<float>(of_body_[d]->history.at(t)) * column;
    velocity += static_cast<float>(of_body_[d]->history.slope(t)) * column;
  }
  const VectorXd place = Eigen::Map<const VectorXd>(view_.node.data(), rows) +
                         rigid_shape * own.head(rigid_) + deformation.cast<double>(),
                 speed = rigid_shape * rate.head(rigid_) + velocity.cast<double>();
  const auto to_world = [&](const VectorXd& x) {
    using Places = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    return Places(Eigen::Map<const Places>(x.data(), rows / 3, 3) * body_.rotation.transpose());
  };
  out_.position = (to_world(place).rowwise() + body_.translation.transpose()).cast<float>();
  out_.deformation = to_world(deformation.cast<double>()).cast<float>();
  out_.velocity = to_world(speed).cast<float>();
  return out_;
}

std::vector<SurfacePoint> VisualisationSurface::closest(const Eigen::Ref<const Matrix>& x) const {
  WorldSurface surface;
  surface.corners = view_.element_corners;
  for (std::size_t i = 0; i < view_.node.size(); i += 3) {
    surface.node.push_back(body_.rotation * Eigen::Map<const Eigen::Vector3d>(&view_.node[i]) +
                           body_.translation);
    surface.normal.push_back(Eigen::Vector3d::UnitX());  // arbitrary; it is not used here
  }
  const auto k = static_cast<std::size_t>(surface.corners);
  for (std::size_t e = 0; e + k <= view_.element.size(); e += k) {
    WorldSurface::Element element;
    for (std::size_t j = 0; j < k; ++j) element.corner[j] = static_cast<int>(view_.element[e + j]);
    surface.add(element);
  }
  const SurfaceProjection target(std::move(surface));
  std::vector<SurfacePoint> out;
  for (Index i = 0; i < x.rows(); ++i) {
    const auto found = target.closest(x.row(i).transpose());
    out.push_back(found ? SurfacePoint{found->corner, found->weight, found->point} : SurfacePoint{});
  }
  return out;
}

}  // namespace ricochet::contact
