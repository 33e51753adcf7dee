// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/checkpoint_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/atomic_file.hpp"
#include "base/hdf5_reader.hpp"
#include "base/hdf5_writer.hpp"

namespace ricochet::modes {

namespace {

namespace hdf5 = base::hdf5;

constexpr const char* advice = "Delete it to restart the search.";

bool finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
}

/// Whether a number from a file is a valid count of eigenvalues.
bool is_count(double value) { return value >= 0 && value < 1e15 && value == std::floor(value); }

/// Whether `values` form a valid plan. Invalid contents cause no message; they are computed again.
bool is_plan(const std::vector<double>& values) {
  if (!finite(values) || values[0] <= 0 || !is_count(values[1]) || values.size() < 5) return false;
  for (std::size_t k = 2; k < values.size(); k += 3)
    if (values[k] <= 0 || values[k + 1] >= values[k + 2]) return false;
  return true;
}

/// Whether the contents of a file form a valid slice.
/// @param header  shift, count below it, ends of the covered interval, eigenvalues
bool is_slice(const std::vector<double>& header, const std::vector<double>& shapes) {
  return finite(header) && finite(shapes) && is_count(header[1]) && header[2] <= header[3] &&
         std::is_sorted(header.begin() + 4, header.end()) &&
         (header.size() == 4 || (header[4] >= header[2] && header.back() <= header[3]));
}

/// Gathers the rows of a team in reading order on its first rank, so that files do not depend on the number
/// of ranks.
class OrderedRows {
 public:
  explicit OrderedRows(const Operators& operators)
      : comm_(operators.comm), local_(operators.key.size()), key_(parallel::gather(comm_, operators.key)) {
    const int mine = static_cast<int>(local_);
    count_.resize(static_cast<std::size_t>(parallel::size_of(comm_)));
    MPI_Allgather(&mine, 1, MPI_INT, count_.data(), 1, MPI_INT, comm_);
    start_.assign(count_.size(), 0);
    for (std::size_t r = 1; r < count_.size(); ++r) start_[r] = start_[r - 1] + count_[r - 1];
    buffer_.resize(key_.size());
  }
  std::size_t size() const { return key_.size(); }  ///< number of rows, on the first rank

  /// Gathers a column in reading order on the first rank. Collective.
  std::vector<double> gather(const double* column) {
    MPI_Gatherv(column, static_cast<int>(local_), MPI_DOUBLE, buffer_.data(), count_.data(), start_.data(),
                MPI_DOUBLE, 0, comm_);
    std::vector<double> ordered(key_.size());
    for (std::size_t i = 0; i < key_.size(); ++i) ordered[static_cast<std::size_t>(key_[i])] = buffer_[i];
    return ordered;
  }
  /// Scatters a column that the first rank holds in reading order. Collective.
  void scatter(const double* ordered, double* column) {
    for (std::size_t i = 0; i < key_.size(); ++i) buffer_[i] = ordered[static_cast<std::size_t>(key_[i])];
    MPI_Scatterv(buffer_.data(), count_.data(), start_.data(), MPI_DOUBLE, column, static_cast<int>(local_),
                 MPI_DOUBLE, 0, comm_);
  }

 private:
  MPI_Comm comm_;
  std::size_t local_;
  std::vector<std::int64_t> key_;
  std::vector<int> count_, start_;
  std::vector<double> buffer_;
};

}  // namespace

CheckpointFolder::CheckpointFolder(const parallel::Teams& teams, const Operators& operators,
                                   std::filesystem::path folder)
    : teams_(teams), operators_(operators), folder_(std::move(folder)) {}

void CheckpointFolder::save(const Plan& plan) const {
  if (folder_.empty()) return;
  const std::int64_t rows = parallel::sum(teams_.team(), operators_.local_rows);
  parallel::on_first_rank(teams_.world(), [&] {
    // Slices overlap slightly, so this size is a lower bound.
    base::check_place(folder_ / "plan.h5",
                      sizeof(double) * static_cast<double>(rows) * static_cast<double>(plan.end.below));
    hdf5::Writer file(folder_ / "plan.h5");
    file.write<double>("/end", std::vector<double>{plan.end.sigma, static_cast<double>(plan.end.below)}, {2},
                       "");
    std::vector<double> tasks;
    for (const Task& task : plan.tasks)
      tasks.insert(tasks.end(), {task.sigma, task.wanted.from, task.wanted.to});
    file.write("/tasks", tasks, {plan.tasks.size(), 3}, "rad^2/s^2");
    file.commit();
  });
}

