// SPDX-License-Identifier: BSD-2-Clause
// The settings that ricochet-kernel chooses for the accuracy of a scene, and the file that stores them beside
// the kernels, so that all scenes with these bodies use them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "src/scene/data/modes.hpp"
#include "src/scene/request.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::accuracy {

/// Elements of a body.
struct MeshSettings {
  int order = 3;
  double size_factor = 1;
  std::vector<scene::FineBall> refine{};
  bool operator==(const MeshSettings&) const = default;
};

/// Settings on which kernels depend.
struct KernelSettings {
  std::map<std::string, MeshSettings> mesh;  ///< by body; bodies that are read as they are have none
  scene::Basis basis = scene::Basis::contact;
  Hertz up_to{0};
  double flexibility_error = 0;  ///< of basis `contact`, also where a later round may change to it
  std::optional<double> zone;    ///< [m]; no value: all candidates
  bool view = true;              ///< whether kernels have the visualisation surface that the scene asks for
  Rotation rotation = Rotation::linear;  ///< of scenes that leave it open
  bool operator==(const KernelSettings&) const = default;
};

struct Settings {
  KernelSettings found;
  /// Whether they are those of the start, whose zone, basis and band no impact has chosen.
  bool pilot = false;
  /// Of bodies whose elements became smaller, the number of elements before. As many elements as then mean
  /// that the geometry fixes their number.
  std::map<std::string, double> elements_before{};
  Hertz rate{0};  ///< rate of contact steps; 0 at rest
  /// How often elements near contact became smaller only because few candidates were pressed.
  int for_few_candidates = 0;
  double missed_by =
      0;             ///< distance that was left in the round before, in which nothing touched [m]; 0: none
  double error = 0;  ///< of the round with these settings; 0: not measured yet
  double least_error = 0;  ///< smallest error of the rounds before; 0: none was measured
  int idle_rounds = 0;     ///< the last ones of these, which have hardly reduced it
  bool operator==(const Settings&) const = default;
};

/// The scene with these settings in place of those that it leaves open, and with these meshes.
scene::Scene with_settings(scene::Scene scene, const KernelSettings& settings);

/// The scene without its accuracy, so that nothing is chosen or estimated.
scene::Scene without_accuracy(scene::Scene scene);

/// The file of the settings of a scene: the one that it names, or
/// `<bodies>-<first 12 digits of a hash>.settings.toml`. The hash covers the accuracy, the data of all
/// kernels but damping, which pairs have friction and whether rotations are finite or open, but not
/// velocities, gaps or times. Throws as kernel_request does.
std::filesystem::path settings_path(const std::filesystem::path& folder, const scene::Scene& scene,
                                    scene::MeshHashes* known = nullptr);

std::string to_toml(const Settings& settings);
/// @return no value if an entry is missing or has no meaning
std::optional<Settings> parse_settings(const std::string& text);

/// Throws InputError if the file cannot be written.
void write_settings(const Settings& settings, const scene::Scene& scene, const std::filesystem::path& path);
/// @return no value if the file does not exist or is damaged
std::optional<Settings> read_settings(const std::filesystem::path& path);

}  // namespace ricochet::accuracy
