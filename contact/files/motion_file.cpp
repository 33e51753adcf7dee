// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/motion_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/xdmf.hpp"
#include "contact/files/axes.hpp"

namespace ricochet::contact {
namespace {

namespace xdmf = base::xdmf;
using base::hdf5::Shape;

std::filesystem::path with(std::filesystem::path stem, const char* ending) { return stem += ending; }

std::string number_of(std::size_t frame) { return fmt::format("/{:06}", frame); }

std::string group_of(const std::string& body) { return "/bodies/" + body; }
std::string group_of_obstacle(std::size_t number) { return fmt::format("/obstacles/{}", number + 1); }
std::string group_of(std::size_t pair) { return fmt::format("/contact/{}", pair + 1); }

template <class Values>
void write(base::hdf5::Writer& file, const std::string& dataset, const Values& x, const char* unit) {
  using T = typename Values::Scalar;
  const auto rows = static_cast<std::size_t>(x.rows()), columns = static_cast<std::size_t>(x.cols());
  file.write(dataset, std::span<const T>(x.data(), rows * columns),
             Values::ColsAtCompileTime == 1 ? Shape{rows} : Shape{rows, columns}, unit);
}

/// The candidate of each point of a pair on its body a, or −1 if the point has several, as coarsened patches
/// do, or none.
std::vector<int> candidates_of(const Model& model, const Model::PairBlock& pair) {
  std::vector<int> out;
  const Selection& selection = model.selection[pair.a];
  const int components = model.bodies[pair.a].kernel->surface.components;
  for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
    int candidate = -1;
    if (model.turns) {
      out.push_back(i < pair.first_point + pair.candidates_of_a ? model.candidate[i] : -1);
      continue;
    }
    for (Selection::InnerIterator it(selection, i); it; ++it) {
      const int of_entry = static_cast<int>(it.col()) / components;
      if (candidate >= 0 && of_entry != candidate) {
        candidate = -1;
        break;
      }
      candidate = of_entry;
    }
    out.push_back(candidate);
  }
  return out;
}

}  // namespace

MotionFile::MotionFile(const Model& model, const StepOptions& step, const MotionOptions& options)
    : model_(model),
      stem_(options.stem),
      every_(options.every),
      file_(with(stem_, ".h5")),
      coordinates_(model),
      obstacles_(obstacle_surfaces(model)) {
  for (std::size_t k = 0; k < model.bodies.size(); ++k) {
    surfaces_.emplace_back(model, static_cast<int>(k), step);
    const kernels::Kernel& kernel = *model.bodies[k].kernel;
    stress_.push_back(has_surface_stress(kernel) ? std::optional<SurfaceStress>(kernel) : std::nullopt);
  }
  for (std::size_t p = 0; p < model.pairs.size(); ++p)
    patches_.push_back(patch_of(model.pairs[p], options.pairs.at(p)));
  write_setting(options);
}

MotionFile::MotionFile(const Stepper& start, const Model& model, const MotionOptions& options)
    : MotionFile(model, start.options(), options) {
  frame(0, start.modal()->q, start.modal()->v, start.displacement(), start.force(), start.end_force(),
        start.slip().states(), start.turning());
}

MotionFile::MotionFile(const Model& model, const MotionOptions& options)
    : MotionFile(model, StepOptions{}, options) {}

void MotionFile::record(const Equilibrium& equilibrium) {
  const Vector rest = Vector::Zero(model_.omega.size());
  frame(equilibrium.time, equilibrium.q, rest, equilibrium.displacement, equilibrium.force, equilibrium.force,
        equilibrium.states, nullptr);
}

MotionFile::Patch MotionFile::patch_of(const Model::PairBlock& pair, const std::string& name) const {
  Patch out;
  out.name = name;
  out.pair = &pair;
  const Bodies::Block& a = model_.bodies[pair.a];
  const kernels::Surface& surface = a.kernel->surface;
  std::map<std::int64_t, std::int64_t> point;
  const std::vector<int> candidates = candidates_of(model_, pair);
  for (std::size_t i = 0; i < candidates.size(); ++i) point[candidates[i]] = static_cast<std::int64_t>(i);
  const auto k = static_cast<std::size_t>(surface.element_corners);
  if (std::ranges::count(candidates, -1) == 0)
    for (std::size_t e = 0; e + k <= surface.element.size(); e += k) {
      std::vector<std::int64_t> corners;
      for (std::size_t j = 0; j < k; ++j)
        if (const auto found = point.find(surface.element[e + j]); found != point.end())
          corners.push_back(found->second);
      if (corners.size() == k) out.element.insert(out.element.end(), corners.begin(), corners.end());
    }
  out.corners = surface.element_corners;
  if (out.element.empty()) {
    out.corners = 1;
    for (int i = 0; i < pair.points; ++i) out.element.push_back(i);
  }
  out.offset = model_.point_a.middleRows(pair.first_point, pair.points);
  out.place = surfaces_[pair.a].closest(out.offset);
  for (int i = 0; i < pair.points; ++i) out.offset.row(i) -= out.place[i].point;
  return out;
}

