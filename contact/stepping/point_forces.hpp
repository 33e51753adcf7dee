// SPDX-License-Identifier: BSD-2-Clause
// Forces from outside at points of bodies, constant in the world until they are set again.
//
// A force F at a point x of a body acts on its modes by φ(x)ᵀ F. With linear rotations, it also has the
// static displacement beyond the modes at the contact points of the body, R_ix F, by reciprocity the one of
// x under forces at these points. Of bodies that turn, the arm is that of the undeformed body
// (turning_loads.hpp).
#pragma once

#include <span>
#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// A receiver of the kernel of a body, or a candidate, by number.
struct BodyPlace {
  bool is_receiver = false;
  int number = 0;
  bool operator==(const BodyPlace&) const = default;
};

enum class PushStatus {
  refused,  ///< there is no such point, the kernel does not hold its motion along the force, the force is not
            ///< finite, or forces act at as many points as possible
  same,     ///< the force has been acting
  changed,
};

class PointForces {
 public:
  static constexpr std::size_t most = 1024;  ///< points at which a force may act at a time

  struct Force {
    int body = 0;
    BodyPlace place{};
    Eigen::Vector3d world{0, 0, 0};  ///< [N]
    void archive(auto& a) { a(body, place.is_receiver, place.number, world); }
  };

  PointForces() { forces_.reserve(most); }

  /// Sets a force [N], world axes; 0: none.
  PushStatus set(const Model& model, int body, const BodyPlace& place, const Eigen::Vector3d& force) noexcept;
  std::span<const Force> all() const { return forces_; }
  bool act_on(int body) const noexcept;
  void forget(int body) noexcept;  ///< no force acts on it
  /// Takes the forces on bodies that two models have in common. @param body  earlier number of each, or −1
  void take(const PointForces& earlier, const std::vector<int>& body);

  void archive(auto& a) { a(forces_); }

 private:
  std::vector<Force> forces_;
};

/// From the centre of the body, body axes [m].
Eigen::Vector3d arm_of(const Bodies::Block& body, const BodyPlace& place) noexcept;

/// Adds the modal forces of a force in body axes to those of all modes of the body [kg^1/2 m/s²].
void push_modes(const Bodies::Block& body, const BodyPlace& place, const Eigen::Vector3d& force,
                Eigen::Ref<Vector> modal) noexcept;
/// Φ(x)ᵀ Φ(x) of the modes from `first` on, summed over directions [1/kg].
double square_shape(const Bodies::Block& body, const BodyPlace& place, Eigen::Index first) noexcept;

/// Adds the static displacement beyond the modes to that of the rows of a model whose bodies do not turn [m].
/// @param force  body axes  @param scratch  (rM) or longer
void push_rows(const Model& model, int body, const BodyPlace& place, const Eigen::Vector3d& force,
               Vector& scratch, Vector& displacement) noexcept;

}  // namespace ricochet::contact
