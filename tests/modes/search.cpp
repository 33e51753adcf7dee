// SPDX-License-Identifier: BSD-2-Clause
// The search for modes against dense eigenvalues: with estimates that mislead it, and with slices that have
// lost a mode.
#include "src/modes/search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include "src/modes/checkpoint_folder.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace search_test {

using modes::Checkpoint;
using modes::Slice;

/// A free block on all ranks together, or on each of several teams.
struct Block {
  explicit Block(const parallel::Teams& given = test::one_team()) : Block("tet", 0.3, 1, given) {}

  /// @param stretch  along z, and half of it along y
  Block(const std::string& kind, double lean, double stretch, const parallel::Teams& given = test::one_team())
      : teams(given) {
    const test::SharedFile file(".geo", test::block_geo(kind, 2, lean));
    const scene::Body body_of_scene = test::body_of(file.path(), 2);
    mesh = test::mesh_of(body_of_scene, teams);
    for (std::size_t i = 2; i < mesh.position.size(); i += 3) {
      mesh.position[i - 1] *= (1 + stretch) / 2;
      mesh.position[i] *= stretch;
    }
    body = elasticity::assemble(mesh, body_of_scene.materials, "test");
    exact = test::dense_eigenvalues(mesh, body);
  }
  modes::Search search(const modes::Request& request, const Checkpoint& checkpoint = Checkpoint()) const {
    const modes::Operators operators(mesh, body);
    modes::Factorisation factor(body.stiffness, body.mass);
    return modes::search(teams, operators, factor, request, checkpoint, {});
  }
  mesh::GmshSession gmsh;
  const parallel::Teams& teams;
  mesh::Mesh mesh;
  elasticity::Body body;
  Eigen::VectorXd exact;  ///< ascending, six rigid ones first
};

std::vector<double> eigenvalues(const modes::Search& found) {
  std::vector<double> lambda;
  for (std::size_t s = 0; s < found.slices.size(); ++s)
    for (std::size_t k = found.share[s].first; k < found.share[s].end; ++k)
      lambda.push_back(found.slices[s].lambda[k]);
  std::ranges::sort(lambda);
  return lambda;
}

/// Expects the first elastic eigenvalues, as many as were requested, and the next one above the end.
void expect_lowest(const Block& block, const modes::Search& found, std::int64_t count) {
  const std::vector<double> lambda = eigenvalues(found);
  ASSERT_EQ(std::ssize(lambda), count - 6);
  EXPECT_EQ(found.end.below, count);
  // The tolerance on residuals of 1e-8 bounds relative errors of eigenvalues.
  for (Eigen::Index k = 6; k < count; ++k)
    EXPECT_NEAR(lambda[static_cast<std::size_t>(k - 6)] / block.exact[k], 1, 1e-8) << k;
  EXPECT_GT(found.end.sigma, block.exact[count - 1]);
  EXPECT_LT(found.end.sigma, block.exact[count]);
}

TEST(Search, finds_the_number_requested_whatever_the_estimate) {
  const Block block;
  const double middle = block.exact[40];
  const std::vector<modes::ExpectedCount> estimates{
      {},
      [&](double lambda) { return 40 * std::pow(lambda / middle, 1.5) * 1e4; },
      [&](double lambda) { return 40 * std::pow(lambda / middle, 1.5) * 1e-4; },
      [&](double lambda) { return 40 * std::pow(lambda / middle, 0.1); },
      [&](double lambda) { return 40 * std::pow(lambda / middle, 8.0); },
  };
  // With 260 modes per shift there is only one slice, and an estimate that is too high or too low finds its
  // end.
  for (const std::int64_t per_shift : {10, 260})
    for (std::size_t k = 0; k < (per_shift == 10 ? estimates.size() : 3); ++k) {
      SCOPED_TRACE(testing::Message() << "estimate " << k << ", " << per_shift << " per shift");
      expect_lowest(block,
                    block.search({.count = 36,
                                  .expected = estimates[k],
                                  .modes_per_shift = per_shift,
                                  .solver = modes::Solver::slicing}),
                    36);
    }
}

/// Relative distance of nearly equal eigenvalues.
constexpr double nearly_equal = 3e-4;

