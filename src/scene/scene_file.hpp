// SPDX-License-Identifier: BSD-2-Clause
// The text of a scene file, and its syntax errors with what to write in their place.
#pragma once

#include <filesystem>
#include <string>

#include "src/scene/table.hpp"

namespace ricochet::scene {

/// The text of a scene. Throws InputError if the file cannot be read or is of another kind, such as a folder,
/// a mesh, a kernel, a result or UTF-16 text; the message names the file to give in its place.
std::string text_of(const std::filesystem::path& file);

/// The tables of a scene. `name` is the name of its file. Throws InputError with line, column, the line and
/// the remedy if it is not TOML, and if it is a study.
toml::table tables_of(const std::string& text, const std::string& name);

}  // namespace ricochet::scene
