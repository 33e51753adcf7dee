// SPDX-License-Identifier: BSD-2-Clause
// The records that a study keeps: the rows of the total force. Those of other quantities are compared with
// result files in tests/programs/sweep.py.
#include "contact/files/records.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "base/hdf5_reader.hpp"
#include "tests/contact/falling_body.hpp"
#include "tests/support.hpp"

namespace records_test {

using namespace ricochet::contact;
using ricochet::StepOptions;
using ricochet::StepStatus;
using ricochet::base::hdf5::any;
using ricochet::base::hdf5::Reader;
using ricochet::contact::test::dropped;
using ricochet::test::Folder;

constexpr double step = 1e-5;

struct Bounces {
  std::vector<double> contact_time, force;  ///< of the steps with a force, as in a result file
  std::vector<double> time, total_force;    ///< of the records
  std::size_t episodes = 0;
};

/// Drops a body of two points that bounces. @param every  as in RecorderOptions
Bounces bounce(std::int64_t every) {
  const Folder folder;
  const Model model = dropped(3, 2, 1e-3);
  const StepOptions options{.step = step, .steps_per_sample = 4};
  const auto stepper = make_stepper(model, options);
  Records records(model, options, {.force = true, .every = every});
  Bounces out;
  bool touching = false;
  while (stepper->time() < 0.08) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    records.record(*stepper);
    const Vector& force = stepper->force();
    const bool touched = std::exchange(touching, force(0) > 0 || force(1) > 0);
    if (!touching) continue;
    if (!touched) ++out.episodes;
    if (stepper->steps() % every != 0) continue;
    out.contact_time.push_back(stepper->time());
    out.force.push_back(force(0) + force(1));
  }
  std::ofstream(folder / "kept.h5", std::ios::binary) << records.file();
  const Reader kept(folder / "kept.h5", "");
  out.time = kept.read<double>("/contact/time", {any});
  out.total_force = kept.read<double>("/contact/total_force", {any});
  EXPECT_EQ(kept.string_attribute("/contact/total_force", "unit"), "N");
  return out;
}

TEST(TotalForce, is_that_of_every_step_of_contact_with_0_around_each_episode) {
  for (const std::int64_t every : {1, 3}) {
    const Bounces run = bounce(every);
    ASSERT_GE(run.episodes, 3U);
    std::vector<double> time, force;
    std::size_t zeros = 0;
    const double row = step * static_cast<double>(every), round_off = 1e-3 * row;
    for (std::size_t k = 0; k < run.time.size(); ++k) {
      EXPECT_GT(run.time[k], k > 0 ? run.time[k - 1] : -1);
      if (run.total_force[k] > 0) {
        time.push_back(run.time[k]);
        force.push_back(run.total_force[k]);
        continue;
      }
      ++zeros;
      // An episode begins one row later, or has ended one row before.
      EXPECT_TRUE(std::ranges::any_of(run.contact_time, [&](double t) {
        return std::abs(std::abs(t - run.time[k]) - row) < round_off;
      })) << run.time[k];
    }
    EXPECT_EQ(time, run.contact_time);
    EXPECT_EQ(force, run.force);  // a sum of two numbers has one order
    // So that a straight line to the first row of the next episode stays at 0.
    EXPECT_EQ(run.total_force.front(), 0);
    EXPECT_EQ(zeros % 2, 0U);
    EXPECT_GE(zeros, 2 * (run.episodes - 1));
  }
}

}  // namespace records_test
