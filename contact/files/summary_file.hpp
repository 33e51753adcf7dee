// SPDX-License-Identifier: BSD-2-Clause
// The file summary.json.
#pragma once

#include <filesystem>
#include <string>

#include "contact/figures/equilibrium_summary.hpp"
#include "contact/figures/summary.hpp"

namespace ricochet::contact {

/// The text of summary.json.
std::string json_text(const Summary& summary);

/// Writes a temporary file and renames it to `path`. Throws InputError if the place cannot be written.
void write_json(const Summary& summary, const std::filesystem::path& path);
std::string json_text(const EquilibriumSummary& summary);
void write_json(const EquilibriumSummary& summary, const std::filesystem::path& path);

}  // namespace ricochet::contact
