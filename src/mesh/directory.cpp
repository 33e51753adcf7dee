// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/directory.hpp"

#include <algorithm>

namespace ricochet::mesh {

Directory::Directory(MPI_Comm comm, const std::vector<std::int64_t>& tags)
    : comm_(comm),
      tags_(tags.size()),
      place_(static_cast<std::size_t>(parallel::size_of(comm))),
      entry_(place_.size()) {
  // Ranges of equal length are balanced, because gmsh skips few tags.
  std::int64_t last = 0;
  for (std::int64_t tag : tags) last = std::max(last, tag);
  MPI_Allreduce(MPI_IN_PLACE, &last, 1, MPI_INT64_T, MPI_MAX, comm);
  const std::int64_t range = last / static_cast<std::int64_t>(place_.size()) + 1;
  std::vector<std::vector<std::int64_t>> asked(place_.size());
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const auto r = static_cast<std::size_t>(tags[i] / range);
    place_[r].push_back(i);
    asked[r].push_back(tags[i]);
  }
  const std::vector<std::vector<std::int64_t>> heard = parallel::exchange(comm, asked);
  std::vector<std::int64_t> all;
  for (const auto& list : heard) all.insert(all.end(), list.begin(), list.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  entries_ = all.size();
  for (std::size_t r = 0; r < heard.size(); ++r)
    for (std::int64_t tag : heard[r])
      entry_[r].push_back(
          static_cast<std::size_t>(std::lower_bound(all.begin(), all.end(), tag) - all.begin()));
  lower_ = parallel::sum_before(comm, static_cast<std::int64_t>(entries_));
}

std::vector<std::int64_t> Directory::order() const {
  std::vector<std::vector<std::int64_t>> answers(entry_.size());
  for (std::size_t r = 0; r < entry_.size(); ++r)
    for (std::size_t entry : entry_[r]) answers[r].push_back(lower_ + static_cast<std::int64_t>(entry));
  return answered(answers);
}

}  // namespace ricochet::mesh
