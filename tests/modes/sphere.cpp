// SPDX-License-Identifier: BSD-2-Clause
// Torsional modes of the free sphere in closed form, with their multiplicities, and
// a band whose end coincides with a mode.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "src/modes/modes.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace sphere_test {

/// ω of the lowest torsional mode of degree l of a free sphere of radius 1 with shear wave speed c: the first
/// root of (l − 1) j_l(x) = x j_{l+1}(x) (Lamb 1882).
double torsional(unsigned degree, double c) {
  const auto condition = [&](double x) {
    return (degree - 1.0) * std::sph_bessel(degree, x) - x * std::sph_bessel(degree + 1, x);
  };
  double low = 0.5, high = low;
  while (condition(high) * condition(low) > 0) high += 0.01;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (condition(middle) * condition(low) > 0 ? low : high) = middle;
  }
  return low * c;
}

struct Ball {
  explicit Ball(const parallel::Teams& teams) {
    const test::SharedFile file(".geo",
                                "SetFactory(\"OpenCASCADE\");\nSphere(1) = {0,0,0,1};\nMeshSize{:} = 0.5;\n"
                                "Physical Volume(\"ball\") = {1};\n");
    const scene::Body given = test::body_of(file.path(), 3);
    mesh = test::mesh_of(given, teams);
    body = elasticity::assemble(mesh, given.materials, "ball");
    factor = std::make_unique<modes::Factorisation>(body.stiffness, body.mass);
  }
  const mesh::GmshSession gmsh;
  mesh::Mesh mesh;
  elasticity::Body body;
  std::unique_ptr<modes::Factorisation> factor;
};

TEST(Sphere, has_its_torsional_modes_with_their_multiplicities_for_any_teams) {
  // Material of body_of: E = 3, ν = 0.3, ρ = 2.
  const double c = std::sqrt(3.0 / (2 * 1.3) / 2.0);
  for (const parallel::Teams* teams : {&test::one_team(), &test::own_teams()}) {
    Ball ball(*teams);
    const modes::ModeSet set =
        modes::compute_modes(*teams, ball.mesh, ball.body, *ball.factor, {.count = 40});
    EXPECT_EQ(std::count(set.angular_frequency.begin(), set.angular_frequency.end(), 0.0), 6);
    for (unsigned degree : {2u, 3u}) {
      const double exact = torsional(degree, c);
      // Elements of order 3 have a size of a quarter of a wavelength. The excess of a Ritz
      // value is of sixth order in this size.
      const auto near = std::count_if(set.angular_frequency.begin(), set.angular_frequency.end(),
                                      [&](double omega) { return std::abs(omega / exact - 1) < 2e-3; });
      EXPECT_EQ(near, 2 * static_cast<int>(degree) + 1) << degree;
    }
  }
}

TEST(End, that_hits_a_mode_includes_it) {
  const parallel::Teams& teams = test::own_teams();
  Ball ball(teams);
  const modes::ModeSet all = modes::compute_modes(teams, ball.mesh, ball.body, *ball.factor, {.count = 30});
  for (std::size_t n : {10u, 17u}) {
    const double omega = all.angular_frequency[n];
    const modes::ModeSet set = modes::compute_modes(teams, ball.mesh, ball.body, *ball.factor,
                                                    {.up_to = to_hertz(RadPerSecond{omega})});
    ASSERT_EQ(set.angular_frequency.size(), n + 1);
    EXPECT_NEAR(set.angular_frequency.back(), omega, 1e-9 * omega);
  }
}

}  // namespace sphere_test
}  // namespace ricochet
