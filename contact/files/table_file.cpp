// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/table_file.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "base/hdf5_reader.hpp"

namespace ricochet::contact {
namespace {

using base::hdf5::any;
using base::hdf5::Reader;

constexpr const char* table_format = "ricochet-table";
constexpr std::int64_t table_version = 1;

Vector vector(const std::vector<double>& x) { return Eigen::Map<const Vector>(x.data(), std::ssize(x)); }

std::vector<FreeBody> read_bodies(const Reader& file, std::size_t m) {
  const std::vector<double> mass = file.read<double>("/bodies/mass", {any});
  const std::size_t count = mass.size();
  const std::vector<std::string> name = file.read_strings("/bodies/name", count);
  const std::vector<double> velocity = file.read<double>("/bodies/velocity", {count, 3}),
                            gravity = file.read<double>("/bodies/gravity", {count, 3}),
                            push = file.read<double>("/bodies/push", {count, m, 3});
  std::vector<FreeBody> out;
  for (std::size_t b = 0; b < count; ++b)
    out.push_back({name[b], mass[b], Eigen::Map<const Eigen::Vector3d>(&velocity[3 * b]),
                   Eigen::Map<const Eigen::Vector3d>(&gravity[3 * b]),
                   Eigen::Map<const Matrix>(push.data() + 3 * m * b, m, 3)});
  return out;
}

}  // namespace

Table read_table(const std::filesystem::path& path) {
  const Reader file(path, table_advice);
  if (!file.has_attribute("/", "format") || file.string_attribute("/", "format") != table_format)
    file.fail("is not a table (no attribute format = \"ricochet-table\").");
  if (const std::int64_t version = file.integer_attribute("/", "version"); version != table_version)
    file.fail(fmt::format("has format version {}, and this program reads {}.", version, table_version));
  Table table;
  table.step = file.read<double>("/table/step", {}).at(0);
  table.gap = vector(file.read<double>("/table/gap", {any}));
  const std::size_t m = table.gap.size();
  const auto optional = [&](const std::string& name, const base::hdf5::Shape& shape) {
    return file.exists("/table/" + name) ? file.read<double>("/table/" + name, shape) : std::vector<double>{};
  };
  table.flexibility = optional("flexibility", {any, m, m});
  table.residual = optional("residual", {m, m});
  if (table.flexibility.empty() || file.exists("/table/displacement")) {
    table.displacement = file.read<double>("/table/displacement", {any, m, m});
    table.velocity = file.read<double>("/table/velocity", {any, m, m});
  }
  table.free = optional("free", {any, m});
  table.free_velocity = optional("free_velocity", {any, m});
  table.area = vector(optional("area", {m}));
  if (file.has_attribute("/table", "tail")) {
    const std::string tail = file.string_attribute("/table", "tail");
    if (tail != "none" && tail != "linear")
      file.fail(fmt::format("attribute tail of /table is \"{}\", not \"none\" or \"linear\".", tail));
    if (tail == "linear") table.tail = Tail::linear;
  }
  if (file.exists("/bodies")) table.bodies = read_bodies(file, m);
  validate(table, path.string());
  return table;
}

}  // namespace ricochet::contact
