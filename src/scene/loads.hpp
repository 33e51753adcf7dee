// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: loads with histories and moving supports, and what they share with receivers.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "src/scene/data/loads.hpp"
#include "src/scene/keys.hpp"

namespace ricochet::scene {

/// The tables [[loads.NAME]].
struct LoadKind {
  const char* name;
  const SectionOf<Forcing>& keys;
  std::vector<Forcing> Loads::*list;
};
inline const std::array load_kinds{LoadKind{"traction", traction_keys, &Loads::tractions},
                                   LoadKind{"point", point_keys, &Loads::points},
                                   LoadKind{"motion", motion_keys, &Loads::motions}};

/// The key `body` of a load or a receiver.
template <class S>
Declared<S> body_key() {
  return {"body", Access<S>(&S::body).if_changed(), "", required("name the body"), any(), "name of a body"};
}

/// The key `at` of a load or a receiver.
template <class S>
Declared<S> place_key(const std::string& what, const std::string& remedy) {
  return {"at",
          &S::at,
          "m",
          required(remedy + ", [x, y, z] in world axes"),
          any(),
          what +
              ", in world axes, with the bodies placed by `translate` and `rotate_deg`. It must lie inside "
              "the body or on its surface. A point outside by at most 1e-6 of the body's size is moved onto "
              "the surface; a point farther outside is refused, with its distance"};
}

/// Reads [loads] of `root`. `scene` must already contain its bodies. Throws InputError.
void read_loads(const Table& root, Scene& scene);

/// Throws InputError if kernels cannot contain this name.
void check_name(const Table& table, const std::string& key, const std::string& name);

}  // namespace ricochet::scene
