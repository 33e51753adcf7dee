// Internal to src/scene: the parts of a resolved scene as TOML.
#pragma once

#include <string>

#include "src/scene/scene.hpp"

namespace ricochet::scene {

std::string toml_number(double value);  ///< shortest text that reads back the same, always a float
std::string toml_string(const std::string& text);
std::string toml_vector(const Vector3& v);
/// What the kernel of a body depends on but for its mesh file: geometry, order, scale, material, damping,
/// contact, support.
std::string toml_body_matter(const Body& body);
std::string toml_modes(const Modes& modes);

/// SHA-256 of bytes, hex.
std::string sha256(const std::string& bytes);

}  // namespace ricochet::scene
