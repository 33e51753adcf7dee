// SPDX-License-Identifier: BSD-2-Clause
// Combines data about entities that several ranks hold, such as the nodes between two parts of a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "src/parallel/parallel.hpp"

namespace ricochet::mesh {

/// Combines the values that several ranks hold for the same tag. Each rank is responsible for a range of
/// tags, so that no rank stores all of them.
class Directory {
 public:
  /// Collective.
  /// @param tags  tags of this rank, distinct and not negative
  Directory(MPI_Comm comm, const std::vector<std::int64_t>& tags);

  /// Returns, for each tag of this rank, the number of distinct lower tags on all ranks. Collective.
  std::vector<std::int64_t> order() const;

  /// Returns, for each tag of this rank, the values of all ranks for this tag, combined by `both(a, b)`.
  /// Collective.
  template <class T, class Both>
  std::vector<T> combined(const std::vector<T>& values, Both both) const {
    std::vector<std::vector<T>> asked(place_.size());
    for (std::size_t r = 0; r < place_.size(); ++r)
      for (std::size_t i : place_[r]) asked[r].push_back(values[i]);
    std::vector<std::vector<T>> received = parallel::exchange(comm_, asked);
    std::vector<std::optional<T>> all(entries_);
    for (std::size_t r = 0; r < received.size(); ++r)
      for (std::size_t k = 0; k < received[r].size(); ++k) {
        std::optional<T>& value = all[entry_[r][k]];
        value = value ? both(*value, received[r][k]) : received[r][k];
      }
    for (std::size_t r = 0; r < received.size(); ++r)
      for (std::size_t k = 0; k < received[r].size(); ++k) received[r][k] = *all[entry_[r][k]];
    return answered(received);
  }

 private:
  /// Sends each rank the answers to its requests; returns the answers for this rank's tags.
  template <class T>
  std::vector<T> answered(const std::vector<std::vector<T>>& answers) const {
    const std::vector<std::vector<T>> answers_here = parallel::exchange(comm_, answers);
    std::vector<T> result(tags_);
    for (std::size_t r = 0; r < place_.size(); ++r)
      for (std::size_t k = 0; k < place_[r].size(); ++k) result[place_[r][k]] = answers_here[r][k];
    return result;
  }

  MPI_Comm comm_;
  std::size_t tags_;
  std::vector<std::vector<std::size_t>> place_;  ///< by responsible rank: indices of this rank's tags
  std::vector<std::vector<std::size_t>> entry_;  ///< by requesting rank: indices of its tags here
  std::size_t entries_ = 0;
  std::int64_t lower_ = 0;  ///< number of entries on lower ranks
};

}  // namespace ricochet::mesh
