// SPDX-License-Identifier: BSD-2-Clause
// Kernels without the candidates beyond reach give the same pairs and the same
// model, and warn if reach was too small.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "contact/figures/summary_observer.hpp"
#include "contact/pairing/placement.hpp"
#include "kernels/algebra.hpp"
#include "tests/contact/plate.hpp"

namespace reach_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

using Points = std::vector<std::int64_t>;
const Vector3d up(0, 0, 1);

/// The kernel with only the candidates `kept`, as reach would leave it.
Kernel cut(const Kernel& kernel, const Points& kept) {
  auto whole = ricochet::kernels::whole_surface(kernel.surface);
  Kernel out = ricochet::kernels::restricted_to_points(kernel, kept);
  whole.held = kept;
  out.surface.whole = whole;
  return out;
}

TEST(KernelsWithinReach, pair_as_those_of_whole_surfaces) {
  const Kernel small = cap(8, 1, 0.3), big = cap(40, 3, 0.3);
  for (const auto& direction : {std::optional<Vector3d>(up), std::optional<Vector3d>()})
    for (const auto& gap : {std::optional<double>(0.01), std::optional<double>()}) {
      const PairRequest request{"a", "b", direction, gap, gap.value_or(0.2) + 0.05};
      const auto placed = [&](const Kernel& a, const Kernel& b) {
        return std::vector<PlacedBody>{{"a", &a}, {"b", &b, upside_down(), 4.2 * up}};
      };
      const auto whole = placed(small, big);
      const auto needed = paired_candidates(place(whole, {}, {request}));
      EXPECT_LT(needed[0].size(), small.surface.size());
      EXPECT_LT(needed[1].size(), big.surface.size() / 2);
      const Kernel a = cut(small, needed[0]), b = cut(big, needed[1]);
      const auto few = placed(a, b);
      const Pairing expected = pair(whole[0], whole[1], request), found = pair(few[0], few[1], request);
      EXPECT_EQ(found.unpaired, expected.unpaired);
      EXPECT_EQ(found.shift, expected.shift);
      ASSERT_EQ(found.points.size(), expected.points.size());
      for (std::size_t i = 0; i < found.points.size(); ++i) {
        const Pairing::Point &one = expected.points[i], &other = found.points[i];
        EXPECT_EQ(other.of_a, one.of_a);
        EXPECT_EQ(other.gap, one.gap);
        EXPECT_EQ(other.area, one.area);
        EXPECT_EQ(other.b, one.b);
        ASSERT_EQ(other.of_b.size(), one.of_b.size());
        for (std::size_t w = 0; w < one.of_b.size(); ++w) {
          EXPECT_EQ(other.of_b[w].first, one.of_b[w].first);
          EXPECT_EQ(other.of_b[w].second, one.of_b[w].second);
        }
      }
    }
}

TEST(KernelsWithinReach, serve_each_smaller_reach_and_tell_what_they_lack_for_a_larger_one) {
  const Kernel kernel = cap(8, 1), partner = cap(20, 1);
  const auto request = [](double reach) { return PairRequest{"a", "b", up, {}, reach}; };
  const auto bodies = [&](const Kernel& a, const Kernel& b) {
    return std::vector<PlacedBody>{{"a", &a}, {"b", &b, upside_down(), 2.1 * up}};
  };
  const auto needed = paired_candidates(place(bodies(kernel, partner), {}, {request(0.4)}));
  const Kernel a = cut(kernel, needed[0]), b = cut(partner, needed[1]);
  const auto try_pair = [&](double reach, const Kernel& one, const Kernel& other) {
    build_model(bodies(one, other), {}, {request(reach)}, Vector3d::Zero());
  };
  const auto refusal = [&](double reach, const Kernel& one, const Kernel& other) {
    return complaint_of([&] { try_pair(reach, one, other); });
  };
  EXPECT_NO_THROW(try_pair(0.2, a, b));
  EXPECT_NO_THROW(try_pair(0.4, a, b));
  for (const std::string& said : {refusal(0.6, a, partner), refusal(0.6, kernel, b)}) {
    EXPECT_THAT(said, HasSubstr("contact between \"a\" and \"b\": the kernel of"));
    EXPECT_THAT(said, HasSubstr("Run ricochet-kernel"));
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 0);
  }
  EXPECT_THAT(refusal(0.6, a, partner), HasSubstr("of \"a\" holds too few candidates"));
  EXPECT_THAT(refusal(0.6, kernel, b), HasSubstr("of \"b\" holds too few candidates"));
}

