// SPDX-License-Identifier: BSD-2-Clause
// Scene files, read and checked.
#pragma once

#include "src/scene/scene.hpp"

namespace ricochet::scene {

/// The use of a scene. For kernels alone, [time] and [contact] are optional; without [contact], no body needs
/// a contact surface.
enum class Purpose { impact, kernels };

/// Reads a scene file, applies `overrides` (KEY=VALUE, as in --set) in their order, and checks every key and
/// range. Throws InputError "FILE: dotted.key = value: what. fix." for a key that is unknown, missing, of
/// the wrong type or out of range.
Scene read(const std::filesystem::path& file, const std::vector<Override>& overrides = {},
           Purpose purpose = Purpose::impact);

/// Reads the text of a scene likewise. `file` names it in errors and in the scene, and paths are relative to
/// its folder; the file need not exist.
Scene parse(const std::string& text, const std::filesystem::path& file,
            const std::vector<Override>& overrides = {}, Purpose purpose = Purpose::impact);

/// Returns the text with the overrides applied, as TOML. Checks no key. Throws InputError for text that is
/// not TOML and for overrides that cannot be applied.
std::string overridden(const std::string& text, const std::filesystem::path& file,
                       const std::vector<Override>& overrides);

}  // namespace ricochet::scene
