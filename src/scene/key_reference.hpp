// SPDX-License-Identifier: BSD-2-Clause
// The reference of all keys of a scene.
#pragma once

#include <string>

namespace ricochet::scene {

/// The reference as Markdown, without a final line break.
std::string key_reference();

}  // namespace ricochet::scene
