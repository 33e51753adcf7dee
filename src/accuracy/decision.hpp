// SPDX-License-Identifier: BSD-2-Clause
// Decides which settings of kernels the accuracy loop refines next. Independent of MPI.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "contact/accuracy/dial.hpp"
#include "src/accuracy/settings.hpp"

namespace ricochet::accuracy {

/// Whether the scene gives the spacing of all its candidates.
bool gives_spacing(const scene::Scene& scene);

/// Size of the eigenproblem of a body in a round.
struct BodySize {
  std::string body;
  double modes = 0;    ///< in the band of the round; of Ritz vectors, an estimate
  double vectors = 0;  ///< modes or Ritz vectors that the kernel holds
  double unknowns = 0;
  double elements = 0;
  int dimension = 3;      ///< 1: a rod
  double width = 0;       ///< smallest side of a box with the same inertia [m]
  double candidates = 0;  ///< of the kernel, if it holds all because the body turns; otherwise 0
};

struct Decision {
  std::optional<Settings> next;  ///< no value: the search ends
  std::string reason;            ///< what is refined, or why nothing is; empty if the accuracy is met
};

/// The decision after a round. It chooses the causes with the largest gain for their cost, among those that
/// can be refined, until the expected error is small enough. A refinement is not chosen if the next round
/// would exceed `most_work`.
/// @param scene  as read, with its open settings
/// @param settings  of the round, with the rate that was found
/// @param sizes  of the round, for each body
Decision decide(const scene::Scene& scene, const Settings& settings, const contact::Dialled& round,
                const std::vector<BodySize>& sizes);

/// Largest sum of (modes + candidates) × unknowns over the bodies that a refinement may lead to, since each
/// candidate has a static correction. On two cores, kernels of this size take about a minute.
inline constexpr double most_work = 1.2e8;

/// Largest number of unknowns of a body that a refinement may lead to. The factors of a solid of this size
/// take about 3 GB.
inline constexpr double most_unknowns = 1.5e5;

/// Largest expected number of candidates in the zone, or on all bodies that turn, to which finer elements
/// may lead. The static correction of as many candidates takes seconds, and so do the steps of the impact.
/// With three components, that of one body takes 290 MB.
inline constexpr double most_candidates = 2000;

}  // namespace ricochet::accuracy
