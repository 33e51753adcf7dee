// SPDX-License-Identifier: BSD-2-Clause
// Writes table files (docs/formats/responses.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "contact/table/table.hpp"

namespace ricochet::contact::test {

inline void write_table(const Table& table, const std::filesystem::path& path) {
  validate(table, path.string());
  const auto flat = [](const auto& x) { return std::vector<double>(x.data(), x.data() + x.size()); };
  const auto m = static_cast<std::size_t>(table.points()), L = static_cast<std::size_t>(table.samples()),
             K = static_cast<std::size_t>(table.instants());
  base::hdf5::Writer file(path);
  file.attribute("/", "format", "ricochet-table");
  file.attribute("/", "version", 1);
  file.write<double>("/table/step", {table.step}, {}, "s");
  file.attribute("/table", "tail", table.tail == Tail::linear ? "linear" : "none");
  const auto write = [&](const char* name, const std::vector<double>& values, const base::hdf5::Shape& shape,
                         const char* unit) {
    if (!values.empty()) file.write<double>(std::string("/table/") + name, values, shape, unit);
  };
  write("displacement", table.displacement, {L, m, m}, "m/(N s)");
  write("velocity", table.velocity, {L, m, m}, "1/kg");
  write("flexibility", table.flexibility, {L, m, m}, "m/N");
  write("free", table.free, {K, m}, "m");
  write("free_velocity", table.free_velocity, {K, m}, "m/s");
  write("gap", flat(table.gap), {m}, "m");
  write("area", flat(table.area), {m}, "m^2");
  if (!table.bodies.empty()) {
    std::vector<std::string> name;
    std::vector<double> mass, velocity, gravity, push;
    const auto add = [](std::vector<double>& to, const std::vector<double>& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    for (const FreeBody& body : table.bodies) {
      name.push_back(body.name);
      mass.push_back(body.mass);
      add(velocity, flat(body.velocity));
      add(gravity, flat(body.gravity));
      add(push, flat(body.push));
    }
    const std::size_t count = name.size();
    file.write_strings("/bodies/name", name);
    file.write<double>("/bodies/mass", mass, {count}, "kg");
    file.write<double>("/bodies/velocity", velocity, {count, 3}, "m/s");
    file.write<double>("/bodies/gravity", gravity, {count, 3}, "m/s^2");
    file.write<double>("/bodies/push", push, {count, m, 3}, "1");
  }
  file.commit();
}

}  // namespace ricochet::contact::test
