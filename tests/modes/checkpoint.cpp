// SPDX-License-Identifier: BSD-2-Clause
// Files of a search: they are read as they were written, and those that cannot be right are left out.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/hdf5_writer.hpp"
#include "src/modes/checkpoint_folder.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace checkpoint_test {

using Eigen::Index;
using Eigen::MatrixXd;
using modes::Checkpoint;
using modes::Slice;
using Numbers = std::vector<double>;

/// A rod, and an empty folder that is removed at the end.
struct Place {
  Place() {
    const test::SharedFile file(".geo", test::rod_geo(12));
    const scene::Body given = test::body_of(file.path(), 1);
    mesh = test::mesh_of(given);
    body = elasticity::assemble(mesh, given.materials, "test");
    operators = std::make_unique<modes::Operators>(mesh, body);
    const test::SharedFile name(".slices", "");
    folder = name.path().string() + ".folder";
  }
  ~Place() {
    MPI_Barrier(PETSC_COMM_WORLD);
    std::error_code ignored;
    if (parallel::rank_of(PETSC_COMM_WORLD) == 0) std::filesystem::remove_all(folder, ignored);
  }
  modes::CheckpointFolder checkpoint() const { return {test::one_team(), *operators, folder}; }
  /// Writes datasets as the first rank.
  template <class Fill>
  void write(const std::string& name, Fill&& fill) const {
    parallel::on_first_rank(PETSC_COMM_WORLD, [&] {
      std::filesystem::create_directories(folder);
      base::hdf5::Writer file(folder / name);
      fill(file);
      file.commit();
    });
  }
  mesh::GmshSession gmsh;
  mesh::Mesh mesh;
  elasticity::Body body;
  std::unique_ptr<modes::Operators> operators;
  std::filesystem::path folder;
};

TEST(CheckpointFolder, gives_back_its_plan_and_its_slices) {
  const Place place;
  EXPECT_FALSE(place.checkpoint().plan());
  EXPECT_TRUE(place.checkpoint().slices().empty());
  place.checkpoint().save(Checkpoint::Plan{{7.5, 9}, {{2, {0, 4}}, {6, {3, 8}}}});
  const MatrixXd shape = place.operators->noise(3, 1);
  place.checkpoint().save(Slice{{2, 1}, {-1, 4}, {1, 2.5, 3}}, shape);
  place.checkpoint().save(Slice{{6, 4}, {5, 5}, {}}, MatrixXd(shape.rows(), 0));

  const auto plan = place.checkpoint().plan();
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->end.sigma, 7.5);
  EXPECT_EQ(plan->end.below, 9);
  ASSERT_EQ(plan->tasks.size(), 2U);
  EXPECT_EQ(plan->tasks[0].sigma, 2);
  EXPECT_EQ(plan->tasks[1].wanted.from, 3);
  EXPECT_EQ(plan->tasks[1].wanted.to, 8);
  const auto found = place.checkpoint().slices();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].slice.probe.sigma, 2);
  EXPECT_EQ(found[0].slice.probe.below, 1);
  EXPECT_EQ(found[0].slice.covered.from, -1);
  EXPECT_EQ(found[0].slice.covered.to, 4);
  EXPECT_EQ(found[0].slice.lambda, (Numbers{1, 2.5, 3}));
  EXPECT_EQ(found[0].shape, shape);
  EXPECT_EQ(found[1].slice.probe.sigma, 6);
  EXPECT_TRUE(found[1].slice.lambda.empty());
}

TEST(CheckpointFolder, ignores_a_plan_that_cannot_be_right) {
  const Place place;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto accepted = [&](const Numbers& end, const Numbers& tasks) {
    place.write("plan.h5", [&](base::hdf5::Writer& file) {
      file.write("/end", end, {2}, "");
      file.write("/tasks", tasks, {tasks.size() / 3, 3}, "");
    });
    return place.checkpoint().plan().has_value();
  };
  const Numbers tasks{2, 0, 4, 6, 3, 8};
  EXPECT_TRUE(accepted({7.5, 9}, tasks));
  EXPECT_TRUE(accepted({7.5, 0}, {2, 0, 4}));
  for (const Numbers& end : {Numbers{0, 9}, Numbers{-1, 9}, Numbers{nan, 9}, Numbers{7.5, -1},
                             Numbers{7.5, 1e15}, Numbers{7.5, 8.5}})
    EXPECT_FALSE(accepted(end, tasks)) << end[0] << ", " << end[1];
  EXPECT_FALSE(accepted({7.5, 9}, {}));
  for (const Numbers& task : {Numbers{0, 0, 4}, Numbers{-2, 0, 4}, Numbers{2, 4, 4}, Numbers{2, 5, 4},
                              Numbers{nan, 0, 4}, Numbers{2, 0, INFINITY}}) {
    EXPECT_FALSE(accepted({7.5, 9}, task)) << task[0] << ", " << task[1] << ", " << task[2];
    Numbers two = tasks;
    std::ranges::copy(task, two.begin() + 3);
    EXPECT_FALSE(accepted({7.5, 9}, two)) << task[0] << ", " << task[1] << ", " << task[2];
  }
}

TEST(CheckpointFolder, ignores_a_slice_that_cannot_be_right) {
  const Place place;
  const std::size_t rows = static_cast<std::size_t>(place.operators->total_rows);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto accepted = [&](const Numbers& slice, const Numbers& lambda, std::size_t columns,
                            double entry = 1) {
    place.write("slice-0.h5", [&](base::hdf5::Writer& file) {
      file.write("/slice", slice, {4}, "");
      file.write("/lambda", lambda, {lambda.size()}, "");
      Numbers shape(columns * rows, 1.0);
      if (!shape.empty()) shape.back() = entry;
      file.write("/shape", shape, {columns, rows}, "");
    });
    return !place.checkpoint().slices().empty();
  };
  EXPECT_TRUE(accepted({2, 1, -1, 4}, {-1, 2.5, 4}, 3));
  EXPECT_TRUE(accepted({2, 1, 2, 2}, {}, 0));
  EXPECT_FALSE(accepted({2, 1, 2.1, 2}, {}, 0));
  EXPECT_FALSE(accepted({2, 1, -1, 4}, {2.5, 1, 3}, 3));
  EXPECT_FALSE(accepted({2, 1, -1, 4}, {-1.1, 1, 3}, 3));
  EXPECT_FALSE(accepted({2, 1, -1, 4}, {1, 2, 4.1}, 3));
  EXPECT_FALSE(accepted({2, 1, -1, 4}, {1, 2, 3}, 2));
  EXPECT_FALSE(accepted({2, 1, -1, 4}, {1, nan, 3}, 3));
  EXPECT_FALSE(accepted({2, 1, -1, 4}, {1, 2, 3}, 3, nan));
  for (const double below : {-1.0, 0.5, 1e15}) EXPECT_FALSE(accepted({2, below, -1, 4}, {1}, 1)) << below;
  EXPECT_FALSE(accepted({nan, 1, -1, 4}, {1}, 1));
  // The next slice may still be right.
  EXPECT_TRUE(accepted({2, 1, -1, 4}, {1}, 1));
}

}  // namespace checkpoint_test
}  // namespace ricochet