std::optional<Checkpoint::Plan> CheckpointFolder::plan() const {
  std::vector<double> values;
  if (!folder_.empty() && parallel::rank_of(teams_.world()) == 0) {
    try {
      const hdf5::Reader file(folder_ / "plan.h5", advice);
      values = file.read<double>("/end", {2});
      const auto tasks = file.read<double>("/tasks", {hdf5::any, 3});
      values.insert(values.end(), tasks.begin(), tasks.end());
      if (!is_plan(values)) values.clear();
    } catch (const InputError&) {
      values.clear();
    }
  }
  parallel::broadcast(teams_.world(), values);
  if (values.empty()) return std::nullopt;
  Plan plan{{values[0], static_cast<std::int64_t>(values[1])}, {}};
  for (std::size_t k = 2; k + 2 < values.size(); k += 3)
    plan.tasks.push_back({values[k], {values[k + 1], values[k + 2]}});
  return plan;
}

void CheckpointFolder::save(const Slice& slice, const Eigen::MatrixXd& shape) const {
  if (folder_.empty()) return;
  OrderedRows rows(operators_);
  std::optional<hdf5::Writer> file;
  std::string complaint;
  const bool first = parallel::rank_of(teams_.team()) == 0;
  const auto on_first = [&](auto&& task) {
    if (!first || !complaint.empty()) return;
    try {
      task();
    } catch (const InputError& error) {
      complaint = error.what();
    }
  };
  on_first([&] {
    // Another run may have completed the kernel and removed this folder.
    std::error_code ignored;
    std::filesystem::create_directories(folder_, ignored);
    // The name of the file consists of the bits of the shift.
    file.emplace(folder_ / fmt::format("slice-{:016x}.h5", std::bit_cast<std::uint64_t>(slice.probe.sigma)));
    file->write<double>("/slice",
                        std::vector<double>{slice.probe.sigma, static_cast<double>(slice.probe.below),
                                            slice.covered.from, slice.covered.to},
                        {4}, "");
    file->write("/lambda", slice.lambda, {slice.lambda.size()}, "rad^2/s^2");
  });
  hdf5::Rows* out = nullptr;
  on_first([&] { out = &file->rows("/shape", {rows.size()}, "kg^-1/2"); });
  for (Eigen::Index j = 0; j < shape.cols(); ++j) {
    const std::vector<double> column = rows.gather(shape.col(j).data());
    on_first([&] { out->append(column); });
  }
  on_first([&] { file->commit(); });
  parallel::agree(teams_.team(), complaint);
}

std::vector<Checkpoint::Found> CheckpointFolder::slices() const {
  std::vector<std::filesystem::path> paths;
  if (!folder_.empty() && std::filesystem::is_directory(folder_))
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      if (entry.path().filename().string().rfind("slice-", 0) == 0 && entry.path().extension() == ".h5")
        paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  // All ranks use the list of files of the first rank.
  std::string names;
  for (const auto& path : paths) names += path.filename().string() + "\n";
  parallel::broadcast(teams_.world(), names);
  std::vector<Found> found;
  OrderedRows rows(operators_);
  for (std::size_t at = 0; at < names.size();) {
    const std::size_t end = names.find('\n', at);
    const std::filesystem::path path = folder_ / names.substr(at, end - at);
    at = end + 1;
    Found next;
    next.team = static_cast<int>(found.size()) % teams_.count();
    const bool holds = teams_.mine() == next.team;
    // The team that will hold a slice reads it and broadcasts its header.
    std::vector<double> header, values;
    if (holds && parallel::rank_of(teams_.team()) == 0) {
      try {
        const hdf5::Reader file(path, advice);
        header = file.read<double>("/slice", {4});
        const auto lambda = file.read<double>("/lambda", {hdf5::any});
        values = file.read<double>("/shape", {lambda.size(), rows.size()});
        header.insert(header.end(), lambda.begin(), lambda.end());
        if (!is_slice(header, values)) header.clear();
      } catch (const InputError&) {
        header.clear();
      }
    }
    const int root = next.team * parallel::size_of(teams_.team());
    parallel::broadcast(teams_.world(), header, root);
    if (header.empty()) continue;
    next.slice = {{header[0], static_cast<std::int64_t>(header[1])},
                  {header[2], header[3]},
                  {header.begin() + 4, header.end()}};
    if (holds) {
      next.shape.resize(operators_.local_rows, std::ssize(header) - 4);
      for (Eigen::Index j = 0; j < next.shape.cols(); ++j)
        rows.scatter(values.data() + static_cast<std::size_t>(j) * rows.size(), next.shape.col(j).data());
    }
    found.push_back(std::move(next));
  }
  return found;
}

}  // namespace ricochet::modes
