#include "contact/table/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "contact/stepping/propagator.hpp"
#include "ricochet/error.hpp"
#include "base/hdf5_reader.hpp"
#include "base/hdf5_writer.hpp"

namespace ricochet::contact {
namespace {

using base::hdf5::any;
using base::hdf5::Reader;
using base::hdf5::Writer;

constexpr const char* table_format = "ricochet-table";
constexpr std::int64_t table_version = 1;
constexpr const char* advice = "contact/TABLE.md says what a table holds.";

/// Of the largest value: a table said to end in a straight line must, within this.
constexpr double straight = 1e-6;

/// Gaps smaller than this share of what they are made of are round-off of touching.
constexpr double touching = 1e-12;

std::vector<double> flat(const Vector& x) { return {x.data(), x.data() + x.size()}; }
std::vector<double> flat(const Matrix& x) { return {x.data(), x.data() + x.size()}; }
Vector vector(const std::vector<double>& x) { return Eigen::Map<const Vector>(x.data(), std::ssize(x)); }

bool finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

/// Names become groups of the result.
bool is_name(const std::string& name) {
  return !name.empty() && name.find_first_not_of(
                              "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                              "0123456789_-") == std::string::npos;
}

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
                   Eigen::Map<const Matrix>(push.data() + 3 * m * b, static_cast<Eigen::Index>(m), 3)});
  return out;
}

/// Coefficient of one mode in the kernels, over the steps: the motion that a unit impulse or a unit force
/// over the first step leaves behind.
struct Series {
  double stiffness, q, v;
  ModeStep by;
  void advance() {
    const double g = -stiffness * q, next = q + by.b * v + by.c * g;
    v = by.e * v + by.h * g;
    q = next;
  }
};

}  // namespace

std::int64_t Table::samples() const {
  const std::int64_t m = points();
  return m > 0 ? std::ssize(displacement.empty() ? flexibility : displacement) / (m * m) : 0;
}

std::int64_t Table::instants() const { return points() > 0 ? std::ssize(free) / points() : 0; }

void validate(const Table& table, const std::string& origin) {
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{}: {} {}", origin, what, advice));
  };
  const std::int64_t m = table.points(), L = table.samples(), K = table.instants();
  if (!(table.step > 0) || !std::isfinite(table.step))
    fail(fmt::format("/table/step is {} s: must be positive.", table.step));
  if (m < 1) fail("/table/gap is empty: a table has a contact point at least.");
  if (L < 2) fail(fmt::format("the kernel has {} samples: 2 are the least.", L));
  if (table.displacement.size() != table.velocity.size())
    fail("/table/displacement and /table/velocity differ in length.");
  for (const auto* kernel : {&table.displacement, &table.velocity, &table.flexibility})
    if (!kernel->empty() && std::ssize(*kernel) != L * m * m)
      fail(fmt::format("the kernels are not all of shape ({}, {}, {}).", L, m, m));
  for (const auto& [name, values] :
       {std::pair{"displacement", &table.displacement}, std::pair{"velocity", &table.velocity},
        std::pair{"flexibility", &table.flexibility}, std::pair{"free", &table.free},
        std::pair{"free_velocity", &table.free_velocity}})
    if (!finite(*values)) fail(fmt::format("/table/{} holds values that are not finite.", name));
  if (!table.gap.allFinite()) fail("/table/gap holds values that are not finite.");
  if (table.area.size() > 0 && (table.area.size() != m || !(table.area.array() > 0).all()))
    fail("/table/area must be positive, one for each point.");
  for (std::int64_t k = 0; k < m * m && !table.displacement.empty(); ++k)
    if (table.displacement[k] != 0)
      fail(fmt::format("/table/displacement[0] is {}, not 0: sample l is the displacement just before lΔ.",
                       table.displacement[k]));

  std::set<std::string> names;
  for (const FreeBody& body : table.bodies) {
    if (!is_name(body.name) || !names.insert(body.name).second)
      fail("/bodies/name: names are of letters, digits, - and _, and each is given once.");
    if (!(body.mass > 0) || !std::isfinite(body.mass))
      fail(fmt::format("/bodies/mass of {} is {} kg: must be positive.", body.name, body.mass));
    if (!body.velocity.allFinite() || !body.gravity.allFinite() || !body.push.allFinite())
      fail(fmt::format("/bodies: {} has values that are not finite.", body.name));
    if (body.push.rows() != m || body.push.cols() != 3)
      fail(fmt::format("/bodies/push of {} is not of shape ({}, 3).", body.name, m));
  }
  if (table.free.empty() && table.bodies.empty())
    fail("nothing says how the points move without contact: give /table/free, or /bodies.");
  if (std::ssize(table.free) != K * m || (!table.free.empty() && K < 2))
    fail(fmt::format("/table/free must hold at least 2 instants of {} points.", m));
  if (!table.free_velocity.empty() && table.free_velocity.size() != table.free.size())
    fail("/table/free_velocity has another shape than /table/free.");
  for (std::int64_t i = 0; i < m && K > 0; ++i)
    if (const double depth = table.free[i] - table.gap(i);
        depth > touching * (std::abs(table.free[i]) + std::abs(table.gap(i))))
      fail(fmt::format(
          "point {} overlaps by {:.6g} m at the start: its gap must not be below /table/free[0].", i, depth));
  if (K == 0 && (table.gap.array() < 0).any()) fail("/table/gap must not be negative.");

  if (table.tail == Tail::none) return;
  for (const auto& [name, kernel] :
       {std::pair{"displacement", &table.displacement}, std::pair{"velocity", &table.velocity},
        std::pair{"flexibility", &table.flexibility}})
    if (!kernel->empty())
      if (const double off = Convolution::departure(*kernel, static_cast<int>(m), static_cast<int>(m));
          off > straight)
        fail(fmt::format(
            "/table/{} is said to end in a straight line, but its last tenth departs from one by {:.2g} "
            "of its largest value (at most {:g}): make it longer, or set tail = \"none\".",
            name, off, straight));
}

