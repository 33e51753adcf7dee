// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the table [motion].
#pragma once

namespace ricochet::scene {

class Table;
struct Scene;

/// Reads [motion] of `root`. All other tables but [[strikes]] must have been read. Throws InputError, also if
/// finite rotations do not go with the rest of the scene.
void read_motion(const Table& root, Scene& scene);

}  // namespace ricochet::scene
