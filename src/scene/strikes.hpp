// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: [[strikes]], blows by mallets.
#pragma once

namespace ricochet::scene {

struct Scene;

class Table;

/// Reads [[strikes]] of `root` into `scene`, which must already contain all the rest, and adds the copies of
/// mallets to its bodies and pairs. Throws InputError.
void read_strikes(const Table& root, Scene& scene);

}  // namespace ricochet::scene
