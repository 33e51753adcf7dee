// SPDX-License-Identifier: BSD-2-Clause
// Result files: their contents after a run, and their absence until it ends.
#include "contact/files/recorder.hpp"
#include "base/hdf5_reader.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/contact/bodies.hpp"
#include "tests/support.hpp"

namespace recorder_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;
using ricochet::base::hdf5::any;
using ricochet::base::hdf5::Reader;
using ricochet::base::hdf5::Shape;
using ricochet::test::Folder;

constexpr int modes = 12;
constexpr double length = 10, step = 0.1;

/// A rod at speed 1 approaches a rod at rest, 0.25 m away.
Model rods(const Kernel& kernel) {
  return build_model({{"left", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {1, 0, 0}},
                      {"right", &kernel, Matrix3d::Identity(), {length + 0.25, 0, 0}}},
                     {}, {{"left", "right", Vector3d(1, 0, 0), {}, {}}}, Vector3d::Zero());
}

std::unique_ptr<Stepper> run(const Model& model, const StepOptions& options, int steps, Recorder& recorder) {
  auto stepper = make_stepper(model, options);
  for (int k = 0; k < steps; ++k) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    recorder.record(*stepper);
  }
  return stepper;
}

Reader open(const Folder& folder) { return {folder / "rods.result.h5", ""}; }

std::vector<double> read(const Reader& file, const std::string& name, const Shape& shape,
                         const std::string& unit) {
  EXPECT_EQ(file.string_attribute(name, "unit"), unit) << name;
  return file.read<double>(name, shape);
}