void MotionFile::write_setting(const MotionOptions& options) {
  file_.attribute("/", "format", "ricochet-motion");
  file_.attribute("/", "version", 1);
  file_.attribute("/", "title", options.title);
  file_.attribute("/", "created_by", options.created_by);
  const auto elements = [&](const std::string& group, const std::vector<std::int64_t>& element, int corners) {
    const auto k = static_cast<std::size_t>(corners);
    file_.write(group + "/element", element, {element.size() / k, k}, "1");
  };
  for (std::size_t k = 0; k < surfaces_.size(); ++k)
    elements(group_of(model_.bodies[k].name), surfaces_[k].view().element,
             surfaces_[k].view().element_corners);
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    elements(group_of_obstacle(o), obstacles_[o].element, 3);
    file_.attribute(group_of_obstacle(o), "name", obstacles_[o].name);
    if (!obstacles_[o].driven) write(file_, group_of_obstacle(o) + "/position", obstacles_[o].node, "m");
  }
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    elements(group_of(p), patches_[p].element, patches_[p].corners);
    file_.attribute(group_of(p), "name", patches_[p].name);
    write(file_, group_of(p) + "/area",
          Vector(model_.area.segment(model_.pairs[p].first_point, model_.pairs[p].points)), "m^2");
  }
}

void MotionFile::record(const Stepper& stepper) {
  if (!stepper.at_sample() || stepper.steps() / stepper.options().steps_per_sample % every_ != 0) return;
  frame(stepper.time(), stepper.modal()->q, stepper.modal()->v, stepper.displacement(), stepper.force(),
        stepper.end_force(), stepper.slip().states(), stepper.turning());
}

void MotionFile::frame(double t, const Vector& q, const Vector& v, const Vector& u, const Vector& force,
                       const Vector& end_force, std::span<const ContactState> states,
                       const Turning* turning) {
  const std::string number = number_of(time_.size());
  coordinates_.set(t, q, end_force, turning);
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    const std::string group = group_of(model_.bodies[k].name);
    const SurfaceMotion& surface = surfaces_[k].at(t, q, v, end_force, turning);
    write(file_, group + "/position" + number, surface.position, "m");
    write(file_, group + "/deformation" + number, surface.deformation, "m");
    write(file_, group + "/velocity" + number, surface.velocity, "m/s");
    if (stress_[k]) write(file_, group + "/von_mises" + number, stress_[k]->von_mises(coordinates_[k]), "Pa");
    for (std::size_t p = 0; p < patches_.size(); ++p)
      if (patches_[p].pair->a == static_cast<int>(k))
        contact_frame(p, number, u, force, states, surface, turning);
  }
  for (std::size_t o = 0; o < obstacles_.size(); ++o)
    if (obstacles_[o].driven)
      write(file_, group_of_obstacle(o) + "/position" + number, obstacles_[o].at(t), "m");
  time_.push_back(t);
}

