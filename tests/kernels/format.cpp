// SPDX-License-Identifier: BSD-2-Clause
// Kernel files: reading returns the written data, equal kernels give equal files, and
// a file with its final name is complete.
#include <hdf5.h>

#include <cstring>

#include "base/hdf5_reader.hpp"
#include "base/hdf5_writer.hpp"
#include "kernels/algebra.hpp"
#include "kernels/read.hpp"
#include "kernels/write.hpp"
#include "tests/kernels/sample.hpp"

namespace ricochet::kernels {

namespace hdf5 = base::hdf5;
namespace format_test {

using test::complaint_of;
using test::Folder;
using test::plain_kernel;
using test::sample_kernel;

/// Bitwise equality, including −0.0 and subnormal numbers.
template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const Kernel& a, const Kernel& b) {
  EXPECT_EQ(a.body, b.body);
  EXPECT_EQ(a.hash, b.hash);
  EXPECT_EQ(a.scene, b.scene);
  EXPECT_EQ(a.mesh_sha256, b.mesh_sha256);
  EXPECT_EQ(a.created_by, b.created_by);
  EXPECT_EQ(a.dofs, b.dofs);
  EXPECT_EQ(a.elements, b.elements);
  EXPECT_EQ(a.order, b.order);
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.centre, b.centre);
  EXPECT_EQ(a.inertia, b.inertia);
  EXPECT_EQ(a.supported, b.supported);
  EXPECT_EQ(a.parts, b.parts);
  EXPECT_EQ(a.held_on_lines, b.held_on_lines);
  EXPECT_TRUE(same_bits(a.outline, b.outline));
  EXPECT_TRUE(same_bits(a.piece_box, b.piece_box));
  EXPECT_EQ(a.piece_elements, b.piece_elements);
  EXPECT_EQ(a.modes.basis, b.modes.basis);
  EXPECT_TRUE(same_bits(a.modes.angular_frequency, b.modes.angular_frequency));
  EXPECT_TRUE(same_bits(a.modes.decay_rate, b.modes.decay_rate));
  EXPECT_TRUE(same_bits(a.modes.residual, b.modes.residual));
  EXPECT_EQ(a.modes.certificate.below, b.modes.certificate.below);
  EXPECT_EQ(a.modes.certificate.upto_hz, b.modes.certificate.upto_hz);
  EXPECT_EQ(a.modes.certificate.count_by_inertia, b.modes.certificate.count_by_inertia);
  EXPECT_TRUE(same_bits(a.modes.certificate.shift, b.modes.certificate.shift));
  EXPECT_TRUE(same_bits(a.modes.certificate.modes_below, b.modes.certificate.modes_below));
  EXPECT_EQ(a.modes.certificate.count_found, b.modes.certificate.count_found);
  EXPECT_EQ(a.modes.certificate.left_out, b.modes.certificate.left_out);
  EXPECT_EQ(a.modes.certificate.complete, b.modes.certificate.complete);
  EXPECT_EQ(a.modes.certificate.orthonormality, b.modes.certificate.orthonormality);
  EXPECT_EQ(a.modes.certificate.flexibility_error, b.modes.certificate.flexibility_error);
  EXPECT_EQ(a.surface.components, b.surface.components);
  EXPECT_EQ(a.surface.direction, b.surface.direction);
  EXPECT_TRUE(same_bits(a.surface.node, b.surface.node));
  EXPECT_TRUE(same_bits(a.surface.centroid, b.surface.centroid));
  EXPECT_TRUE(same_bits(a.surface.bulge, b.surface.bulge));
  EXPECT_EQ(a.surface.group, b.surface.group);
  EXPECT_TRUE(same_bits(a.surface.normal, b.surface.normal));
  EXPECT_TRUE(same_bits(a.surface.area, b.surface.area));
  EXPECT_EQ(a.surface.element_corners, b.surface.element_corners);
  EXPECT_EQ(a.surface.element, b.surface.element);
  EXPECT_TRUE(same_bits(a.surface.element_normal, b.surface.element_normal));
  EXPECT_TRUE(same_bits(a.surface.shape, b.surface.shape));
  EXPECT_TRUE(same_bits(a.surface.residual_flexibility, b.surface.residual_flexibility));
  EXPECT_TRUE(same_bits(a.loads.body_force, b.loads.body_force));
  EXPECT_TRUE(same_bits(a.loads.rotation, b.loads.rotation));
  EXPECT_TRUE(same_bits(a.loads.body_force_residual, b.loads.body_force_residual));
  ASSERT_EQ(a.applied.size(), b.applied.size());
  for (std::size_t l = 0; l < a.applied.size(); ++l) {
    EXPECT_EQ(a.applied[l].name, b.applied[l].name);
    EXPECT_EQ(a.applied[l].unit, b.applied[l].unit);
    EXPECT_TRUE(same_bits(a.applied[l].participation, b.applied[l].participation));
    EXPECT_TRUE(same_bits(a.applied[l].total, b.applied[l].total));
    EXPECT_TRUE(same_bits(a.applied[l].moment, b.applied[l].moment));
    EXPECT_TRUE(same_bits(a.applied[l].residual, b.applied[l].residual));
  }
  ASSERT_EQ(a.motions.size(), b.motions.size());
  for (std::size_t s = 0; s < a.motions.size(); ++s) {
    EXPECT_EQ(a.motions[s].name, b.motions[s].name);
    EXPECT_TRUE(same_bits(a.motions[s].participation, b.motions[s].participation));
    EXPECT_TRUE(same_bits(a.motions[s].residual, b.motions[s].residual));
    EXPECT_TRUE(same_bits(a.motions[s].momentum, b.motions[s].momentum));
  }
  ASSERT_EQ(a.receivers.size(), b.receivers.size());
  for (std::size_t r = 0; r < a.receivers.size(); ++r) {
    const Receiver &one = a.receivers[r], &other = b.receivers[r];
    EXPECT_EQ(one.name, other.name);
    EXPECT_EQ(one.point, other.point);
    EXPECT_TRUE(same_bits(one.shape, other.shape));
    EXPECT_TRUE(same_bits(one.residual_flexibility, other.residual_flexibility));
    EXPECT_TRUE(same_bits(one.body_force_residual, other.body_force_residual));
    EXPECT_TRUE(same_bits(one.load_residual, other.load_residual));
    EXPECT_TRUE(same_bits(one.motion_residual, other.motion_residual));
  }
  ASSERT_EQ(a.view.has_value(), b.view.has_value());
  if (!a.view) return;
  EXPECT_TRUE(same_bits(a.view->node, b.view->node));
  EXPECT_EQ(a.view->element_corners, b.view->element_corners);
  EXPECT_EQ(a.view->element, b.view->element);
  EXPECT_TRUE(same_bits(a.view->shape, b.view->shape));
  EXPECT_TRUE(same_bits(a.view->residual_flexibility, b.view->residual_flexibility));
  EXPECT_TRUE(same_bits(a.view->body_force_residual, b.view->body_force_residual));
  EXPECT_TRUE(same_bits(a.view->load_residual, b.view->load_residual));
  EXPECT_TRUE(same_bits(a.view->motion_residual, b.view->motion_residual));
  ASSERT_EQ(a.view->stress.has_value(), b.view->stress.has_value());
  if (!a.view->stress) return;
  const SensitivityOf<float>&one = *a.view->stress, &other = *b.view->stress;
  EXPECT_TRUE(same_bits(one.shape, other.shape));
  EXPECT_TRUE(same_bits(one.residual_flexibility, other.residual_flexibility));
  EXPECT_TRUE(same_bits(one.body_force_residual, other.body_force_residual));
  EXPECT_TRUE(same_bits(one.load_residual, other.load_residual));
  EXPECT_TRUE(same_bits(one.motion_residual, other.motion_residual));
}

