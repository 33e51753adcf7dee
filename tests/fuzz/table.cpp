// SPDX-License-Identifier: BSD-2-Clause
// A file of sampled responses, edited as described in tests/fuzz/hdf5_edits.hpp. An accepted table is
// unchanged after it is written and read again. It can be stepped or is refused with one line.
#include "contact/table/table.hpp"
#include "contact/files/table_file.hpp"

#include "contact/table/table_stepper.hpp"
#include "tests/contact/table_writer.hpp"
#include "tests/fuzz/hdf5_edits.hpp"

namespace {

using namespace ricochet;
using contact::Table;
using fuzz::accepts;
using fuzz::require;

bool same(const contact::FreeBody& a, const contact::FreeBody& b) {
  return a.name == b.name && a.mass == b.mass && a.velocity == b.velocity && a.gravity == b.gravity &&
         a.push == b.push;
}

bool same(const Table& a, const Table& b) {
  return a.step == b.step && a.displacement == b.displacement && a.velocity == b.velocity &&
         a.flexibility == b.flexibility && a.tail == b.tail && a.free == b.free &&
         a.free_velocity == b.free_velocity && a.gap == b.gap && a.area.size() == b.area.size() &&
         a.area == b.area &&
         std::equal(a.bodies.begin(), a.bodies.end(), b.bodies.begin(), b.bodies.end(),
                    [](const auto& x, const auto& y) { return same(x, y); });
}

/// A table with two points. Each bit of `parts` adds an optional part.
Table sample(unsigned parts) {
  Table table;
  table.step = 1e-3;
  table.gap = contact::Vector::Zero(2);
  table.area = contact::Vector::Ones(2);
  for (int l = 0; l < 4; ++l)
    for (double x : {1.0, 0.5, 0.5, 1.0}) {
      table.displacement.push_back(1e-3 * l * x);
      table.velocity.push_back(x);
      if ((parts & 1) != 0) table.flexibility.push_back(1e-6 * (l + 0.5) * x);
    }
  if ((parts & 2) != 0) table.tail = contact::Tail::linear;
  for (int k = 0; k < 8 && (parts & 4) != 0; ++k) {
    table.free.push_back(1e-3 * (k / 2));
    if ((parts & 8) != 0) table.free_velocity.push_back(1.0);
  }
  if ((parts & 16) != 0 || table.free.empty())
    table.bodies.push_back({"ball", 2.0, {0, 0, -1}, {0, 0, -9.81}, contact::Matrix::Ones(2, 3)});
  return table;
}

void step(const Table& table, ricochet::Scheme scheme, ricochet::Admittance admittance) {
  accepts([&] {
    contact::TableStepper stepper(
        table, {.contact = {.scheme = scheme, .admittance = admittance}, .step = table.step});
    for (int k = 0; k < 4; ++k) stepper.step();
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch folder;
  const std::filesystem::path file = folder / "table.h5", copy = folder / "copy.h5";
  fuzz::make_hdf5(data, size, file, 32, [](unsigned variant, const std::filesystem::path& path) {
    contact::test::write_table(sample(variant), path);
  });
  Table table;
  if (!accepts([&] { table = contact::read_table(file); })) return 0;
  contact::test::write_table(table, copy);
  require(same(contact::read_table(copy), table), "a written table is another one");
  step(table, ricochet::Scheme::compliant, ricochet::Admittance::jump);
  step(table, ricochet::Scheme::impulse, ricochet::Admittance::jump);
  step(table, ricochet::Scheme::impulse, ricochet::Admittance::difference);
  return 0;
}
