// SPDX-License-Identifier: BSD-2-Clause
// Reads and checks scene files.
#pragma once

#include "src/scene/scene.hpp"

namespace ricochet::scene {

/// The use of a scene. If only kernels are computed, [time] and [contact] are optional; without [contact], no
/// body needs a contact surface.
enum class Purpose { impact, kernels };

/// Reads a scene file, applies `overrides` (KEY=VALUE, as in --set) in order, and checks every key and range.
/// Throws InputError "FILE: dotted.key = value: what. fix." for a key that is unknown, missing, of the wrong
/// type or out of range.
Scene read(const std::filesystem::path& file, const std::vector<Override>& overrides = {},
           Purpose purpose = Purpose::impact);

/// Reads a scene from text in the same way. `file` is its name in the scene and in errors, and paths are
/// relative to its folder. The file need not exist.
Scene parse(const std::string& text, const std::filesystem::path& file,
            const std::vector<Override>& overrides = {}, Purpose purpose = Purpose::impact);

/// Returns the text with the overrides applied, as TOML. Does not check keys. Throws InputError if the text
/// is not TOML or an override cannot be applied.
std::string overridden(const std::string& text, const std::filesystem::path& file,
                       const std::vector<Override>& overrides);

}  // namespace ricochet::scene
