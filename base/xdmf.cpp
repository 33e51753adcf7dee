// SPDX-License-Identifier: BSD-2-Clause
#include "base/xdmf.hpp"

#include <fmt/format.h>

#include <array>
#include <map>

namespace ricochet::base::xdmf {
namespace {

std::string escaped(const std::string& text) {
  const std::map<char, const char*> entities{{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}};
  std::string out;
  for (const char c : text) {
    const auto entity = entities.find(c);
    out += entity == entities.end() ? std::string(1, c) : entity->second;
  }
  return out;
}

}  // namespace

File::File(const std::filesystem::path& path, std::string data)
    : temporary_(path), data_(std::move(data)), text_(temporary_.path()) {
  text_ << "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n";
}

void File::begin(const std::string& name) {
  text_ << fmt::format("<Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
                       escaped(name));
}

void File::end() { text_ << "</Grid>\n"; }

std::string File::item(const std::string& dataset, const std::string& shape, const char* type,
                       int bytes) const {
  return fmt::format(
      "<DataItem Dimensions=\"{}\" NumberType=\"{}\" Precision=\"{}\" Format=\"HDF\">{}:{}</DataItem>", shape,
      type, bytes, escaped(data_), escaped(dataset));
}

void File::add(const Grid& grid, std::optional<double> time) {
  constexpr std::array types = {"Polyvertex", "Polyline", "Triangle"};
  const std::string vectors = fmt::format("{} 3", grid.nodes);
  text_ << fmt::format("<Grid Name=\"{}\">\n", escaped(grid.name));
  if (time) text_ << fmt::format("<Time Value=\"{}\"/>\n", *time);
  text_ << fmt::format(
      "<Topology TopologyType=\"{}\" NumberOfElements=\"{}\" NodesPerElement=\"{}\">{}</Topology>\n",
      types.at(static_cast<std::size_t>(grid.corners - 1)), grid.elements, grid.corners,
      item(grid.element, fmt::format("{} {}", grid.elements, grid.corners), "Int", 8));
  text_ << fmt::format("<Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
                       item(grid.position.dataset, vectors, "Float", grid.position.bytes));
  for (const Field& field : grid.fields)
    text_ << fmt::format(
        "<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n", escaped(field.name),
        field.vector ? "Vector" : "Scalar",
        item(field.dataset, field.vector ? vectors : std::to_string(grid.nodes), "Float", field.bytes));
  text_ << "</Grid>\n";
}

void File::commit() {
  text_ << "</Domain>\n</Xdmf>\n";
  text_.close();
  if (!text_) temporary_.fail();
  temporary_.commit();
}

}  // namespace ricochet::base::xdmf
