// SPDX-License-Identifier: BSD-2-Clause
#include "contact/model/changed_model.hpp"

#include <utility>

namespace ricochet::contact {
namespace {

using Eigen::Index;
using Run = Correspondence::Run;

/// Rows of one of two models, which the new model has from `to` on.
struct Source {
  const Model* model;
  int pair;
};

/// Appends a body with its modes.
void add_body(const Model& source, std::size_t number, Model& out) {
  Bodies::Block block = source.bodies[number];
  const int first = block.first_mode, modes = block.modes;
  block.first_mode = static_cast<int>(out.omega.size());
  const auto append = [&](Vector Bodies::*values) {
    Vector& to = out.*values;
    to.conservativeResize(block.first_mode + modes);
    to.tail(modes) = (source.*values).segment(first, modes);
  };
  for (Vector Bodies::*values : {&Bodies::omega, &Bodies::decay, &Bodies::load, &Bodies::q0, &Bodies::v0})
    append(values);
  out.bodies.push_back(std::move(block));
  const auto columns = static_cast<Index>(source.selection[number].cols());
  for (auto* all : {&out.selection, &out.static_selection}) all->emplace_back(0, columns);
}

/// Number of the first point with friction of a pair, or where it would be.
Index first_friction(const Model& model, const Rows::PairBlock& pair) {
  return (pair.first_tangential - model.points()) / 2;
}

/// Lists the pairs of the new model with their friction, and returns their sources.
std::vector<Source> list_pairs(const Model& earlier, const Model* part, const std::vector<int>& now,
                               ChangedModel& change) {
  Model& out = change.model;
  std::vector<Source> sources;
  int points = 0;
  const auto add = [&](const Model& model, int number, int a, int b) {
    Rows::PairBlock pair = model.pairs[static_cast<std::size_t>(number)];
    pair.a = a;
    pair.b = b;
    pair.first_point = points;
    points += pair.points;
    out.pairs.push_back(std::move(pair));
    sources.push_back({&model, number});
    change.from.pair.push_back(&model == &earlier ? number : -1);
  };
  const auto place = [&](int body) { return body < 0 ? -1 : now[static_cast<std::size_t>(body)]; };
  for (int p = 0; p < static_cast<int>(earlier.pairs.size()); ++p) {
    const Rows::PairBlock& pair = earlier.pairs[static_cast<std::size_t>(p)];
    if (place(pair.a) >= 0 && (pair.b < 0 || place(pair.b) >= 0))
      add(earlier, p, place(pair.a), place(pair.b));
  }
  for (int p = 0; part != nullptr && p < static_cast<int>(part->pairs.size()); ++p)
    add(*part, p, part->pairs[static_cast<std::size_t>(p)].a, part->pairs[static_cast<std::size_t>(p)].b);
  int row = points;
  for (std::size_t p = 0; p < sources.size(); ++p) {
    Rows::PairBlock& pair = out.pairs[p];
    if (pair.first_tangential < 0) continue;
    const Model& source = *sources[p].model;
    const Index first = first_friction(source, source.pairs[static_cast<std::size_t>(sources[p].pair)]);
    pair.first_tangential = row;
    for (int i = 0; i < pair.points; ++i, row += 2)
      out.friction.push_back(
          {pair.first_point + i, row, source.friction[static_cast<std::size_t>(first + i)].law});
  }
  return sources;
}

/// Copies the rows of a model, and lists where they have moved.
void copy_rows(const Model& source, const std::vector<Source>& sources, Model& out, Correspondence& moved) {
  const Index tangents = out.points(), of_source = source.points();
  std::vector<Run> tangential;
  for (std::size_t p = 0; p < sources.size(); ++p) {
    if (sources[p].model != &source) continue;
    const Rows::PairBlock &pair = out.pairs[p],
                          &then = source.pairs[static_cast<std::size_t>(sources[p].pair)];
    moved.points.push_back({then.first_point, pair.first_point, pair.points});
    if (pair.first_tangential < 0) continue;
    tangential.push_back(
        {then.first_tangential - of_source, pair.first_tangential - tangents, 2 * pair.points});
    moved.friction.push_back({first_friction(source, then), first_friction(out, pair), pair.points});
  }
  moved.rows = moved.points;
  for (const Run& run : tangential) moved.rows.push_back({run.from + of_source, run.to + tangents, run.size});
  for (Vector Rows::*values : {&Rows::gap, &Rows::bulge, &Rows::area})
    carry(source.*values, out.*values, moved.points);
  for (Vector Rows::*values : {&Rows::static_displacement, &Rows::static_a, &Rows::patch_R})
    carry(source.*values, out.*values, moved.rows);
  for (Matrix RowFrames::*values : {&RowFrames::point_a, &RowFrames::point_b, &RowFrames::normal})
    carry(source.*values, out.*values, moved.points);
  carry(source.tangent, out.tangent, tangential);
  for (std::vector<int> Rows::*values : {&Rows::faces, &Rows::candidate})
    carry(source.*values, out.*values, moved.points);
}

}  // namespace

std::vector<int> Correspondence::places(const std::vector<Run>& runs, Index size) {
  std::vector<int> out(static_cast<std::size_t>(size), -1);
  for (const auto& [from, to, count] : runs)
    for (Index i = 0; i < count; ++i) out[static_cast<std::size_t>(from + i)] = static_cast<int>(to + i);
  return out;
}

ChangedModel change(const Model& earlier, std::span<const int> kept, const Placement* added) {
  ChangedModel change;
  auto& [out, from] = change;
  out.gravity = earlier.gravity;
  out.turns = true;
  std::vector<int> now(earlier.bodies.size(), -1);
  for (const int k : kept) {
    const Bodies::Block& block = earlier.bodies[static_cast<std::size_t>(k)];
    now[static_cast<std::size_t>(k)] = static_cast<int>(out.bodies.size());
    from.body.push_back(k);
    from.modes.push_back({block.first_mode, out.omega.size(), block.modes});
    add_body(earlier, static_cast<std::size_t>(k), out);
  }
  const std::vector<int> modes = Correspondence::places(from.modes, earlier.omega.size());
  for (std::size_t j = 0; j < earlier.folded.modes.size(); ++j)
    if (const int n = modes[static_cast<std::size_t>(earlier.folded.modes[j])]; n >= 0)
      out.load(n) = earlier.folded.load(static_cast<Index>(j));
  Model part;
  if (added != nullptr) {
    static_cast<Bodies&>(part) = build_bodies(added->bodies, earlier.gravity);
    static_cast<Rows&>(part) = build_rows(*added, part);
    part.q0 += (part.omega.array() > 0).select(part.load.array() / part.omega.array().square(), 0.0).matrix();
    for (std::size_t k = kept.size(); k < added->bodies.size(); ++k) {
      from.body.push_back(-1);
      add_body(part, k, out);
    }
  }
  const std::vector<Source> sources = list_pairs(earlier, added != nullptr ? &part : nullptr, now, change);
  const Index points = sources.empty() ? 0 : out.pairs.back().first_point + out.pairs.back().points,
              rows = points + 2 * std::ssize(out.friction);
  for (Vector* x : {&out.gap, &out.bulge, &out.area}) x->setZero(points);
  for (Vector* x : {&out.static_displacement, &out.static_a, &out.patch_R}) x->setZero(rows);
  for (Matrix* x : {&out.point_a, &out.point_b, &out.normal}) x->setZero(points, 3);
  out.tangent.setZero(rows - points, 3);
  for (std::vector<int>* x : {&out.faces, &out.candidate}) x->assign(static_cast<std::size_t>(points), 0);
  copy_rows(earlier, sources, out, from);
  if (Correspondence of_part; added != nullptr) copy_rows(part, sources, out, of_part);
  for (const Bodies::Block& block : out.bodies)
    out.has_residual = out.has_residual && block.kernel->surface.has_flexibility();
  for (const Model::Forcing& one : earlier.forcing) {
    const int body = now[static_cast<std::size_t>(one.body)];
    if (body < 0) continue;
    out.forcing.push_back(one);
    Model::Forcing& moved = out.forcing.back();
    moved.body = body;
    moved.first_mode = out.bodies[static_cast<std::size_t>(body)].first_mode;
    for (Vector* x : {&moved.displacement, &moved.displacement_a}) x->setZero(rows);
  }
  return change;
}

}  // namespace ricochet::contact
