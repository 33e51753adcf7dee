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

/// Access to the place in these axes, which a scene gives in one of them.
template <class S>
Access<S> place(Axes axes) {
  Access<S> access(
      type_of<Vector3>,
      [axes](const Table& table, const Key& key, S& s) {
        const bool given = table.read(key, s.at);
        if (given) s.at_axes = axes;
        return given;
      },
      [](const S& s) { return toml_value(s.at); });
  access.is_written = [axes](const void* s) { return static_cast<const S*>(s)->at_axes == axes; };
  return access;
}

/// The key `at` of a load or a receiver.
template <class S>
Declared<S> at_key(const std::string& what) {
  return {"at",
          place<S>(Axes::world),
          "m",
          "– without `at_body`",
          any(),
          what +
              ", in world axes, with the bodies placed by `translate` and `rotate_deg`. It must lie inside "
              "the body or on its surface. A point outside by at most 1e-6 of the body's size is moved onto "
              "the surface; a point farther outside is refused, with its distance"};
}

/// The key `at_body` of a load or a receiver.
template <class S>
Declared<S> at_body_key() {
  return {"at_body",
          place<S>(Axes::body),
          "m",
          "– without `at`",
          any(),
          "the same point in the axes of the mesh, as in its drawing: after `scale`, before `rotate_deg` and "
          "`translate`"};
}

/// Throws InputError unless the table gives its place once. @param what  the place, in words
void check_place(const Table& table, const std::string& what);

/// Reads [loads] of `root`. `scene` must already contain its bodies. Throws InputError.
void read_loads(const Table& root, Scene& scene);

/// Throws InputError if kernels cannot contain this name.
void check_name(const Table& table, const std::string& key, const std::string& name);

}  // namespace ricochet::scene