/// A plate with points 1 m apart, the k-th of which is raised by k times `rise`.
Kernel stairs(const Plate& options, double rise) {
  Kernel kernel = *plate(options);
  for (std::size_t k = 0; k < kernel.surface.size(); ++k)
    kernel.surface.node[3 * k + 2] = rise * static_cast<double>(k);
  return kernel;
}

TEST(KernelsWithinReach, hold_what_any_pair_of_the_body_needs) {
  const Kernel kernel = stairs({.points = 6}, 0.01);
  const std::vector<Obstacle> floors = {{"low", {0, 0, -0.001}, up}, {"high", {0, 0, -0.0005}, up}};
  const auto needed = paired_candidates(
      place({{"a", &kernel}}, floors, {{"a", "low", {}, {}, 0.012}, {"a", "high", {}, {}, 0.025}}));
  EXPECT_THAT(needed[0], ElementsAre(0, 1, 2));
}

TEST(KernelsWithinReach, make_the_same_model) {
  const Kernel kernel = stairs({.points = 6, .ratio = 0.01}, 0.01);
  const std::vector<Obstacle> floor = {{"floor", Vector3d::Zero(), up}};
  const auto built = [&](const Kernel& of) {
    return build_model({{"a", &of, Matrix3d::Identity(), {0, 0, 0.001}, {0, 0, -1}}}, floor,
                       {{"a", "floor", {}, {}, 0.025}}, Vector3d(0, 0, -9.81));
  };
  const Kernel few = cut(kernel, {0, 1, 2, 4});
  const Model whole = built(kernel), other = built(few);
  ASSERT_EQ(whole.gap.size(), 3);
  EXPECT_EQ(other.gap, whole.gap);
  EXPECT_EQ(other.B, whole.B);
  EXPECT_EQ(other.R, whole.R);
  EXPECT_EQ(other.area, whole.area);
  EXPECT_EQ(other.pairs[0].unpaired, whole.pairs[0].unpaired);
}

/// Warnings of a plate that falls on the floor from 1 mm at 1 m/s and springs back within about 4 mm, without
/// that of few candidates.
std::vector<std::string> warnings(double rise, double reach) {
  const Kernel kernel = stairs({.points = 3}, rise);
  const std::vector<Obstacle> floor = {{"floor", Vector3d::Zero(), up}};
  const Model model = build_model({{"plate", &kernel, Matrix3d::Identity(), {0, 0, 0.001}, {0, 0, -1}}},
                                  floor, {{"plate", "floor", {}, {}, reach}}, Vector3d::Zero());
  constexpr double step = 1e-5;
  const auto stepper = make_stepper(model, {.step = step});
  SummaryObserver observer(model, step, 0);
  for (int k = 0; k < 2000; ++k) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    observer.observe(*stepper);
  }
  EXPECT_GT(observer.summary().impulse_ns, 1);
  std::vector<std::string> out = observer.summary().warnings;
  std::erase_if(out, [](const std::string& text) { return text.starts_with("at most"); });
  return out;
}

TEST(Reach, is_warned_of_when_bodies_come_nearer_than_it) {
  EXPECT_THAT(warnings(0.01, 0.0099), IsEmpty());
  EXPECT_THAT(warnings(0.01, 0.0011), ElementsAre(HasSubstr("beyond reach = 0.0011 m")));
  EXPECT_THAT(warnings(0.0, 0.0011), IsEmpty());  // no candidate was omitted
}

}  // namespace reach_test
