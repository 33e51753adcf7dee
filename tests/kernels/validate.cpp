// SPDX-License-Identifier: BSD-2-Clause
// The rules that a loaded kernel must satisfy, each violated once.
#include <functional>

#include "tests/kernels/sample.hpp"

namespace ricochet::kernels {
namespace validate_test {

using test::complaint_of;
using test::sample_kernel;

struct Breach {
  const char* name;
  std::function<void(Kernel&)> commit;
  const char* named;  ///< part of the message that names the fault
};

void PrintTo(const Breach& breach, std::ostream* out) { *out << breach.name; }

class Rule : public testing::TestWithParam<Breach> {};

TEST_P(Rule, is_enforced) {
  for (const int components : {1, 3}) {
    Kernel kernel = sample_kernel(components);
    ASSERT_NO_THROW(validate(kernel, "origin"));
    GetParam().commit(kernel);
    const std::string message = complaint_of([&] { validate(kernel, "origin"); });
    EXPECT_EQ(message.find("origin: "), 0U) << message;
    EXPECT_NE(message.find(GetParam().named), std::string::npos) << message;
    EXPECT_NE(message.find("Compute it again"), std::string::npos) << message;
  }
}

const double kInfinity = std::numeric_limits<double>::infinity();

INSTANTIATE_TEST_SUITE_P(
    Kernel, Rule,
    testing::Values(
        Breach{"body_has_a_name", [](Kernel& k) { k.body.clear(); }, "body"},
        Breach{"hash_is_there", [](Kernel& k) { k.hash.clear(); }, "hash"},
        Breach{"mass_is_positive", [](Kernel& k) { k.mass = 0; }, "mass"},
        Breach{"mass_is_finite", [](Kernel& k) { k.mass = kInfinity; }, "mass"},
        Breach{"dofs_are_not_negative", [](Kernel& k) { k.dofs = -1; }, "dofs"},
        Breach{"centre_is_finite", [](Kernel& k) { k.centre[1] = kInfinity; }, "/body/centre"},
        Breach{"inertia_is_finite", [](Kernel& k) { k.inertia[8] = kInfinity; }, "/body/inertia"},
        Breach{"parts_are_not_negative", [](Kernel& k) { k.parts = -1; }, "parts"},
        Breach{"components_held_on_lines_are_three", [](Kernel& k) { k.held_on_lines = 8; }, "held_on_lines"},
        Breach{"outline_is_finite", [](Kernel& k) { k.outline[2] = kInfinity; }, "/body/outline"},
        Breach{"outline_has_three_coordinates", [](Kernel& k) { k.outline.pop_back(); }, "/body/outline"},
        Breach{"pieces_have_boxes", [](Kernel& k) { k.piece_box.clear(); }, "/body/piece_box"},
        Breach{"boxes_of_pieces_are_complete", [](Kernel& k) { k.piece_box.pop_back(); }, "/body/piece_box"},
        Breach{"boxes_of_pieces_begin_at_their_lowest_coordinates", [](Kernel& k) { k.piece_box[8] = 5; },
               "/body/piece_box"},
        Breach{"pieces_have_elements", [](Kernel& k) { k.piece_elements[1] = 0; }, "/body/piece_elements"},
        Breach{"basis_is_known", [](Kernel& k) { k.modes.basis = "wavelets"; }, "basis"},
        Breach{"frequencies_ascend",
               [](Kernel& k) { std::swap(k.modes.angular_frequency[1], k.modes.angular_frequency[2]); },
               "/modes/angular_frequency"},
        Breach{"frequencies_are_not_negative", [](Kernel& k) { k.modes.angular_frequency[0] = -1; },
               "/modes/angular_frequency"},
        Breach{"decay_rates_are_not_negative", [](Kernel& k) { k.modes.decay_rate[2] = -1; },
               "/modes/decay_rate"},
        Breach{"decay_rates_are_as_many_as_modes", [](Kernel& k) { k.modes.decay_rate.pop_back(); },
               "/modes/decay_rate"},
        Breach{"residuals_are_as_many_as_modes", [](Kernel& k) { k.modes.residual.push_back(0); },
               "/modes/residual"},
        Breach{"counts_are_not_negative", [](Kernel& k) { k.modes.certificate.below = -1; }, "certificate"},
        Breach{"certificate_is_finite", [](Kernel& k) { k.modes.certificate.orthonormality = kInfinity; },
               "certificate"},
        Breach{"modes_left_out_are_not_a_negative_number",
               [](Kernel& k) { k.modes.certificate.left_out = -1; }, "certificate"},
        Breach{"flexibility_error_is_not_negative",
               [](Kernel& k) { k.modes.certificate.flexibility_error = -1e-3; }, "certificate"},
        Breach{"flexibility_error_is_finite",
               [](Kernel& k) { k.modes.certificate.flexibility_error = kInfinity; }, "certificate"},
        Breach{"flexibility_error_is_a_number",
               [](Kernel& k) { k.modes.certificate.flexibility_error = std::nan(""); }, "certificate"},
        Breach{"coriolis_pairs_have_two_modes", [](Kernel& k) { k.modes.coriolis.pair.pop_back(); },
               "/modes/coriolis_pair"},
        Breach{"coriolis_pairs_are_of_modes", [](Kernel& k) { k.modes.coriolis.pair[3] = 5; },
               "/modes/coriolis_pair"},
        Breach{"coriolis_pairs_ascend", [](Kernel& k) { k.modes.coriolis.pair[2] = 4; },
               "/modes/coriolis_pair"},
        Breach{"coriolis_pairs_are_elastic", [](Kernel& k) { k.modes.coriolis.pair[0] = 0; },
               "/modes/coriolis_pair"},
        Breach{"coriolis_couplings_are_as_many_as_pairs",
               [](Kernel& k) { k.modes.coriolis.coupling.clear(); }, "/modes/coriolis_coupling"},
        Breach{"coriolis_couplings_are_finite", [](Kernel& k) { k.modes.coriolis.coupling[4] = kInfinity; },
               "/modes/coriolis_coupling"},
        Breach{"components_are_one_or_three", [](Kernel& k) { k.surface.components = 2; }, "/surface/shape"},
        Breach{"direction_goes_with_one_component",
               [](Kernel& k) {
                 if (k.surface.direction)
                   k.surface.direction.reset();
                 else
                   k.surface.direction = Vector3{0, 0, 1};
               },
               "direction"},
        Breach{"centroids_have_three_coordinates", [](Kernel& k) { k.surface.centroid.pop_back(); },
               "/surface/centroid"},
        Breach{"nodes_have_three_coordinates", [](Kernel& k) { k.surface.node.pop_back(); }, "/surface/node"},
        Breach{"groups_are_as_many_as_points", [](Kernel& k) { k.surface.group.pop_back(); },
               "/surface/group"},
        Breach{"areas_are_positive", [](Kernel& k) { k.surface.area[0] = 0; }, "/surface/area"},
        Breach{"normals_are_unit_vectors", [](Kernel& k) { k.surface.normal[0] += 1e-6; }, "/surface/normal"},
        Breach{"elements_are_whole", [](Kernel& k) { k.surface.element.pop_back(); }, "/surface/element"},
        Breach{"elements_name_points", [](Kernel& k) { k.surface.element[0] = 4; }, "/surface/element"},
        Breach{"shapes_are_points_by_components_by_modes", [](Kernel& k) { k.surface.shape.pop_back(); },
               "/surface/shape"},
        Breach{"flexibility_is_square", [](Kernel& k) { k.surface.residual_flexibility.pop_back(); },
               "/surface/residual_flexibility"},
        Breach{"flexibility_is_symmetric", [](Kernel& k) { k.surface.residual_flexibility[1] += 1e-9; },
               "/surface/residual_flexibility"},
        Breach{"body_force_has_three_rows", [](Kernel& k) { k.loads.body_force.pop_back(); },
               "/loads/body_force"},
        Breach{"rotation_has_three_rows", [](Kernel& k) { k.loads.rotation.pop_back(); }, "/loads/rotation"},
        Breach{"static_part_has_three_columns", [](Kernel& k) { k.loads.body_force_residual.pop_back(); },
               "/loads/body_force_residual"},
        Breach{"loads_are_in_pascal_or_newton", [](Kernel& k) { k.applied[1].unit = "lbf"; },
               "/loads/point 1"},
        Breach{"names_have_no_slash", [](Kernel& k) { k.receivers[0].name = "a/b"; }, "/receivers"},
        Breach{"names_are_not_those_of_other_datasets", [](Kernel& k) { k.applied[0].name = "rotation"; },
               "/loads"},
        Breach{"names_differ", [](Kernel& k) { k.applied[1].name = k.applied[0].name; }, "/loads"},
        Breach{"loads_have_three_rows", [](Kernel& k) { k.applied[0].participation.pop_back(); },
               "/loads/upper face"},
        Breach{"motions_know_the_surface", [](Kernel& k) { k.motions[0].residual.clear(); }, "/residual"},
        Breach{"receivers_know_the_motions", [](Kernel& k) { k.receivers[1].motion_residual.clear(); },
               "/receiver_data/rotations/motion_residual"},
        Breach{"receivers_know_all_loads", [](Kernel& k) { k.receivers[1].load_residual.resize(9); },
               "/receiver_data/rotations/load_residual"},
        Breach{"receivers_are_somewhere", [](Kernel& k) { k.receivers[1].point[0] = kInfinity; },
               "/receiver_data/rotations/point"},
        Breach{"visualisation_elements_have_two_corners_or_more",
               [](Kernel& k) { k.view->element_corners = 1; }, "/view/element"},
        Breach{"visualisation_elements_name_nodes", [](Kernel& k) { k.view->element[0] = -1; },
               "/view/element"},
        Breach{"visualisation_shapes_are_finite", [](Kernel& k) { k.view->shape[3] = std::nanf(""); },
               "/view/shape"},
        Breach{"surface_stresses_have_six_rows", [](Kernel& k) { k.view->stress->shape.pop_back(); },
               "/view/stress/shape"},
        Breach{"visualisation_nodes_have_three_coordinates", [](Kernel& k) { k.view->node.pop_back(); },
               "/view/node"}),
    [](const testing::TestParamInfo<Breach>& instance) { return instance.param.name; });

TEST(Direction, is_a_unit_vector) {
  Kernel kernel = sample_kernel(1);
  kernel.surface.direction = Vector3{0, 0, 2};
  EXPECT_NE(complaint_of([&] { validate(kernel, "origin"); }).find("direction"), std::string::npos);
}

}  // namespace validate_test
}  // namespace ricochet::kernels