TEST(Result, holds_every_dataset_with_its_shape_and_unit) {
  const Folder folder;
  const Kernel kernel = rod(modes, length);
  const Model model = rods(kernel);
  const StepOptions options{.step = step};
  constexpr int steps = 300;
  Recorder recorder(model, options,
                    {.path = folder / "rods.result.h5",
                     .title = "Two rods",
                     .scene = "title = \"Two rods\"\n",
                     .created_by = "test",
                     .kernel_files = {"left.kernel.h5", "right.kernel.h5"},
                     .snapshot_every = 100});
  const auto end = run(model, options, steps, recorder);
  recorder.commit();

  const Reader file = open(folder);
  EXPECT_EQ(file.string_attribute("/", "format"), "ricochet-result");
  EXPECT_EQ(file.integer_attribute("/", "version"), 1);
  EXPECT_EQ(file.string_attribute("/", "title"), "Two rods");
  EXPECT_EQ(file.string_attribute("/", "scene"), "title = \"Two rods\"\n");
  EXPECT_EQ(file.string_attribute("/", "created_by"), "test");
  EXPECT_EQ(file.string_attribute("/bodies/right", "kernel"), "right.kernel.h5");
  EXPECT_EQ(file.doubles_attribute("/bodies/right", "translation", 3), (std::vector<double>{10.25, 0, 0}));
  EXPECT_EQ(file.doubles_attribute("/bodies/right", "rotation", 9),
            (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(file.double_attribute("/bodies/right", "mass"), length);

  const std::size_t K = steps + 1;
  const auto time = read(file, "/time", {K}, "s");
  EXPECT_EQ(time.front(), 0);
  EXPECT_EQ(time.back(), end->time());
  EXPECT_EQ(read(file, "/contact/point_a", {1, 3}, "m"), (std::vector<double>{10, 0, 0}));
  EXPECT_EQ(read(file, "/contact/point_b", {1, 3}, "m"), (std::vector<double>{10.25, 0, 0}));
  EXPECT_EQ(read(file, "/contact/normal", {1, 3}, "1"), (std::vector<double>{1, 0, 0}));
  EXPECT_EQ(read(file, "/contact/initial_gap", {1}, "m"), (std::vector<double>{0.25}));
  EXPECT_EQ(read(file, "/contact/area", {1}, "m^2"), (std::vector<double>{1}));
  for (const std::string name : {"total", "kinetic", "strain", "residual", "loads", "damping", "contact"})
    EXPECT_EQ(read(file, "/energy/" + name, {K}, "J").size(), K);
  for (const std::string body : {"/bodies/left", "/bodies/right"}) {
    read(file, body + "/velocity", {K, 3}, "m/s");
    read(file, body + "/angular_momentum", {K, 3}, "kg m^2/s");
    read(file, body + "/reaction", {K, 3}, "N");
  }
  read(file, "/contact/persistency", {K}, "W");

  // Energy is the sum of its parts, initially ½ · 10 kg · (1 m/s)² = 5 J.
  const auto total = file.read<double>("/energy/total", {K}),
             kinetic = file.read<double>("/energy/kinetic", {K});
  const auto strain = file.read<double>("/energy/strain", {K}),
             residual = file.read<double>("/energy/residual", {K});
  EXPECT_NEAR(total.front(), 5, 1e-14);
  EXPECT_NEAR(kinetic.front(), 5, 1e-14);
  for (std::size_t k = 0; k < K; ++k) EXPECT_NEAR(total[k], kinetic[k] + strain[k] + residual[k], 1e-13);

  // The recorded contact forces transfer momentum from one rod to the other.
  const auto touching = read(file, "/contact/time", {any}, "s");
  const std::size_t k = touching.size();
  EXPECT_NEAR(touching.front(), 0.3, 1e-12);  // the step in which a gap of 0.25 m closes at speed 1 ends here
  ASSERT_GT(k, 150U);                         // 2L/c = 20 s of contact, up to the waves of few modes
  const auto force = read(file, "/contact/force", {k, 1}, "N");
  double impulse = 0;
  for (const double lambda : force) impulse += lambda * step;
  const auto left = read(file, "/bodies/left/momentum", {K, 3}, "kg m/s");
  const auto right = read(file, "/bodies/right/momentum", {K, 3}, "kg m/s");
  EXPECT_NEAR(left.front(), 10, 1e-13);
  EXPECT_NEAR(left[3 * steps], 10 - impulse, 1e-11);
  EXPECT_NEAR(right[3 * steps], impulse, 1e-11);

  // Gaps and displacements along n are consistent. Touching points have no gap, because the compliant scheme
  // closes it at the end of each step. In the last two steps, the mean force acts on open points.
  const auto gap = read(file, "/contact/gap", {k, 1}, "m");
  const auto u_a = read(file, "/contact/displacement_a", {k, 1}, "m");
  const auto u_b = read(file, "/contact/displacement_b", {k, 1}, "m");
  read(file, "/contact/velocity_a", {k, 1}, "m/s");
  read(file, "/contact/velocity_b", {k, 1}, "m/s");
  for (std::size_t row = 0; row < k; ++row) {
    EXPECT_GT(gap[row], -1e-12);
    EXPECT_TRUE(gap[row] < 1e-12 || row + 2 >= k) << row;
    EXPECT_NEAR(u_a[row] - u_b[row], 0.25 - gap[row], 1e-12);
  }

  // Coordinates and forces of a snapshot give the displacement of the end that touches, candidate 1 of the
  // left rod and 0 of the right one.
  const auto pressed = read(file, "/static/left/snapshot", {any}, "1");
  const std::size_t pressing = pressed.size();
  ASSERT_GE(pressing, 1U);
  EXPECT_EQ(pressed.front(), 1);
  EXPECT_EQ(read(file, "/static/left/candidate", {pressing}, "1").front(), 1);
  EXPECT_EQ(read(file, "/static/right/candidate", {pressing}, "1").front(), 0);
  const double on_left = read(file, "/static/left/force", {pressing, 1}, "N").front();
  EXPECT_LT(on_left, -0.1);
  EXPECT_EQ(read(file, "/static/right/force", {pressing, 1}, "N").front(), -on_left);
  const auto left_q = read(file, "/snapshots/left", {4, modes}, "kg^1/2 m");
  double end_moved = kernel.surface.residual_flexibility[3] * on_left;
  for (std::size_t n = 0; n < modes; ++n) end_moved += kernel.surface.shape[modes + n] * left_q[modes + n];
  const auto then = std::ranges::lower_bound(touching, 10 - 1e-9) - touching.begin();
  EXPECT_NEAR(touching[static_cast<std::size_t>(then)], 10, 1e-12);
  EXPECT_NEAR(end_moved, u_a[static_cast<std::size_t>(then)], 1e-12);
  EXPECT_EQ(read(file, "/contact/pair", {1}, "1"), (std::vector<double>{1}));

  const auto when = read(file, "/snapshots/time", {4}, "s");
  EXPECT_NEAR(when[1], 10, 1e-12);
  const auto q = read(file, "/snapshots/right", {4, modes}, "kg^1/2 m");
  for (int n = 0; n < modes; ++n)
    EXPECT_EQ(q[static_cast<std::size_t>(3 * modes + n)], end->modal()->q(modes + n));
  EXPECT_EQ(file.shape("/snapshots/left"), (Shape{4, modes}));
}

/// Against a wall, the entire relative displacement is that of the rod, including the parts of the residual
/// and of fast modes. With a step of 0.6, modes with ω Δ > π are quasi-static, that is n > 16.
TEST(Result, gives_body_a_its_share_of_residual_and_fast_modes) {
  const Kernel kernel = rod(20, length);
  const Model one = build_model({{"rod", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {1, 0, 0}}},
                                {{"wall", Vector3d(length, 0, 0), Vector3d(-1, 0, 0)}},
                                {{"rod", "wall", {}, {}, {}}}, Vector3d::Zero());
  // The same rod against its mirror image. By symmetry, each rod moves as it does against the wall.
  const Model two =
      build_model({{"rod", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {1, 0, 0}},
                   {"mirror", &kernel, turn(std::numbers::pi, {0, 0, 1}), {2 * length, 0, 0}, {-1, 0, 0}}},
                  {}, {{"rod", "mirror", Vector3d(1, 0, 0), {}, {}}}, Vector3d::Zero());
  const StepOptions options{.step = 0.6};
  std::vector<double> displacement[2], velocity[2];
  for (int which = 0; which < 2; ++which) {
    const Folder folder;
    const auto folded = fold(borrowed(which == 0 ? one : two), options);
    const Model& model = *folded;
    Recorder recorder(model, options, {.path = folder / "rods.result.h5"});
    EXPECT_GT(run(model, options, 25, recorder)->modal()->modes_in_residual(), 0);
    recorder.commit();
    displacement[which] = open(folder).read<double>("/contact/displacement_a", {any, 1});
    velocity[which] = open(folder).read<double>("/contact/velocity_a", {any, 1});
    if (which == 1) {
      const auto mirrored = open(folder).read<double>("/contact/displacement_b", {any, 1});
      for (std::size_t k = 0; k < mirrored.size(); ++k) EXPECT_NEAR(mirrored[k], -displacement[1][k], 1e-12);
    }
  }
  ASSERT_GT(displacement[0].size(), 10U);
  ASSERT_EQ(displacement[0].size(), displacement[1].size());
  for (std::size_t k = 0; k < displacement[0].size(); ++k) {
    EXPECT_NEAR(displacement[0][k], 0, 1e-12);  // the wall is rigid
    EXPECT_NEAR(displacement[1][k], 0, 1e-12);
    EXPECT_NEAR(velocity[0][k], velocity[1][k], 1e-12);
  }
}

TEST(Result, writes_each_nth_step) {
  const Kernel kernel = rod(modes, length);
  const Model model = rods(kernel);
  const StepOptions options{.step = step};
  std::vector<double> force[2];
  for (const int every : {1, 3}) {
    const Folder folder;
    Recorder recorder(model, options, {.path = folder / "rods.result.h5", .every = every});
    run(model, options, 100, recorder);
    recorder.commit();
    const Reader file = open(folder);
    const std::size_t rows = static_cast<std::size_t>(100 / every + 1);
    EXPECT_NEAR(file.read<double>("/time", {rows})[1], every * step, 1e-15);
    file.read<double>("/energy/total", {rows});
    file.read<double>("/bodies/left/velocity", {rows, 3});
    EXPECT_FALSE(file.exists("/snapshots/time"));
    force[every == 3] = file.read<double>("/contact/force", {any, 1});
    const std::size_t touching = every == 1 ? 98 : 33;  // in all steps from the third on
    EXPECT_NEAR(file.read<double>("/contact/time", {touching})[0], 0.3, 1e-15);
  }
  for (std::size_t k = 0; k < 33; ++k) EXPECT_EQ(force[1][k], force[0][3 * k]);
}

/// A critically damped unit mass on a spring. If it does not reach the floor, the support carries its weight
/// in the end. If it rests on the floor, support and floor share the weight.
TEST(Reaction, of_a_support_ends_as_the_weight_that_no_contact_carries) {
  Kernel kernel;
  kernel.mass = 1;
  kernel.supported = true;
  add_candidate(kernel, {0, 0, 0}, {0, 0, -1}, 1);
  kernel.surface.element_corners = 1;
  kernel.surface.element = {0};
  kernel.modes.angular_frequency = {20};
  kernel.modes.decay_rate = {20};
  kernel.surface.shape = {0, 0, 1};
  kernel.loads.body_force = {0, 0, 1};
  kernel.loads.rotation = {0, 0, 0};
  const double sag = 9.81 / 400;
  for (const double share : {1.0, 0.25}) {  // share of the weight on the support; 1 without contact
    const double depth = share < 1 ? share * sag : 2 * sag;
    const Model model =
        build_model({{"mass", &kernel}}, {{"floor", Vector3d(0, 0, -depth), Vector3d(0, 0, 1)}},
                    {{"mass", "floor", {}, {}, {}}}, {0, 0, -9.81});
    for (const int every : {1, 7}) {
      const Folder folder;
      const StepOptions options{.step = 1e-3};
      Recorder recorder(model, options, {.path = folder / "rods.result.h5", .every = every});
      run(model, options, 7000, recorder);
      recorder.commit();
      const std::size_t rows = static_cast<std::size_t>(7000 / every + 1);
      const auto reaction = open(folder).read<double>("/bodies/mass/reaction", {rows, 3});
      EXPECT_EQ(reaction[2], 0);
      EXPECT_NEAR(reaction[3 * rows - 1], share * 9.81, 1e-9) << every;  // the motion has decayed by e^-140
    }
  }
}

TEST(Files, that_are_not_finished_leave_nothing) {
  const Folder folder;
  const Kernel kernel = rod(modes, length);
  const Model model = rods(kernel);
  const StepOptions options{.step = step};
  {
    Recorder recorder(model, options, {.path = folder / "rods.result.h5"});
    run(model, options, 2000, recorder);
    EXPECT_FALSE(std::filesystem::exists(folder / "rods.result.h5"));
    EXPECT_FALSE(folder.entries() == 0);  // the temporary file
  }
  EXPECT_TRUE(folder.entries() == 0);
}

TEST(Files, can_not_be_made_in_folders_that_are_not_there) {
  const Kernel kernel = rod(modes, length);
  const Model model = rods(kernel);
  const std::string text =
      complaint_of([&] { Recorder(model, {.step = step}, {.path = "/nowhere/at/all.result.h5"}); });
  EXPECT_NE(text.find("/nowhere/at/all.result.h5"), std::string::npos) << text;
}

}  // namespace recorder_test
