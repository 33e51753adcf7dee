// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kernels/algebra.hpp"
#include "src/modes/certify.hpp"
#include "src/modes/repair.hpp"
#include "src/modes/search.hpp"

namespace ricochet::modes {

namespace {

using kernels::multiple_mode;

/// An eigenvalue with its slice and column.
struct Place {
  double lambda;
  std::size_t slice, column;
};

std::vector<Place> places_of(const Search& found) {
  std::vector<Place> places;
  for (std::size_t s = 0; s < found.slices.size(); ++s)
    for (std::size_t k = found.share[s].first; k < found.share[s].behind; ++k)
      places.push_back({found.slices[s].lambda[k], s, k});
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.lambda < b.lambda; });
  return places;
}

/// Returns the number of elastic modes to keep if `wanted` are requested. Multiple modes are kept whole.
std::size_t kept_of(const std::vector<Place>& places, std::int64_t wanted) {
  auto kept = static_cast<std::size_t>(std::max<std::int64_t>(wanted, 0));
  while (kept > 0 && kept < places.size() &&
         places[kept].lambda < (1 + multiple_mode) * places[kept - 1].lambda)
    ++kept;
  return std::min(kept, places.size());
}

}  // namespace

void ModeSet::store(const parallel::Teams& teams, const Operators& operators, Eigen::Index first,
                    const Eigen::MatrixXd& vectors) {
  const Eigen::Index r = operators.rigid.cols(), rigid = teams.mine() == 0 ? r : 0;
  shape.resize(vectors.rows(), rigid + vectors.cols());
  shape.leftCols(rigid) = operators.rigid.leftCols(rigid);
  shape.rightCols(vectors.cols()) = vectors;
  for (Eigen::Index j = 0; j < rigid; ++j) index.push_back(j);
  for (Eigen::Index j = 0; j < vectors.cols(); ++j) index.push_back(r + first + j);
  fix_signs(operators, shape);
}

Eigen::MatrixXd ModeSet::gather(const parallel::Teams& teams, const Eigen::MatrixXd& mine) const {
  Eigen::MatrixXd all =
      Eigen::MatrixXd::Zero(mine.rows(), static_cast<Eigen::Index>(angular_frequency.size()));
  for (std::size_t j = 0; j < index.size(); ++j) all.col(index[j]) = mine.col(static_cast<Eigen::Index>(j));
  parallel::sum(teams.peers(), all);
  return all;
}

void refuse_more_than_there_are(std::optional<std::int64_t> count, const elasticity::Body& body) {
  if (body.free_rows == 0)
    throw InputError("the supports hold every node of the mesh: hold fewer, or refine the mesh");
  if (count && *count > body.free_rows)
    throw InputError(
        fmt::format("modes.count = {}: the body has {} free displacements: request fewer, or refine the mesh",
                    *count, body.free_rows));
}

ModeSet compute_modes(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                      Factorisation& factor, const Request& request, const Progress& progress) {
  refuse_more_than_there_are(request.count, body);
  const Operators operators(mesh, body);
  if (request.up_to) operators.refuse_band(*request.up_to, true);
  const Eigen::Index r = operators.rigid.cols();
  Search found = search(teams, operators, factor, request, progress);
  progress.begin("certificate");

  std::vector<Place> places = places_of(found);
  std::size_t kept = request.count ? kept_of(places, *request.count - r) : places.size();
  const auto middle = [&](std::size_t k) {
    return ((k > 0 ? places[k - 1].lambda : 0) + places[k].lambda) / 2;
  };
  // If residuals may be large, a double mode can look like two, with a gap that does not exist.
  Probe at_cut = found.end;
  for (; kept < places.size(); ++kept)
    if (at_cut = count_below(teams, factor, middle(kept));
        at_cut.below == r + static_cast<std::int64_t>(kept))
      break;
  if (kept == places.size()) at_cut = found.end;
  ModeSet set;
  set.cut = at_cut.sigma;
  // This shift is far enough from zero for rigid motions to be harmless, and close enough for the series in
  // σ/λ_cut to converge fast.
  set.static_shift = -1e-3 * set.cut;
  places.resize(kept);
  std::vector<Probe> counts;
  for (const Slice& slice : found.slices)
    if (slice.probe.sigma < set.cut) counts.push_back(slice.probe);
  counts.push_back(at_cut);

  // Moves the modes of one slice after another; the shapes of a slice are released as soon as they are moved.
  const bool holds_rigid = teams.mine() == 0;
  std::vector<Eigen::Index> columns_of(found.slices.size(), 0);
  for (const Place& place : places) ++columns_of[place.slice];
  Eigen::Index own = holds_rigid ? r : 0;
  for (std::size_t s = 0; s < found.slices.size(); ++s)
    if (found.team[s] == teams.mine()) own += columns_of[s];
  set.shape.resize(body.local_rows, own);
  if (holds_rigid) {
    set.shape.leftCols(r) = operators.rigid;
    for (Eigen::Index j = 0; j < r; ++j) set.index.push_back(j);
  }
  // Slices, and therefore their shares, are in ascending order.
  Eigen::Index at = static_cast<Eigen::Index>(set.index.size()), number = r;
  for (std::size_t s = 0; s < found.slices.size(); ++s) {
    const Eigen::Index n = columns_of[s];
    if (found.team[s] == teams.mine() && n > 0) {
      const auto first = static_cast<Eigen::Index>(found.share[s].first);
      set.shape.middleCols(at, n) = found.shape[s].middleCols(first, n);
      found.shape[s].resize(0, 0);
      for (Eigen::Index j = 0; j < n; ++j) set.index.push_back(number + j);
      at += n;
    }
    number += n;
  }
  set.angular_frequency.assign(static_cast<std::size_t>(r), 0);
  for (const Place& place : places) set.angular_frequency.push_back(std::sqrt(place.lambda));
  fix_signs(operators, set.shape);
  std::vector<Eigen::Index> doubtful = certify(teams, operators, counts, request.relative_residual, set);
  for (int attempt = 0; attempt < 3 && !doubtful.empty(); ++attempt) {
    repair(teams, operators, factor, doubtful, set);
    doubtful = certify(teams, operators, counts, request.relative_residual, set);
  }
  refuse_incomplete(set, doubtful);
  return set;
}

}  // namespace ricochet::modes
