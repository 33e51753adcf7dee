// SPDX-License-Identifier: BSD-2-Clause
// Adds forcing and receivers to a model: loads with histories, moving supports, and points whose motion is
// recorded.
#pragma once

#include <numbers>
#include <string>

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// The part of `u` (n) in the rows of pairs whose body a is body k.
Vector share_of_a(const Model& model, int k, const Vector& u);

/// Static displacement of a receiver beyond the modes, body axes [m].
/// @param residual  three columns for each load or each motion  @param along  body axes
Eigen::Vector3d response(const std::vector<double>& residual, const Model::Forcing& one,
                         const Eigen::Vector3d& along);

/// Adds the forcing of body k; the model must already contain the block of this body and its columns of B.
/// Throws InputError if the kernel has no such load or motion, or if a support would jump.
void add_forcing(Model& model, int k, const std::vector<ForcingRequest>& forcing);

/// Sets an obstacle in motion, whose origin is `about` [m] at t = 0; half-spaces along their normals alone.
/// With linear rotations, the points keep their pairs, and the motion acts like that of a support: throws
/// InputError if it turns by more than `most_driven_turn`. The model must already contain its receivers.
void drive_obstacle(Model& model, const std::string& obstacle, const Eigen::Vector3d& about,
                    const DrivenMotion& motion);

/// Largest turn of an obstacle with linear rotations [rad].
inline constexpr double most_driven_turn = std::numbers::pi / 180;

/// Throws InputError if supports that are displaced at t = 0 make bodies overlap.
void refuse_overlap(const Model& model);

/// Adds the receivers of body k. The model must already contain the forcing of all bodies up to k.
void add_receivers(Model& model, int k);

}  // namespace ricochet::contact
