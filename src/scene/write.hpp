// SPDX-License-Identifier: BSD-2-Clause
// The resolved scene as TOML, whole and in parts.
#pragma once

#include <string>

#include "src/scene/data/body.hpp"
#include "src/scene/data/modes.hpp"

namespace ricochet::scene {

struct Scene;

/// The resolved scene as TOML, with every default. Reading it gives the same scene.
std::string to_toml(const Scene& scene);

std::string toml_number(double value);  ///< shortest text that gives the same number; always a float
std::string toml_string(const std::string& text);
std::string toml_vector(const Vector3& v);
/// The value of `refine`, a list of inline tables.
std::string toml_refine(const std::vector<FineBall>& balls);
/// The keys of a body that its kernel depends on, except its mesh file: geometry, order, scale, material,
/// damping, contact, support.
std::string toml_body_matter(const Body& body);
std::string toml_modes(const Modes& modes);

}  // namespace ricochet::scene