/// A cube, up to a small stretch: a third or more of its modes are nearly double or triple.
const Block& nearly_cube() {
  static const auto* cube = new Block("hex", 0, 1 + 1e-4);
  return *cube;
}

/// Keeps the number of slices planned.
class Planned : public Checkpoint {
 public:
  using Checkpoint::plan;
  using Checkpoint::save;
  void save(const Plan& plan) const override { slices = plan.tasks.size(); }
  mutable std::size_t slices = 0;
};

TEST(Search, costs_no_slice_more_than_planned_wherever_it_ends_among_nearly_equal_modes) {
  const Block& cube = nearly_cube();
  int close = 0;
  for (Eigen::Index k = 12; k < 92; ++k) close += cube.exact[k] < cube.exact[k - 1] * (1 + nearly_equal);
  EXPECT_GT(close, 20);
  for (std::int64_t count = 60; count < 68; ++count) {
    SCOPED_TRACE(count);
    const Planned plan;
    const modes::Search found =
        cube.search({.count = count, .modes_per_shift = 30, .solver = modes::Solver::slicing}, plan);
    EXPECT_GE(plan.slices, 2U);
    EXPECT_EQ(found.slices.size(), plan.slices);
    expect_lowest(cube, found, count);
  }
}

TEST(Lanczos, ends_an_interval_in_a_gap_if_it_ends_among_nearly_equal_modes) {
  const Block& cube = nearly_cube();
  const modes::Operators operators(cube.mesh, cube.body);
  modes::Factorisation factor(cube.body.stiffness, cube.body.mass);
  // The first nearly equal modes above the fortieth.
  Eigen::Index k = 40;
  while (cube.exact[k] > cube.exact[k - 1] * (1 + nearly_equal)) ++k;
  Eigen::Index first = k - 1, last = k + 1;
  while (cube.exact[first] < cube.exact[first - 1] * (1 + nearly_equal)) --first;
  while (cube.exact[last] < cube.exact[last - 1] * (1 + nearly_equal)) ++last;
  const double within = (cube.exact[k - 1] + cube.exact[k]) / 2;
  ASSERT_GT(cube.exact[k], cube.exact[k - 1] * (1 + 1e-9));
  for (const bool below : {true, false}) {
    SCOPED_TRACE(below ? "ends below" : "begins above");
    const modes::Interval wanted =
        below ? modes::Interval{0.6 * within, within} : modes::Interval{within, 1.5 * within};
    factor.factor((wanted.from + wanted.to) / 2);
    const modes::Converged found = modes::lanczos(operators, factor, wanted, {});
    const std::set<double> all(found.lambda.begin(), found.lambda.end());
    const auto number = std::ranges::count_if(all, [&](double lambda) {
      return lambda > cube.exact[first - 1] * 1.0001 && lambda < cube.exact[last] * 0.9999;
    });
    EXPECT_EQ(number, last - first);
    if (below)
      EXPECT_GT(found.covered.to, cube.exact[last - 1]);
    else
      EXPECT_LT(found.covered.from, cube.exact[first]);
  }
}

TEST(Search, of_a_cube_and_of_a_plate_has_the_number_of_modes_expected_within_a_half) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", test::block_geo("hex", 5, 0));
  const scene::Body of_scene = test::body_of(file.path(), 2);
  for (const double thickness : {1.0, 1.0 / 12}) {
    SCOPED_TRACE(thickness);
    mesh::Mesh mesh = test::mesh_of(of_scene, test::one_team());
    for (std::size_t i = 2; i < mesh.position.size(); i += 3) mesh.position[i] *= thickness;
    const elasticity::Body body = elasticity::assemble(mesh, of_scene.materials, "test");
    const modes::Operators operators(mesh, body);
    modes::Factorisation factor(body.stiffness, body.mass);
    // Fewer than forty modes have two elements or more in each half wave.
    const std::vector<double> lambda = eigenvalues(
        modes::search(test::one_team(), operators, factor, modes::request_of(body, {.count = 46}), {}, {}));
    ASSERT_GE(lambda.size(), 40U);  // multiple modes stay whole
    for (const std::size_t n : {20U, 30U, 39U}) {
      const Hertz between(std::sqrt((lambda[n - 1] + lambda[n]) / 2) / (2 * std::numbers::pi));
      const double expected = static_cast<double>(modes::expected_modes(body, between) - 6);
      EXPECT_LT(expected, 1.5 * static_cast<double>(n)) << n;
      EXPECT_GT(expected, static_cast<double>(n) / 1.5) << n;
    }
  }
}

