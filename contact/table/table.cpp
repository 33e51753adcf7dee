// SPDX-License-Identifier: BSD-2-Clause
#include "contact/table/table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/format.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

/// A table with a linear tail must end in a straight line to within this share of its largest value.
constexpr double straight = 1e-6;

/// Gaps smaller than this share of their terms are round-off of touching.
constexpr double touching = 1e-12;

/// Names become groups of the result file.
bool is_name(const std::string& name) {
  return !name.empty() && name.find_first_not_of(
                              "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                              "0123456789_-") == std::string::npos;
}

/// Complaints about one table. Each check throws an InputError that names the origin of the table.
struct Checks {
  const Table& table;
  const std::string& origin;
  std::int64_t m = table.points(), L = table.samples(), K = table.instants();
  std::array<std::pair<const char*, const std::vector<double>*>, 3> responses{
      {{"displacement", &table.displacement},
       {"velocity", &table.velocity},
       {"flexibility", &table.flexibility}}};

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(base::format("{}: {} {}", origin, what, table_advice));
  }

  void finite(const char* name, std::span<const double> values) const {
    if (!std::ranges::all_of(values, [](double x) { return std::isfinite(x); }))
      fail(base::format("/table/{} contains a value that is not finite.", name));
  }

  void samples() const {
    if (!(table.step > 0) || !std::isfinite(table.step))
      fail(base::format("/table/step is {} s: must be positive.", table.step));
    if (m < 1) fail("/table/gap is empty: a table has a contact point at least.");
    if (L < 2) fail(base::format("the responses have {} samples: 2 are the least.", L));
    if (table.displacement.size() != table.velocity.size())
      fail("/table/displacement and /table/velocity differ in length.");
    for (const auto& [name, response] : responses) {
      if (!response->empty() && std::ssize(*response) != L * m * m)
        fail(base::format("the responses are not all of shape ({}, {}, {}).", L, m, m));
      finite(name, *response);
    }
    if (!table.residual.empty() && (table.flexibility.empty() || std::ssize(table.residual) != m * m))
      fail(base::format("/table/residual must be of shape ({0}, {0}), beside /table/flexibility.", m));
    finite("residual", table.residual);
    finite("free", table.free);
    finite("free_velocity", table.free_velocity);
    finite("gap", {table.gap.data(), static_cast<std::size_t>(m)});
    if (table.area.size() > 0 && (table.area.size() != m || !(table.area.array() > 0).all()))
      fail("/table/area must be positive, one for each point.");
    for (std::int64_t k = 0; k < m * m && !table.displacement.empty(); ++k)
      if (table.displacement[k] != 0)
        fail(base::format("/table/displacement[0] is {}, not 0: sample l is the displacement just before lΔ.",
                          table.displacement[k]));
  }

  void bodies() const {
    std::set<std::string> names;
    for (const FreeBody& body : table.bodies) {
      if (!is_name(body.name) || !names.insert(body.name).second)
        fail("/bodies/name: names are of letters, digits, - and _, and each is given once.");
      if (!(body.mass > 0) || !std::isfinite(body.mass))
        fail(base::format("/bodies/mass of {} is {} kg: must be positive.", body.name, body.mass));
      if (!body.velocity.allFinite() || !body.gravity.allFinite() || !body.push.allFinite())
        fail(base::format("/bodies: {} has values that are not finite.", body.name));
      if (body.push.rows() != m || body.push.cols() != 3)
        fail(base::format("/bodies/push of {} is not of shape ({}, 3).", body.name, m));
    }
  }

  void free_motion() const {
    if (table.free.empty() && table.bodies.empty())
      fail("the motion of the points without contact is missing: give /table/free, or /bodies.");
    if (std::ssize(table.free) != K * m || (!table.free.empty() && K < 2))
      fail(base::format("/table/free must hold at least 2 instants of {} points.", m));
    if (!table.free_velocity.empty() && table.free_velocity.size() != table.free.size())
      fail("/table/free_velocity has another shape than /table/free.");
    for (std::int64_t i = 0; i < m && K > 0; ++i)
      if (const double depth = table.free[i] - table.gap(i);
          depth > touching * (std::abs(table.free[i]) + std::abs(table.gap(i))))
        fail(base::format(
            "point {} overlaps by {:.6g} m at the start: its gap must not be below /table/free[0].", i,
            depth));
    if (K == 0 && (table.gap.array() < 0).any()) fail("/table/gap must not be negative.");
  }

  void tail() const {
    if (table.tail == Tail::none) return;
    for (const auto& [name, response] : responses)
      if (!response->empty())
        if (const double off = Convolution::departure(*response, static_cast<int>(m), static_cast<int>(m));
            off > straight)
          fail(base::format(
              "/table/{} must end in a straight line, but its last tenth departs from one by {:.2g} "
              "of its largest value (at most {}): make it longer, or set tail = \"none\".",
              name, off, straight));
  }
};

}  // namespace

std::int64_t Table::samples() const {
  const std::int64_t m = points();
  return m > 0 ? std::ssize(displacement.empty() ? flexibility : displacement) / (m * m) : 0;
}

std::int64_t Table::instants() const { return points() > 0 ? std::ssize(free) / points() : 0; }

void validate(const Table& table, const std::string& origin) {
  const Checks check{table, origin};
  check.samples();
  check.bodies();
  check.free_motion();
  check.tail();
}

}  // namespace ricochet::contact
