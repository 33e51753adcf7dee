// SPDX-License-Identifier: BSD-2-Clause
// The motion of a body's visualisation surface: x = Q (x_0 + φ q + r) + t, in single precision. With
// finite rotations, Q and t are those of its frame.
//
// r is the static correction under contact, gravity, loads and supports, as for receivers.
#pragma once

#include <array>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

/// The motion of V nodes, in world axes.
struct SurfaceMotion {
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  Rows position;     ///< (V,3) [m]
  Rows deformation;  ///< (V,3) displacement without that of rigid modes [m]
  Rows velocity;     ///< (V,3) of the modes, the supports and the loads that vary [m/s]
};

/// A point of a visualisation surface: nodes and their weights.
struct SurfacePoint {
  std::array<int, 3> node{};
  std::array<double, 3> weight{};
  Eigen::Vector3d point{0, 0, 0};  ///< [m]
};

class VisualisationSurface {
 public:
  /// The kernel of the body must have a visualisation surface. `model` must outlive this object.
  VisualisationSurface(const Model& model, int body, const StepOptions& options);

  std::size_t nodes() const { return view_.node.size() / 3; }
  const kernels::View& view() const { return view_; }

  /// @param q, v, force  (N), (N), (m) the state of a stepper at time t
  /// @param turning  of the stepper; null unless rotations are finite
  const SurfaceMotion& at(double t, const Vector& q, const Vector& v, const Vector& force,
                          const Turning* turning);

  /// Returns the points of the surface closest to x (·,3) [m], with the body in its initial placement.
  std::vector<SurfacePoint> closest(const Eigen::Ref<const Matrix>& x) const;

 private:
  using Values = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  const SurfaceMotion& in_frame(double t, const Turning& turning, const Vector& q, const Vector& v);
  Eigen::VectorXf response(const Model::Forcing& one, const Eigen::Vector3d& along) const;

  const Model& model_;
  int number_;
  const Bodies::Block& body_;
  const kernels::View& view_;
  Eigen::Map<const Values> shape_;  ///< (3V,N)
  Eigen::Index rigid_ = 0;          ///< number of rigid modes, which come first
  Values flexibility_;              ///< (3V,m) by λ [m/N]; no columns if contact has no static part
  Eigen::VectorXf constant_;        ///< (3V) under gravity [m]
  Values forcing_;  ///< (3V,forcings) displacement for a history of value 1, in the order of of_body_
  std::vector<const Model::Forcing*> of_body_;
  Vector all_q_, all_v_;  ///< (N) of all modes, also of folded ones
  SurfaceMotion out_;
};

}  // namespace ricochet::contact
