// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/modes_file.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/hdf5_writer.hpp"
#include "base/xdmf.hpp"
#include "ricochet/error.hpp"

namespace ricochet::kernels {

namespace hdf5 = base::hdf5;
namespace xdmf = base::xdmf;
namespace {

/// Diagonal of the bounding box of the nodes (V,3) [m].
double size_of(const std::vector<double>& node) {
  const Eigen::Map<const Eigen::Matrix3Xd> points(node.data(), 3, std::ssize(node) / 3);
  const Eigen::Vector3d edge = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
  return std::sqrt(edge.x() * edge.x() + edge.y() * edge.y() + edge.z() * edge.z());
}

}  // namespace

void write_modes(const Kernel& kernel, const std::filesystem::path& stem) {
  if (!kernel.view || kernel.view->node.empty())
    throw InputError(fmt::format(
        "kernel of \"{}\": has no visualisation surface: compute it with output.view = true", kernel.body));
  const View& view = *kernel.view;
  const std::size_t n = kernel.modes.size(), nodes = view.node.size() / 3,
                    corners = static_cast<std::size_t>(view.element_corners);
  const double size = size_of(view.node);
  std::filesystem::path data = stem, text = stem;
  data += ".h5";
  text += ".xdmf";

  hdf5::Writer file(data);
  file.attribute("/", "format", "ricochet-modes");
  file.attribute("/", "version", 1);
  file.attribute("/", "body", kernel.body);
  file.attribute("/", "created_by", kernel.created_by);
  file.write("/node", view.node, {nodes, 3}, "m");
  file.write("/element", view.element, {view.element.size() / corners, corners}, "1");
  xdmf::Grid grid{.name = kernel.body,
                  .corners = view.element_corners,
                  .elements = view.element.size() / corners,
                  .nodes = nodes,
                  .element = "/element",
                  .position = {.name = "position", .dataset = "/node", .vector = true, .bytes = 8}};
  std::vector<double> frequency, amplitude;
  const auto digits = std::to_string(n).size();
  std::vector<float> shape(3 * nodes);
  for (std::size_t k = 0; k < n; ++k) {
    double largest = 0;
    for (std::size_t v = 0; v < nodes; ++v) {
      for (std::size_t d = 0; d < 3; ++d) shape[3 * v + d] = view.shape[(3 * v + d) * n + k];
      largest = std::max(
          largest, std::hypot(double(shape[3 * v]), double(shape[3 * v + 1]), double(shape[3 * v + 2])));
    }
    frequency.push_back(to_hertz(RadPerSecond{kernel.modes.angular_frequency[k]}).value);
    amplitude.push_back(largest > 0 ? 0.1 * size / largest : 1);
    for (float& value : shape) value = static_cast<float>(value * amplitude.back());
    const std::string number = fmt::format("{:0{}}", k + 1, digits), dataset = "/modes/" + number;
    file.write(dataset, shape, {nodes, 3}, "m");
    grid.fields.push_back({fmt::format("mode {}: {:.6g} Hz", number, frequency.back()), dataset, true, 4});
  }
  file.write("/frequency", frequency, {n}, "Hz");
  file.write("/amplitude", amplitude, {n}, "kg^1/2 m");

  std::error_code ignored;
  std::filesystem::remove(text, ignored);  // an .xdmf of an earlier run would not match the new data
  file.commit();
  xdmf::File light(text, data.filename().string());
  light.add(grid);
  light.commit();
}

}  // namespace ricochet::kernels
