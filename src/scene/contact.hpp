// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the table [contact].
#pragma once

#include "src/scene/data/contact.hpp"

namespace ricochet::scene {

struct Scene;

class Table;

/// Reads [contact] of `root`. The bodies and obstacles of `scene` must be known. Throws InputError.
Contact read_contact(Table& root, const Scene& scene);

}  // namespace ricochet::scene