class Components : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(OneAndThree, Components, testing::Values(1, 3));

TEST_P(Components, a_kernel_comes_back_bit_for_bit) {
  const Folder folder;
  const Kernel kernel = sample_kernel(GetParam());
  write(kernel, folder / "body.kernel.h5");
  expect_same(kernel, read(folder / "body.kernel.h5"));
  EXPECT_EQ(read_hash(folder / "body.kernel.h5"), kernel.hash);
  EXPECT_FALSE(read(folder / "body.kernel.h5", false).view);
}

TEST(KernelFile, with_static_corrections_along_the_normals_comes_back_bit_for_bit) {
  const Folder folder;
  const std::filesystem::path path = folder / "body.kernel.h5";
  const Kernel kernel = restricted_to_normals(sample_kernel(3));
  write(kernel, path);
  const Kernel found = read(path);
  EXPECT_TRUE(found == kernel);
  EXPECT_TRUE(found.surface.normal_residual);
  EXPECT_TRUE(read_header(path)->normal_residual);
  EXPECT_FALSE(read_header(path)->held.has_value());
}

TEST_P(Components, a_kernel_without_residual_flexibility_and_view_comes_back_without_them) {
  const Folder folder;
  Kernel kernel = sample_kernel(GetParam());
  kernel.surface.residual_flexibility.clear();
  kernel.loads.body_force_residual.clear();
  kernel.view.reset();
  for (Load& load : kernel.applied) load.residual.clear();
  for (Receiver& receiver : kernel.receivers)
    for (auto* values :
         {&receiver.residual_flexibility, &receiver.body_force_residual, &receiver.load_residual})
      values->clear();
  write(kernel, folder / "body.kernel.h5");
  expect_same(kernel, read(folder / "body.kernel.h5"));
}

// This covers kernels that were written before loads, motions and receivers existed.
TEST_P(Components, a_kernel_without_loads_motions_and_receivers_comes_back_without_them) {
  const Folder folder;
  const Kernel kernel = plain_kernel(GetParam());
  write(kernel, folder / "body.kernel.h5");
  expect_same(kernel, read(folder / "body.kernel.h5"));
  const hdf5::Reader file(folder / "body.kernel.h5", "");
  for (const char* group : {"/names", "/load_data", "/motions", "/receivers", "/receiver_data"})
    EXPECT_FALSE(file.exists(group)) << group;
}

