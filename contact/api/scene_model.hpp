// SPDX-License-Identifier: BSD-2-Clause
// Converts the scene of the embedding interface for the steppers. All functions refuse what they cannot use
// in one line.
#pragma once

#include <string>
#include <vector>

#include "contact/model/model.hpp"
#include "ricochet/ricochet.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet {

/// Bodies at their places. They and all that is made of them refer to the kernels of the scene, which must
/// live as long.
std::vector<contact::PlacedBody> bodies_of(const Scene& scene);

/// Bodies at their places with their pairs. Also throws InputError as contact::place does.
contact::Placement placement_of(const Scene& scene);

/// The model of the bodies of the scene, which may be placed with other kernels. Also throws InputError as
/// contact::build_model, contact::refuse_early_contact and drive_obstacles do, and if a rod has friction.
contact::Model model_of(const Scene& scene, const contact::Placement& placement);

/// The model of a scene whose names and kernels nobody has checked. Also throws InputError as
/// contact::refuse_sag does.
contact::Model model_of(const Scene& scene);

/// Bodies of a simulation at their present places, and one more, with its pairs with them and with all
/// obstacles. Throws InputError as contact::pair does.
contact::Placement placement_with(const Scene& scene, std::vector<contact::PlacedBody> present,
                                  const contact::PlacedBody& added, const std::optional<Friction>& friction);

/// A body with a motion. Throws InputError if it has no kernel, or if a value is not finite.
contact::PlacedBody placed_body(const std::string& name, const SharedKernel& kernel,
                                const BodyMotion& motion);

/// Sets obstacles in motion: as model_of does. Throws InputError for motions that they cannot make.
void drive_obstacles(const Scene& scene, contact::Model& model);

/// No value if the pair is frictionless. Throws InputError for coefficients out of range.
/// @param where  the pair, for messages
std::optional<Friction> friction_of(const Scene& scene, const std::optional<Friction>& friction,
                                    const std::string& where);

StepOptions step_options(const Scene& scene);

/// Whether all points of the surface move along one line, as those of a rod do. A solid may have a single
/// patch.
bool is_rod(const kernels::Surface& surface);
/// The complaint about friction on a rod.
std::string friction_on_rod(const std::string& body);

/// Matrix (p,N) that maps q̇ to the velocities of the pickups.
contact::Matrix pickups_of(const Scene& scene, const contact::Model& model);

/// The point of a pickup on a body that turns.
struct TurningPickup {
  int body = 0;                        ///< −1: it has been removed
  Eigen::Vector3d place{0, 0, 0};      ///< from the centre of mass, in the axes of the body [m]
  Eigen::Vector3d direction{0, 0, 0};  ///< unit, world
  contact::Matrix shape{};             ///< (3,modes) in the axes of the body [kg^-1/2]
};

/// Those of a scene with finite rotations.
std::vector<TurningPickup> turning_pickups_of(const Scene& scene, const contact::Model& model);

}  // namespace ricochet
