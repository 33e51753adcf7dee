// SPDX-License-Identifier: BSD-2-Clause
// Result files of bodies that turn: entries for the points with a force.
#include "contact/files/entry_rows.hpp"

#include <gtest/gtest.h>

#include "base/hdf5_reader.hpp"
#include "contact/files/recorder.hpp"
#include "tests/contact/cloud.hpp"
#include "tests/support.hpp"

namespace ricochet::contact::test {
namespace {

using base::hdf5::any;
using base::hdf5::Reader;
using base::hdf5::Shape;

struct Row {
  double time;
  Vector force, gap;
};

class EntryRows : public testing::TestWithParam<bool> {};

/// A body bounces and tumbles. Each row has the points with a force, those and no others.
TEST_P(EntryRows, hold_the_points_with_a_force) {
  const bool rubs = GetParam();
  const ricochet::test::Folder folder;
  const Cloud cloud({0.05, 0.04, 0.03}, 2000, 1e-8, 6);
  Drop drop{.rotation = turn(0.4, {1, 0.5, 0}), .spin = {3, 9, 0}, .height = 2e-3};
  if (rubs) drop.friction = Friction{0.5, 0.5, 0};
  const auto model = over_floor(cloud, drop);
  const auto options = stepping(1e5);
  const auto stepper = make_stepper(model, options);
  Recorder recorder(*model, options, {.path = folder / "r.h5", .every = 3});
  std::vector<Row> expected;
  for (int k = 1; k <= 6000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    recorder.record(*stepper);
    if (k % 3 == 0 && (stepper->force().array() > 0).any())
      expected.push_back({stepper->time(), stepper->force(), model->gap - stepper->displacement().head(26)});
  }
  recorder.commit();

  const Reader file(folder / "r.h5", "");
  EXPECT_EQ(file.integer_attribute("/", "version"), 2);
  const std::size_t rows = expected.size();
  ASSERT_GT(rows, 20);
  const auto time = file.read<double>("/contact/time", {rows}),
             first = file.read<double>("/contact/first", {rows});
  const auto point = file.read<double>("/contact/point", {any});
  const std::size_t e = point.size();
  EXPECT_LT(e, 4 * rows) << "few of 26 points touch";
  const auto force = file.read<double>("/contact/force", {e}), gap = file.read<double>("/contact/gap", {e});
  const auto place = file.read<double>("/contact/place", {e, 3}),
             normal = file.read<double>("/contact/normal_now", {e, 3});
  for (std::size_t row = 0; row < rows; ++row) {
    EXPECT_EQ(time[row], expected[row].time);
    const auto from = static_cast<std::size_t>(first[row]),
               to = row + 1 < rows ? static_cast<std::size_t>(first[row + 1]) : e;
    Vector found = Vector::Zero(26);
    for (std::size_t j = from; j < to; ++j) {
      const auto i = static_cast<Eigen::Index>(point[j]);
      found(i) = force[j];
      EXPECT_EQ(gap[j], expected[row].gap(i));
      EXPECT_EQ(Vector3d(normal[3 * j], normal[3 * j + 1], normal[3 * j + 2]), -Vector3d::UnitZ());
      EXPECT_NEAR(place[3 * j + 2], gap[j], 1e-15) << "of the place above the floor";
    }
    EXPECT_EQ(found, expected[row].force.head(26)) << row;
  }
  const std::vector<std::pair<std::string, std::string>> units{
      {"time", "s"}, {"first", "1"}, {"point", "1"},     {"force", "N"},
      {"gap", "m"},  {"place", "m"}, {"normal_now", "1"}};
  for (const auto& [name, unit] : units)
    EXPECT_EQ(file.string_attribute("/contact/" + name, "unit"), unit) << name;
  for (const std::string name : {"displacement_a", "displacement_b", "velocity_a", "velocity_b"})
    EXPECT_FALSE(file.exists("/contact/" + name)) << name;
  for (const std::string name : {"tangential_force", "tangential_displacement", "state"})
    EXPECT_EQ(file.exists("/contact/" + name), rubs) << name;
  if (rubs) {
    EXPECT_EQ(file.shape("/contact/tangential_force"), (Shape{e, 3}));
  }
  EXPECT_EQ(file.read_strings("/contact/side_a", 1), std::vector<std::string>{"cloud"});
  EXPECT_EQ(file.read_strings("/contact/side_b", 1), std::vector<std::string>{"floor"});
}

INSTANTIATE_TEST_SUITE_P(Friction, EntryRows, testing::Bool());

}  // namespace
}  // namespace ricochet::contact::test
