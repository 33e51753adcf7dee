// SPDX-License-Identifier: BSD-2-Clause
// Bodies that are probably not those that are meant, on both sides of each bound.
#include "src/store/body_warnings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace body_warnings_test {

using namespace ricochet;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A steel bracket of 60 mm.
struct Bracket {
  scene::Body body;
  kernels::Kernel kernel;
  Bracket() {
    body.name = "bracket";
    body.mesh = "bracket.step";
    body.scale = 0.001;
    body.materials = {{.group = "", .density = 7850, .young = 210e9, .poisson = 0.3}};
    kernel.mass = 0.23;
    kernel.order = 2;
    kernel.modes.angular_frequency.assign(6, 0);
    kernel.parts = 1;
    kernel.outline = {0, 0, 0, 0.06, 0.02, 0, 0.03, 0, 0.04};
  }
  std::vector<std::string> warnings() const { return store::warnings_of(body, kernel); }
};

TEST(Body, is_described_by_mass_size_and_wave_speed) {
  Bracket bracket;
  // √(210e9/7850) = 5172
  EXPECT_EQ(store::figures_of(bracket.body, bracket.kernel),
            "mass 0.23 kg, size 0.06 x 0.02 x 0.04 m, wave speed 5172 m/s");
  bracket.body.materials.push_back({.group = "pad", .density = 1000, .young = 1e6, .poisson = 0.4});
  EXPECT_THAT(store::figures_of(bracket.body, bracket.kernel), HasSubstr("wave speed 31.62 to 5172 m/s"));
  EXPECT_THAT(bracket.warnings(), IsEmpty());
}

TEST(Warnings, name_a_body_in_millimetres_that_is_read_in_metres) {
  Bracket bracket;
  for (double& x : bracket.kernel.outline) x *= 1000;
  EXPECT_THAT(bracket.warnings(), ElementsAre(HasSubstr("bracket is 60 m long: check bodies.bracket.scale "
                                                        "(0.001 for a mesh in millimetres)")));
  for (double& x : bracket.kernel.outline) x *= 0.1;
  EXPECT_THAT(bracket.warnings(), IsEmpty());  // 6 m, with a scale
  bracket.body.scale = 1;
  EXPECT_THAT(bracket.warnings(), ElementsAre(HasSubstr("bracket is 6 m long")));
  bracket.body.mesh = "bracket.geo";
  EXPECT_THAT(bracket.warnings(), IsEmpty());
  for (double& x : bracket.kernel.outline) x *= 1e-6;
  EXPECT_THAT(bracket.warnings(), ElementsAre(HasSubstr("bracket is 6e-06 m long")));
}

// gmsh reads a STEP file in millimetres, so the factor of inches makes a body 25.4 times too large.
TEST(Warnings, name_a_step_file_that_is_scaled_from_inches) {
  Bracket bracket;
  for (const double scale : {0.0254, 0.02541}) {
    bracket.body.scale = scale;
    EXPECT_THAT(bracket.warnings(), ElementsAre(HasSubstr("is read in millimetres, whatever its unit: set "
                                                          "scale = 0.001")));
  }
  bracket.body.scale = 0.026;
  EXPECT_THAT(bracket.warnings(), IsEmpty());
  bracket.body.scale = 0.0254;
  bracket.body.mesh = "bracket.msh";
  EXPECT_THAT(bracket.warnings(), IsEmpty());
}

// A surface with one patch has no whole element, like the ends of a rod.
TEST(Warnings, do_not_take_a_solid_with_few_candidates_for_a_rod) {
  Bracket bracket;
  bracket.kernel.surface.element_corners = 1;
  EXPECT_THAT(bracket.warnings(), IsEmpty());
  bracket.body.materials[0].area = 1e-4;
  EXPECT_THAT(bracket.warnings(), ElementsAre(HasSubstr("with 6 rigid modes in all")));  // a rod has one
}

TEST(Warnings, name_a_mass_that_no_body_has) {
  Bracket bracket;
  bracket.kernel.mass = 2e6;
  EXPECT_THAT(bracket.warnings(), ElementsAre(HasSubstr("bracket has a mass of 2e+06 kg")));
  bracket.kernel.mass = 1e-13;
  EXPECT_THAT(bracket.warnings(), ElementsAre(HasSubstr("bracket has a mass of 1e-13 kg")));
}

