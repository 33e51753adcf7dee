// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the table [output], with receivers and their sound.
#pragma once

namespace ricochet::scene {

struct Scene;

class Table;

/// Reads [output] of `root`. `scene` must already contain its bodies and times. Throws InputError.
void read_output(const Table& root, Scene& scene);

}  // namespace ricochet::scene