TEST(KernelFile, a_kernel_of_points_without_elements_and_without_modes_comes_back) {
  const Folder folder;
  Kernel kernel = sample_kernel(3, 0, 2);
  kernel.surface.element.clear();
  kernel.surface.element_normal.clear();
  write(kernel, folder / "body.kernel.h5");
  expect_same(kernel, read(folder / "body.kernel.h5"));
}

TEST(KernelFile, identifies_itself_in_its_header) {
  const Folder folder;
  const Kernel kernel = sample_kernel(3);
  write(kernel, folder / "a.kernel.h5");
  const auto header = read_header(folder / "a.kernel.h5");
  ASSERT_TRUE(header);
  EXPECT_EQ(header->hash, kernel.hash);
  EXPECT_EQ(header->scene, kernel.scene);
  EXPECT_EQ(header->mesh_sha256, kernel.mesh_sha256);
  EXPECT_FALSE(read_header(folder.write("torn", "kernel")));
  EXPECT_FALSE(read_header(folder / "none"));
}

TEST(KernelFile, equal_kernels_give_equal_bytes) {
  const Folder folder;
  write(sample_kernel(3), folder / "one.h5");
  {  // other use of the library in between must not affect the file
    hdf5::Writer other(folder / "other.h5");
    other.write<double>("/x", std::vector<double>(1000, 1.5), {1000}, "m");
  }
  write(sample_kernel(3), folder / "two.h5");
  EXPECT_EQ(test::bytes_of(folder / "one.h5"), test::bytes_of(folder / "two.h5"));
}

herr_t check_object(hid_t file, const char* name, const H5O_info_t* info, void* seen) {
  EXPECT_EQ(info->ctime, 0) << name << " carries a time, so equal kernels would differ";
  const std::string object = name;
  if (info->type == H5O_TYPE_DATASET && object != "surface/group" && object.find("names/") != 0) {
    EXPECT_GT(H5Aexists_by_name(file, name, "unit", H5P_DEFAULT), 0) << name << " has no unit";
    ++*static_cast<int*>(seen);
  }
  return 0;
}

TEST(KernelFile, every_dataset_of_numbers_has_a_unit_and_no_object_a_time) {
  const Folder folder;
  write(sample_kernel(3), folder / "body.h5");
  const hid_t file = H5Fopen((folder / "body.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  int seen = 0;
  H5Ovisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, check_object, &seen);
  H5Fclose(file);
  // The datasets of docs/formats/kernel.md without names: 31, plus 4 for each load,
  // 3 for a motion, 6 for each receiver, 1 for each gauge with 5 for its stress and 5 for its strain, and 5
  // for the stress of the visualisation surface.
  EXPECT_EQ(seen, 33 + 2 * 4 + 3 + 2 * 6 + (1 + 5) + (1 + 5 + 5) + 5);
}

TEST(KernelFile, another_program_finds_the_shape_as_points_by_components_by_modes) {
  const Folder folder;
  const Kernel kernel = sample_kernel(3, 5, 4);
  write(kernel, folder / "body.h5");
  const hid_t file = H5Fopen((folder / "body.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t dataset = H5Dopen2(file, "/surface/shape", H5P_DEFAULT);
  const hid_t space = H5Dget_space(dataset);
  hsize_t dims[3] = {};
  ASSERT_EQ(H5Sget_simple_extent_ndims(space), 3);
  H5Sget_simple_extent_dims(space, dims, nullptr);
  double values[4][3][5] = {};
  ASSERT_GE(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0);
  H5Sclose(space);
  H5Dclose(dataset);
  H5Fclose(file);
  EXPECT_EQ((std::vector<hsize_t>(dims, dims + 3)), (std::vector<hsize_t>{4, 3, 5}));
  EXPECT_EQ(values[2][1][3], kernel.surface.shape[(2 * 3 + 1) * 5 + 3]);
}

TEST(KernelFile, a_kernel_that_would_not_be_read_is_not_written) {
  const Folder folder;
  Kernel kernel = sample_kernel(1);
  kernel.surface.area[1] = std::nan("");
  const std::string message = complaint_of([&] { write(kernel, folder / "body.kernel.h5"); });
  EXPECT_NE(message.find("/surface/area"), std::string::npos) << message;
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(KernelFile, a_scene_too_long_for_an_attribute_is_refused_and_not_cut) {
  const Folder folder;
  Kernel kernel = sample_kernel(1);
  kernel.scene = std::string(64'000, '#');
  write(kernel, folder / "longest.kernel.h5");
  EXPECT_EQ(read(folder / "longest.kernel.h5").scene, kernel.scene);
  kernel.scene += '#';
  const std::string message = complaint_of([&] { write(kernel, folder / "body.kernel.h5"); });
  EXPECT_NE(message.find("attribute scene of / has 64001 bytes"), std::string::npos) << message;
  EXPECT_EQ(folder.entries(), 1U);
}

}  // namespace format_test
}  // namespace ricochet::kernels