TEST(Search, finds_no_elastic_mode_one_and_all_but_one) {
  const Block block;
  const std::int64_t all = block.exact.size();
  for (const modes::Solver solver : {modes::Solver::slicing, modes::Solver::dense})
    for (const std::int64_t count : {std::int64_t{6}, std::int64_t{7}, all - 1}) {
      SCOPED_TRACE(testing::Message() << count << (solver == modes::Solver::dense ? " dense" : " by slices"));
      // Slices of nearly all modes of a mesh may stall; the search must then go on by itself.
      expect_lowest(block, block.search({.count = count, .solver = solver}), count);
    }
}

TEST(Search, has_orthogonal_slices_whatever_the_bound_on_residuals) {
  const Block block;
  const modes::Operators operators(block.mesh, block.body);
  const modes::Search found = block.search(
      {.count = 150, .relative_residual = 1e-2, .modes_per_shift = 30, .solver = modes::Solver::slicing});
  ASSERT_GE(found.slices.size(), 4U);
  Eigen::MatrixXd shape(operators.local_rows, 0);
  for (std::size_t s = 0; s < found.slices.size(); ++s) {
    const auto first = static_cast<Eigen::Index>(found.share[s].first);
    const auto n = static_cast<Eigen::Index>(found.share[s].end) - first;
    shape.conservativeResize(Eigen::NoChange, shape.cols() + n);
    shape.rightCols(n) = found.shape[s].middleCols(first, n);
  }
  Eigen::MatrixXd gram = shape.transpose() * test::product(block.body.mass, shape);
  parallel::sum(block.mesh.comm, gram);
  gram.diagonal().array() -= 1;
  // The certificate demands this much, and round-off alone leaves 1e-12 or so.
  EXPECT_LT(test::largest_entry(gram), 1e-6);
}

/// Keeps slices in memory, and returns them without one eigenvalue.
class Memory : public Checkpoint {
 public:
  using Checkpoint::plan;
  using Checkpoint::save;
  using Checkpoint::slices;
  void save(const Plan& plan) const override {
    if (!plan_) plan_ = plan;
  }
  void save(const Slice& slice, const Eigen::MatrixXd& shape) const override {
    if (!complete) found_.push_back({slice, 0, shape});
  }
  std::optional<Plan> plan() const override { return plan_; }
  std::vector<Found> slices() const override {
    std::vector<Found> left = found_;
    std::ranges::sort(left, {}, [](const Found& found) { return found.slice.probe.sigma; });
    for (auto& [slice, team, shape] : left)
      for (std::size_t k = 0; k < slice.lambda.size(); ++k)
        if (std::abs(slice.lambda[k] / lost - 1) < 1e-7) {
          slice.lambda.erase(slice.lambda.begin() + static_cast<std::ptrdiff_t>(k));
          const auto rest = static_cast<Eigen::Index>(slice.lambda.size() - k);
          shape.middleCols(static_cast<Eigen::Index>(k), rest) = shape.rightCols(rest).eval();
          shape.conservativeResize(Eigen::NoChange, shape.cols() - 1);
        }
    return left;
  }
  bool complete = false;  ///< whether later slices are not kept
  double lost = 0;        ///< the eigenvalue that is left out

 private:
  mutable std::optional<Plan> plan_;
  mutable std::vector<Found> found_;
};

