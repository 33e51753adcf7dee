// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: keys set on the command line, "--set KEY=VALUE".
#pragma once

#include <toml++/toml.h>

#include "src/scene/scene.hpp"

namespace ricochet::scene {

/// Applies one override to `root`. The value is parsed as TOML, and a value that is not TOML is used as a
/// string. Throws InputError that begins with "--set".
void apply_override(toml::table& root, const Override& text);

}  // namespace ricochet::scene
