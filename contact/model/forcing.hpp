// SPDX-License-Identifier: BSD-2-Clause
// What model.cpp and model_drives.cpp share.
#pragma once

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// Adds what `drives` ask of body k, whose block and B are there. Throws InputError when its kernel has no
/// such load or motion, or when a support would jump.
void drive(Model& model, int k, const Selection& P, const std::vector<DriveRequest>& drives);

/// Throws InputError when supports that are displaced at t = 0 make bodies overlap.
void refuse_overlap(const Model& model);

/// Adds the receivers of body k. The drives of all bodies before it, and its own, are there.
void listen(Model& model, int k, const Selection& P);

}  // namespace ricochet::contact