TEST(Search, finds_again_any_mode_that_its_slices_have_lost) {
  const Block block;
  const std::int64_t count = 60;
  // One slice, or several. The end is above the last shift.
  for (const std::int64_t per_shift : {260, 30}) {
    const modes::Request request{
        .count = count, .modes_per_shift = per_shift, .solver = modes::Solver::slicing};
    Memory memory;
    const modes::Search whole = block.search(request, memory);
    expect_lowest(block, whole, count);
    EXPECT_LT(whole.slices.back().probe.sigma, whole.end.sigma);
    memory.complete = true;
    // The lowest mode, modes beside the first and the last shift, and the last one below the end.
    std::set<Eigen::Index> victims{count - 1};
    if (per_shift == 30)
      for (const std::int64_t n : {std::int64_t{6}, whole.slices.front().probe.below - 1,
                                   whole.slices.back().probe.below - 1, whole.slices.back().probe.below})
        if (n < count) victims.insert(n);
    for (const Eigen::Index victim : victims) {
      SCOPED_TRACE(testing::Message() << "mode " << victim << ", " << per_shift << " per shift");
      memory.lost = block.exact[victim];
      const modes::Search again = block.search(request, memory);
      EXPECT_GT(again.slices.size(), whole.slices.size());
      expect_lowest(block, again, count);
    }
  }
}

/// A folder of slices that counts those that the ranks of this team store.
class Counted : public Checkpoint {
 public:
  Counted(const Block& block, const std::filesystem::path& folder)
      : operators_(block.mesh, block.body), folder_(block.teams, operators_, folder) {}
  void save(const Plan& plan) const override { folder_.save(plan); }
  void save(const Slice& slice, const Eigen::MatrixXd& shape) const override {
    folder_.save(slice, shape);
    ++saved;
  }
  std::optional<Plan> plan() const override { return folder_.plan(); }
  std::vector<Found> slices() const override { return folder_.slices(); }
  mutable std::int64_t saved = 0;

 private:
  modes::Operators operators_;
  modes::CheckpointFolder folder_;
};

/// Two teams if the number of ranks is even, otherwise a team for each rank.
const parallel::Teams& two_teams() {
  static const auto* teams = new parallel::Teams(
      PETSC_COMM_WORLD,
      parallel::size_of(PETSC_COMM_WORLD) % 2 == 0 ? 2 : parallel::size_of(PETSC_COMM_WORLD));
  return *teams;
}

// Files of slices do not depend on the ranks and teams that have written them, nor on those that read them.
TEST(Restart, computes_only_the_slices_that_are_missing_on_any_teams) {
  const std::int64_t count = 60;
  const modes::Request request{.count = count, .modes_per_shift = 20, .solver = modes::Solver::slicing};
  for (const parallel::Teams* writers : {&test::one_team(), &two_teams()}) {
    const parallel::Teams* readers = writers == &two_teams() ? &test::one_team() : &two_teams();
    SCOPED_TRACE(testing::Message() << writers->count() << " teams, then " << readers->count());
    const test::SharedFile place(".slices", "");
    const std::filesystem::path folder = place.path().string() + ".folder";
    {
      const Block first(*writers);
      ASSERT_GE(first.search(request, Counted(first, folder)).slices.size(), 3U);
    }
    std::filesystem::path lost;
    parallel::on_first_rank(PETSC_COMM_WORLD, [&] {
      for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().filename().string().starts_with("slice-")) lost = std::max(lost, entry.path());
      std::filesystem::remove(lost);
    });
    const Block second(*readers);
    const Counted counted(second, folder);
    const modes::Search again = second.search(request, counted);
    EXPECT_EQ(parallel::sum(second.teams.peers(), counted.saved), 1);
    expect_lowest(second, again, count);
    // The shapes on each team belong to the eigenvalues of its slices.
    const modes::Operators operators(second.mesh, second.body);
    std::int64_t modes_here = 0;
    for (std::size_t s = 0; s < again.slices.size(); ++s) {
      if (again.team[s] != second.teams.mine()) continue;
      const auto& lambda = again.slices[s].lambda;
      ASSERT_EQ(again.shape[s].cols(), std::ssize(lambda));
      const Eigen::Map<const Eigen::VectorXd> values(lambda.data(), std::ssize(lambda));
      EXPECT_LT(operators.residuals(again.shape[s], values).maxCoeff(), 1e-7) << s;
      modes_here += std::ssize(lambda);
    }
    EXPECT_GT(modes_here, 0);
    MPI_Barrier(PETSC_COMM_WORLD);
    parallel::on_first_rank(PETSC_COMM_WORLD, [&] { std::filesystem::remove_all(folder); });
  }
}

}  // namespace search_test
}  // namespace ricochet
