// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ricochet/scene.hpp"

namespace ricochet::scene {

/// A pair with what its candidates need beside the settings of the library. The direction is a unit vector.
struct Pair : ricochet::Pair {
  std::optional<Vector3> along{};   ///< unit vector
  std::optional<double> spacing{};  ///< [m]
  bool meets_all = false;           ///< while reading: stands for all pairs
  bool touch = true;                ///< while reading: false for an exception to them
  bool names(const std::string& body) const { return a == body || b == body; }
  bool operator==(const Pair&) const = default;
};

enum class Solver { exact, uzawa };

/// How the response to contact forces is computed: from the modes of the bodies, or from responses that are
/// sampled in time and convolved with the forces.
enum class ContactKernel { modes, table };

struct Contact : ContactScheme {
  ContactKernel kernel = ContactKernel::modes;
  std::filesystem::path table;    ///< kernel = table: file that replaces the bodies; empty: sampled modes
  Solver solver = Solver::exact;  ///< scheme "static" only
  int increments = 20;            ///< of each stage of the loads, at rest with friction
  std::vector<Pair> pairs;        ///< [contact] itself, or each [[contact.pair]]
  bool operator==(const Contact&) const = default;
  /// Whether contact steps have a rate of their own, beside that of the output.
  bool has_contact_rate() const { return scheme == Scheme::compliant && kernel == ContactKernel::modes; }
  /// Whether a pair with friction names this body or obstacle.
  bool rubs(const std::string& name) const;
};

}  // namespace ricochet::scene
