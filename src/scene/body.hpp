// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the tables [bodies.NAME] and [obstacles.NAME].
#pragma once

namespace ricochet::scene {

struct Scene;

class Table;

/// Reads the bodies and obstacles of `root`. Throws InputError.
void read_bodies(const Table& root, Scene& scene);

}  // namespace ricochet::scene
