// SPDX-License-Identifier: BSD-2-Clause
// The impact of one round of the search for settings: its kernels are paired, and then its settings are
// chosen. On one rank.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "src/accuracy/decision.hpp"
#include "src/accuracy/scene_dial.hpp"
#include "src/scene/scene.hpp"
#include "src/store/placing.hpp"
#include "src/store/stored_kernels.hpp"

namespace ricochet::accuracy {

/// The bodies of a round at their places, before a model is made of them.
struct PairedRound {
  scene::Scene scene;  ///< with the settings of the round
  store::Kernels kernels;
  store::Prepared prepared;
  std::string memory;  ///< that the impact will need, in words
};

/// Reads the kernels of a round from a folder and pairs the bodies. Throws InputError if they overlap or do
/// not meet, or if the impact does not fit into memory.
/// @param scene  with the settings of the round
PairedRound pair_round(scene::Scene scene, const std::filesystem::path& folder);

/// Size of the eigenproblem of each body. @param band  of the round
std::vector<BodySize> sizes_of(const PairedRound& round, Hertz band);

/// Chooses the settings of the steps and estimates the errors. The model of the result refers to the kernels
/// of the round. @param rate  of the round before; 0: unknown
Dialled dialled_of(const PairedRound& round, Hertz rate);

}  // namespace ricochet::accuracy