Table read_table(const std::filesystem::path& path) {
  const Reader file(path, advice);
  if (!file.has_attribute("/", "format") || file.string_attribute("/", "format") != table_format)
    file.fail("is not a table (no attribute format = \"ricochet-table\").");
  if (const std::int64_t version = file.integer_attribute("/", "version"); version != table_version)
    file.fail(fmt::format("has format version {}, and this program reads {}.", version, table_version));
  Table table;
  table.step = file.read<double>("/table/step", {}).at(0);
  table.gap = vector(file.read<double>("/table/gap", {any}));
  const std::size_t m = static_cast<std::size_t>(table.gap.size());
  const auto optional = [&](const std::string& name, const base::hdf5::Shape& shape) {
    return file.exists("/table/" + name) ? file.read<double>("/table/" + name, shape) : std::vector<double>{};
  };
  table.flexibility = optional("flexibility", {any, m, m});
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

void write_table(const Table& table, const std::filesystem::path& path) {
  validate(table, path.string());
  const auto m = static_cast<std::size_t>(table.points()), L = static_cast<std::size_t>(table.samples()),
             K = static_cast<std::size_t>(table.instants());
  Writer file(path);
  file.attribute("/", "format", table_format);
  file.attribute("/", "version", table_version);
  file.write<double>("/table/step", {table.step}, {}, "s");
  file.attribute("/table", "tail", table.tail == Tail::linear ? "linear" : "none");
  const auto write = [&](const char* name, const std::vector<double>& values,
                         const base::hdf5::Shape& shape, const char* unit) {
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
      add(velocity, flat(Vector(body.velocity)));
      add(gravity, flat(Vector(body.gravity)));
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

Table table_from_modes(const Model& model, const StepOptions& options, std::int64_t steps) {
  const bool compliant = options.scheme == Scheme::compliant;
  const Eigen::Index N = model.omega.size(), m = model.gap.size();
  // A mean rate takes one sample and one instant more.
  const int more = !compliant && options.admittance == Admittance::difference ? 1 : 0;
  const std::int64_t L = std::max<std::int64_t>(2, steps + more), K = steps + 1 + more;
  Table table;
  table.step = options.step;
  table.gap = model.gap;
  table.area = model.area;

  // Without contact: the same bodies, out of reach of each other.
  Model apart = model;
  apart.gap.setConstant(1e300);
  Integrator motion(apart, options);
  for (std::int64_t k = 0; k < K; ++k) {
    if (k > 0 && motion.step() != StepStatus::ok)
      throw SolverError(fmt::format("the free motion stops being finite at t = {:.6g} s", motion.time()));
    const Vector &u = motion.displacement(), rate = model.B * motion.v();
    table.free.insert(table.free.end(), u.data(), u.data() + m);
    if (!compliant) table.free_velocity.insert(table.free_velocity.end(), rate.data(), rate.data() + m);
  }

  Matrix at_once = model.R;
  std::vector<Series> series;
  std::vector<Eigen::Index> column;
  for (Eigen::Index n = 0; n < N; ++n) {
    const double stiffness = model.omega(n) * model.omega(n);
    if (compliant && model.omega(n) * options.step > std::numbers::pi) {  // as in Integrator
      at_once.noalias() += model.B.col(n) * model.B.col(n).transpose() / stiffness;
      continue;
    }
    const ModeStep by = mode_step(model.omega(n), model.decay(n), options.step);
    series.push_back(compliant ? Series{stiffness, by.c, by.h, by} : Series{stiffness, 0, 1, by});
    column.push_back(n);
  }
  const Matrix B = model.B(Eigen::all, column);
  Matrix weighted(m, B.cols()), sample(m, m);
  const auto append = [&](std::vector<double>& to, auto coefficient) {
    for (Eigen::Index n = 0; n < B.cols(); ++n) weighted.col(n) = coefficient(series[n]) * B.col(n);
    sample.noalias() = weighted * B.transpose();
    if (compliant && to.empty()) sample += at_once;
    to.insert(to.end(), sample.data(), sample.data() + m * m);
  };
  const std::size_t size = static_cast<std::size_t>(L * m * m);
  for (std::vector<double>* kernel :
       compliant ? std::vector{&table.flexibility} : std::vector{&table.displacement, &table.velocity})
    kernel->reserve(size);
  for (std::int64_t l = 0; l < L; ++l) {
    if (compliant) {
      append(table.flexibility, [](const Series& s) { return s.q; });
    } else {
      append(table.displacement, [](const Series& s) { return s.q; });
      append(table.velocity, [](const Series& s) { return s.v; });
    }
    for (Series& s : series) s.advance();
  }

  for (std::size_t k = 0; k < model.bodies.size(); ++k) {
    const Model::BodyBlock& block = model.bodies[k];
    if (block.supported) continue;
    FreeBody body{block.name, block.mass,
                  block.momentum * model.v0.segment(block.first_mode, block.modes) / block.mass,
                  block.weight / block.mass, Matrix::Zero(m, 3)};
    for (const Model::PairBlock& pair : model.pairs)
      for (const auto& [side, sign] : {std::pair{pair.a, -1.0}, std::pair{pair.b, 1.0}})
        if (side == static_cast<int>(k))
          body.push.middleRows(pair.first_point, pair.points) =
              sign * model.normal.middleRows(pair.first_point, pair.points);
    table.bodies.push_back(body);
  }
  return table;
}

}  // namespace ricochet::contact
