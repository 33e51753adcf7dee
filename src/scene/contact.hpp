// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the table [contact].
#pragma once

#include "src/scene/data/contact.hpp"

namespace ricochet::scene {

struct Scene;

class Table;

/// Of a key in a scene of sampled responses.
inline const char* const replaced_by_table = "is replaced by contact.table: leave one of them out";

/// Reads [contact] of `root`. The bodies and obstacles of `scene` must be known. Throws InputError.
Contact read_contact(const Table& root, const Scene& scene);

}  // namespace ricochet::scene