TEST(Warnings, name_a_wave_speed_that_no_solid_has) {
  const auto warnings = [](double young, double density) {
    Bracket bracket;
    bracket.body.materials[0].young = young;
    bracket.body.materials[0].density = density;
    return bracket.warnings();
  };
  EXPECT_THAT(warnings(210, 7850), ElementsAre(HasSubstr("waves in bracket run at 0.1636 m/s")));
  EXPECT_THAT(warnings(210e3, 7850), ElementsAre(HasSubstr("slower than in any usual solid")));  // in MPa
  EXPECT_THAT(warnings(210e9, 7.85), ElementsAre(HasSubstr("faster than in any usual solid")));  // in g/cm³
  EXPECT_THAT(warnings(1e12, 3500), IsEmpty());                                                  // diamond
  EXPECT_THAT(warnings(10.4e6, 11.3e3), IsEmpty());  // the disks of the paper
  EXPECT_THAT(warnings(1e4, 1000), IsEmpty());       // a soft gel
  EXPECT_THAT(warnings(1, 1), IsEmpty());            // the rods of the paper
}

TEST(Warnings, name_parts_that_are_not_joined) {
  Bracket bracket;
  bracket.kernel.parts = 2;
  bracket.kernel.modes.angular_frequency.assign(12, 0);
  EXPECT_THAT(bracket.warnings(),
              ElementsAre(HasSubstr("bracket consists of 2 parts that are not joined, with 12 rigid modes")));
  bracket.kernel.parts = 0;  // a kernel that does not state its parts
  EXPECT_THAT(bracket.warnings(), ElementsAre(HasSubstr("parts that are not joined, with 12 rigid modes")));
  bracket.kernel.parts = 2;  // fixed by supports
  bracket.kernel.modes.angular_frequency.assign(6, 1);
  EXPECT_THAT(bracket.warnings(), ElementsAre(HasSubstr("2 parts that are not joined, with 0 rigid modes")));
}

TEST(Warnings, name_pieces_that_hinge_on_each_other_and_where_they_are) {
  Bracket bracket;
  bracket.kernel.modes.angular_frequency.assign(7, 0);
  bracket.kernel.piece_elements = {320, 1};
  bracket.kernel.piece_box = {0, 0, 0, 0.03, 0.02, 0.04, 0.03, 0, -0.01, 0.06, 0.02, 0};
  const std::string places =
      "(320 elements in x 0 to 0.03, y 0 to 0.02, z 0 to 0.04 m; 1 element in x 0.03 to "
      "0.06, y 0 to 0.02, z -0.01 to 0 m)";
  EXPECT_THAT(bracket.warnings(),
              ElementsAre(AllOf(HasSubstr("bracket consists of 2 pieces that are joined at "
                                          "edges or points only, with 7 rigid modes"),
                                HasSubstr(places))));
  bracket.kernel.modes.angular_frequency.assign(1, 0);  // one of them fixed by a support
  EXPECT_THAT(bracket.warnings(), ElementsAre(HasSubstr("with 1 rigid mode in all")));
  bracket.kernel.parts = 2;
  EXPECT_THAT(bracket.warnings(),
              ElementsAre(AllOf(HasSubstr("2 parts that are not joined, with 1 rigid"), HasSubstr(places))));
  bracket.kernel.piece_elements.assign(7, 2);
  bracket.kernel.piece_box.assign(42, 0);
  EXPECT_THAT(bracket.warnings(), ElementsAre(AllOf(HasSubstr("2 parts that are not joined, of 7 pieces"),
                                                    HasSubstr("m; 3 more)"))));
}

TEST(Warnings, name_supports_on_lines_and_points) {
  Bracket bracket;
  bracket.kernel.held_on_lines = 5;
  EXPECT_THAT(bracket.warnings(),
              ElementsAre(HasSubstr("the supports of bracket hold x, z on lines or points only")));
}

}  // namespace body_warnings_test
