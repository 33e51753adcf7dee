// SPDX-License-Identifier: BSD-2-Clause
#include "contact/api/system_digest.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "kernels/format.hpp"

namespace ricochet {
namespace {

using base::Digest;

void add(Digest& digest, const auto& x);

template <class T>
void add_entries(Digest& digest, const std::vector<T>& x) {
  if constexpr (std::is_arithmetic_v<T>) {
    digest.add(x.data(), x.size() * sizeof(T));
  } else {
    digest.add(x.size());
    for (const T& one : x) add(digest, one);
  }
}

/// The members of a struct. One that is added to it must be listed here, or the code does not compile.
void add_members(Digest& digest, const Friction& x) {
  const auto& [at_rest, sliding, stribeck] = x;
  for (const double value : {at_rest, sliding, stribeck}) digest.add(value);
}
void add_members(Digest& digest, const Slide& x) {
  const auto& [vector, time, factor, turn_deg] = x;
  add(digest, vector);
  add(digest, turn_deg);
  add(digest, time);
  add(digest, factor);
}
void add_members(Digest& digest, const Forcing& x) {
  const auto& [body, name, support, vector, time, factor, axes, pressure] = x;
  add(digest, body);
  add(digest, name);
  add(digest, support);
  add(digest, vector);
  add(digest, time);
  add(digest, factor);
  add(digest, axes);
  add(digest, pressure);
}
void add_members(Digest& digest, const SurfaceMesh& x) {
  const auto& [node, triangle] = x;
  add(digest, node);
  add(digest, triangle);
}
void add_members(Digest& digest, const Obstacle& x) {
  const auto& [name, point, normal, velocity, slides, shape, side, rotate_deg, radius, radius_small, length,
               size, mesh, angular_velocity] = x;
  add(digest, name);
  for (const Vector3& vector : {point, normal, velocity, rotate_deg, size, angular_velocity})
    add(digest, vector);
  add(digest, slides);
  add(digest, shape);
  add(digest, side);
  for (const double measure : {radius, radius_small, length}) add(digest, measure);
  add(digest, mesh);
}
void add_members(Digest& digest, const Pair& x) {
  const auto& [a, b, direction, gap, reach, zone, friction] = x;
  add(digest, a);
  add(digest, b);
  add(digest, direction);
  add(digest, gap);
  add(digest, reach);
  add(digest, zone);
  add(digest, friction);
}
void add_members(Digest& digest, const ContactScheme& x) {
  const auto& [scheme, admittance, instant, restitution, integration, max_pivots] = x;
  add(digest, scheme);
  add(digest, admittance);
  add(digest, instant);
  add(digest, restitution);
  add(digest, integration);
  add(digest, max_pivots);
}
void add_members(Digest& digest, const Stepping& x) {
  const auto& [rate_hz, contact_rate_hz, precision] = x;
  add(digest, rate_hz);
  add(digest, contact_rate_hz);
  add(digest, precision);
}
void add_members(Digest& digest, const RigidBodies& x) {
  const auto& [rotation] = x;
  add(digest, rotation);
}

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsArray : std::false_type {};
template <class T, std::size_t count>
struct IsArray<std::array<T, count>> : std::is_arithmetic<T> {};

void add(Digest& digest, const auto& x) {
  using T = std::remove_cvref_t<decltype(x)>;
  if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    digest.add(x);
  } else if constexpr (std::same_as<T, std::string>) {
    digest.add(x);
  } else if constexpr (IsArray<T>::value) {
    digest.add(x.data(), sizeof x);
  } else if constexpr (IsVector<T>::value) {
    add_entries(digest, x);
  } else if constexpr (requires { x.has_value(); }) {
    digest.add(x.has_value());
    if (x) add(digest, *x);
  } else {
    add_members(digest, x);
  }
}

/// Takes the data that kernels/format.hpp lists, but not those that record how a kernel was made.
class KernelDigest {
 public:
  explicit KernelDigest(Digest& digest) : digest_(digest) {}

  void group(const std::string& name) { digest_.add(name); }
  void attribute(const std::string& object, const std::string& name, const auto& value) {
    if (name == "hash" || name == "scene" || name == "mesh_sha256" || name == "created_by") return;
    digest_.add(object);
    digest_.add(name);
    if constexpr (requires { value.size(); })
      entries(value);
    else
      digest_.add(value);
  }
  void constant(const std::string& object, const std::string& name, const std::string& value) {
    attribute(object, name, value);
  }
  void optional_attribute(const std::string& object, const std::string& name, const auto& value) {
    attribute(object, name, value);
  }
  std::size_t rows(const std::string&, const auto& values, std::size_t width) {
    return values.size() / width;
  }
  void dataset(const std::string& name, const auto& values, const kernels::Shape&, const std::string&) {
    digest_.add(name);
    entries(values);
  }
  void optional_dataset(const std::string& name, const auto& values, const kernels::Shape& shape,
                        const std::string& unit) {
    dataset(name, values, shape, unit);
  }
  void strings(const std::string& name, const std::vector<std::string>& values, std::size_t) {
    digest_.add(name);
    for (const std::string& value : values) digest_.add(value);
  }
  void elements(const std::string& name, const std::vector<std::int64_t>& element, int corners, int,
                std::size_t) {
    digest_.add(name);
    digest_.add(corners);
    entries(element);
  }
  void choose(const std::string& name, const auto& optional) {
    digest_.add(name);
    digest_.add(optional.has_value());
  }
  void names(const std::string& kind, const auto& items) {
    digest_.add(kind);
    for (const auto& item : items) digest_.add(item.name);
  }

 private:
  void entries(const auto& values) { digest_.add(values.data(), values.size() * sizeof(*values.data())); }

  Digest& digest_;
};

}  // namespace

Digest::Value digest_of(const kernels::Kernel& kernel) {
  Digest digest;
  KernelDigest file(digest);
  kernels::list_root(file, kernel);
  kernels::list_modes(file, kernel.modes);
  kernels::list_surface(file, kernel.surface, kernel.modes.size());
  kernels::list_sources(file, kernel);
  return digest.value();
}

Digest::Value digest_of(const Scene& scene, const std::vector<Digest::Value>& kernels) {
  Digest digest;
  digest.add(scene.bodies.size());
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const auto& [name, kernel, rotate_deg, translate, velocity, angular_velocity, arrival] = scene.bodies[k];
    add(digest, name);
    digest.add(kernels[k]);
    for (const Vector3& vector : {rotate_deg, translate, velocity, angular_velocity}) add(digest, vector);
    add(digest, arrival);
  }
  add(digest, scene.obstacles);
  add(digest, scene.pairs);
  add(digest, scene.forcing);
  add(digest, scene.gravity);
  add(digest, static_cast<const ContactScheme&>(scene));
  add(digest, static_cast<const Stepping&>(scene));
  add(digest, static_cast<const RigidBodies&>(scene));
  return digest.value();
}

}  // namespace ricochet
