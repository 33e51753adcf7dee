// SPDX-License-Identifier: BSD-2-Clause
// What a simulation is made of, as a digest: two simulations with the same one make the same steps from the
// same state.
#pragma once

#include "base/digest.hpp"
#include "ricochet/ricochet.hpp"

namespace ricochet {

/// Of the data of a kernel, without the visualisation surface.
base::Digest::Value digest_of(const kernels::Kernel& kernel);

/// Of a scene without its pickups. @param kernels  of its bodies
base::Digest::Value digest_of(const Scene& scene, const std::vector<base::Digest::Value>& kernels);

}  // namespace ricochet
