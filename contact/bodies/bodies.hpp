// SPDX-License-Identifier: BSD-2-Clause
// The modes of all bodies, stacked in q (N), and their rigid properties: what does not depend on contact.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "contact/pairing/pairing.hpp"
#include "contact/pairing/types.hpp"
#include "ricochet/kernel.hpp"

namespace ricochet::contact {

struct Bodies {
  // modes (N)
  Vector omega, decay;  ///< [rad/s], [1/s]
  Vector load;          ///< constant modal force, of gravity, f_n [kg^1/2 m/s²]
  Vector q0;            ///< initial modal displacement: static under dead loads, and rigid [kg^1/2 m]
  Vector v0;            ///< initial modal velocity, of the rigid modes [kg^1/2 m/s]
  struct Block {
    std::string name;
    int first_mode = 0, modes = 0;
    double mass = 0;
    Eigen::Vector3d centre;                                     ///< world, initial [m]
    Eigen::Matrix3d inertia;                                    ///< world, about the centre [kg m²]
    Eigen::Matrix<double, 3, Eigen::Dynamic> momentum;          ///< (3,modes) world: p = momentum · q̇
    Eigen::Matrix<double, 3, Eigen::Dynamic> angular_momentum;  ///< (3,modes) world, about the world's origin
    bool supported = false;
    Eigen::Vector3d weight;  ///< m g [N]
    const kernels::Kernel* kernel = nullptr;
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;

    /// With finite rotations: the first modes, which the frame of a free body replaces.
    int frame_modes() const { return supported ? 0 : 6; }

    // In the axes of the kernel
    Eigen::Vector3d own_centre() const { return rotation.transpose() * (centre - translation); }
    Eigen::Matrix3d own_inertia() const { return rotation.transpose() * inertia * rotation; }
    /// Largest distance of a candidate from the centre [m].
    double radius() const;
  };
  std::vector<Block> bodies;

  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
};

/// Stacks the modes of placed bodies. Elastic modes are at rest; static loads are not included in q0. Throws
/// InputError if a body cannot move rigidly with its velocity.
Bodies build_bodies(const std::vector<PlacedBody>& placed, const Eigen::Vector3d& gravity);

}  // namespace ricochet::contact
