// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ricochet/friction.hpp"
#include "ricochet/scheme.hpp"
#include "ricochet/units.hpp"

namespace ricochet::scene {

/// A contact pair. `a` is a body; `b` is a body or an obstacle.
struct Pair {
  std::string a, b;
  std::optional<Vector3> direction;    ///< unit vector, pointing out of a
  std::optional<Vector3> along;        ///< unit vector
  std::optional<double> spacing;       ///< [m]
  std::optional<double> gap;           ///< [m]
  std::optional<double> reach;         ///< [m]
  std::optional<double> zone;          ///< [m]
  std::optional<Friction> friction{};  ///< no value: frictionless; never with both coefficients 0
  bool names(const std::string& body) const { return a == body || b == body; }
  bool operator==(const Pair&) const = default;
};

enum class Solver { exact, uzawa };

/// How the response to contact forces is computed: from the modes of the bodies, or from responses that are
/// sampled in time and convolved with the forces.
enum class ContactKernel { modes, table };

struct Contact {
  ContactKernel kernel = ContactKernel::modes;
  std::filesystem::path table;  ///< kernel = table: file that replaces the bodies; empty: sampled modes
  Scheme scheme = Scheme::compliant;
  ContactStep integration = ContactStep::conserving;  ///< compliant scheme only
  Admittance admittance = Admittance::jump;           ///< impulse scheme only
  Instant instant = Instant::step;                    ///< impulse scheme only
  double restitution = 0;                             ///< impulse scheme only, in [0, 1]
  Solver solver = Solver::exact;                      ///< scheme "static" only
  int increments = 20;                                ///< of each stage of the loads, at rest with friction
  std::optional<int> max_pivots;  ///< bound on the work of a step, at least 1; no value: unbounded
  std::vector<Pair> pairs;        ///< [contact] itself, or each [[contact.pair]]
  bool operator==(const Contact&) const = default;
  /// Whether contact steps have a rate of their own, beside that of the output.
  bool has_contact_rate() const { return scheme == Scheme::compliant && kernel == ContactKernel::modes; }
  /// Whether a pair with friction names this body or obstacle.
  bool rubs(const std::string& name) const;
};

}  // namespace ricochet::scene