void MotionFile::contact_frame(std::size_t pair, const std::string& number, const Vector& u,
                               const Vector& force, std::span<const ContactState> states,
                               const SurfaceMotion& surface, const Turning* turning) {
  const RowFrames& frames = turning ? turning->frames : model_;
  const Patch& patch = patches_[pair];
  const Model::PairBlock& points = *patch.pair;
  const auto own = [&](const Vector& x) -> Vector { return x.segment(points.first_point, points.points); };
  Matrix position = patch.offset;
  for (int i = 0; i < points.points; ++i) {
    const SurfacePoint& place = patch.place[i];
    for (std::size_t j = 0; j < 3; ++j)
      position.row(i) += place.weight[j] * surface.position.row(place.node[j]).cast<double>();
  }
  if (turning && !points.is_half_space())
    position = frames.point_a.middleRows(points.first_point, points.points);
  const Vector lambda = own(force);
  const std::string group = group_of(pair);
  write(file_, group + "/position" + number, position, "m");
  write(file_, group + "/force" + number, lambda, "N");
  write(file_, group + "/pressure" + number, Vector(lambda.cwiseQuotient(own(model_.area))), "Pa");
  write(file_, group + "/gap" + number, Vector(own(model_.gap) - own(u)), "m");
  Matrix push = lambda.asDiagonal() * -frames.normal.middleRows(points.first_point, points.points);
  if (points.first_tangential >= 0) {
    Vector state(points.points);
    for (std::size_t f = 0; f < states.size(); ++f) {
      const Model::FrictionPoint& point = model_.friction[f];
      const int i = point.point - points.first_point;
      if (i < 0 || i >= points.points) continue;
      state(i) = static_cast<double>(states[f]);
      push.row(i) -= force.segment<2>(point.tangential).transpose() *
                     frames.tangent.middleRows(point.tangential - model_.points(), 2);
    }
    write(file_, group + "/state" + number, state, "1");
  }
  write(file_, group + "/push" + number, push, "N");
}

std::filesystem::path MotionFile::xdmf() const { return with(stem_, ".xdmf"); }

void MotionFile::commit(const std::string& run) {
  write(file_, "/time", Vector(Eigen::Map<const Vector>(time_.data(), time_.size())), "s");
  // An .xdmf of an earlier run would not match the new data.
  std::error_code ignored;
  std::filesystem::remove(xdmf(), ignored);
  if (!run.empty()) file_.attribute("/", "run", run);
  name_axes_of_motion(file_);
  file_.commit();
  write_xdmf();
}

void MotionFile::write_xdmf() const {
  xdmf::File text(xdmf(), file_.path().filename().string());
  const auto film = [&](xdmf::Grid grid, const std::string& group, const std::vector<xdmf::Field>& moving) {
    const std::vector<xdmf::Field> steady = grid.fields;
    text.begin(grid.name);
    for (std::size_t k = 0; k < time_.size(); ++k) {
      grid.fields = steady;
      for (xdmf::Field field : moving) {
        field.dataset = group + "/" + field.name + number_of(k);
        if (field.name == "position")
          grid.position = field;
        else
          grid.fields.push_back(field);
      }
      text.add(grid, time_[k]);
    }
    text.end();
  };
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    const kernels::View& view = surfaces_[k].view();
    const std::string &name = model_.bodies[k].name, group = group_of(name);
    std::vector<xdmf::Field> moving{
        {"position", "", true, 4}, {"deformation", "", true, 4}, {"velocity", "", true, 4}};
    if (stress_[k]) moving.push_back({"von_mises", "", false, 4});
    film({.name = name,
          .corners = view.element_corners,
          .elements = view.element.size() / static_cast<std::size_t>(view.element_corners),
          .nodes = surfaces_[k].nodes(),
          .element = group + "/element"},
         group, moving);
  }
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const ObstacleSurface& obstacle = obstacles_[o];
    const std::string group = group_of_obstacle(o);
    std::vector<xdmf::Field> moving;
    if (obstacle.driven) moving.push_back({"position", "", true, 8});
    film({.name = obstacle.name,
          .corners = 3,
          .elements = obstacle.element.size() / 3,
          .nodes = static_cast<std::size_t>(obstacle.node.rows()),
          .element = group + "/element",
          .position = {"position", group + "/position", true, 8}},
         group, moving);
  }
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const Patch& patch = patches_[p];
    std::vector<xdmf::Field> fields{{"position", "", true, 8},
                                    {"force", "", false, 8},
                                    {"pressure", "", false, 8},
                                    {"gap", "", false, 8},
                                    {"push", "", true, 8}};
    if (patch.pair->first_tangential >= 0) fields.push_back({"state", "", false, 8});
    film({.name = patch.name,
          .corners = patch.corners,
          .elements = patch.element.size() / static_cast<std::size_t>(patch.corners),
          .nodes = static_cast<std::size_t>(patch.pair->points),
          .element = group_of(p) + "/element",
          .fields = {{"area", group_of(p) + "/area", false, 8}}},
         group_of(p), fields);
  }
  text.commit();
}

}  // namespace ricochet::contact
