// SPDX-License-Identifier: BSD-2-Clause
#include "python/bindings/simulation.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include "contact/api/scene_model.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/turns.hpp"
#include "ricochet/ricochet.hpp"
#include "src/impact/runner.hpp"
#include "src/scene/scene.hpp"
#include "src/store/placing.hpp"

namespace ricochet::python {

namespace py = pybind11;

namespace {

using KernelPointer = std::shared_ptr<kernels::Kernel>;
using Rows = py::array_t<double, py::array::c_style>;

/// Number of steps between two checks for signals.
constexpr std::int64_t longest_block = 1024;

/// Refuses settings that only a complete run supports: ricochet/ricochet.hpp does not provide them.
void check_steppable(const scene::Scene& scene) {
  const auto refuse = [&](const char* key, const char* what) {
    throw InputError(fmt::format("{}: {}: a Simulation cannot step {}. Leave it out, or use impact.",
                                 scene.file.filename().string(), key, what));
  };
  if (scene.contact.kernel == scene::ContactKernel::table)
    refuse("contact.kernel", "kernels of the kind \"table\"");
  if (scene.contact.scheme == Scheme::at_rest) refuse("contact.scheme", "bodies at rest");
}

Scene scene_of(const scene::Scene& scene, const std::vector<KernelPointer>& kernels,
               const std::vector<Pickup>& pickups) {
  store::KernelPointers pointers;
  for (const KernelPointer& kernel : kernels) pointers.push_back(kernel.get());
  Scene out = store::library_scene(scene, pointers);
  for (std::size_t k = 0; k < kernels.size(); ++k) out.bodies[k].kernel = kernels[k];
  store::read_histories(scene, out);
  out.pickups = pickups;
  return out;
}

class Stepper {
 public:
  Stepper(scene::Scene scene, const std::vector<KernelPointer>& kernels, const std::vector<Pickup>& pickups)
      : scene_((check_steppable(scene), std::move(scene))),
        simulation_(
            store::in_file(scene_.file, [&] { return Simulation(scene_of(scene_, kernels, pickups)); })) {}

  /// What `read` returns of the simulation between two blocks of steps.
  template <class Read>
  auto read(Read&& read) {
    return turns_.settled([&] { return read(simulation_); });
  }
  /// What `change` returns. Throws std::runtime_error while another thread steps.
  template <class Do>
  auto change(Do&& change) {
    const Turns::Change own(turns_);
    return turns_.settled([&] { return change(simulation_); });
  }

  /// Makes the steps and writes a row for each into the requested arrays. Throws the error of a step that
  /// fails, or of the callback. @return the number of steps, fewer than requested if the callback ended them
  std::int64_t step_block(std::int64_t steps, std::optional<Rows>& velocity, std::optional<Rows>& total_force,
                          std::optional<Rows>& force, std::optional<Rows>& displacement,
                          std::optional<Rows>& tangential_force) {
    const Turns::Change own(turns_);
    const auto data = [](std::optional<Rows>& rows) { return rows ? rows->mutable_data() : nullptr; };
    Block out{data(velocity), data(total_force), data(force), data(displacement), data(tangential_force)};
    const auto points = static_cast<std::int64_t>(simulation_.points().size()),
               pickups = static_cast<std::int64_t>(simulation_.pickups());
    std::int64_t made = 0;
    for (std::int64_t count = 0; made < steps; made += count) {
      count = std::min(steps - made, longest_block);
      const BlockResult result = turns_.unlocked([&] { return simulation_.step_block(count, out); });
      rethrow();
      check(result.status);
      if (result.steps < count) return made + result.steps;
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      const auto advance = [count](double*& rows, std::int64_t columns) {
        if (rows != nullptr) rows += count * columns;
      };
      advance(out.velocity, pickups);
      advance(out.total_force, 1);
      advance(out.force, points);
      advance(out.displacement, points);
      advance(out.tangential_force, 3 * points);
    }
    return made;
  }

  void step() {
    const Turns::Change own(turns_);
    const StepStatus status = turns_.unlocked([&] { return simulation_.step(); });
    rethrow();
    check(status);
  }

  /// @param callback  called with the time and the list of contacts(); None: no longer
  void on_contact(const py::object& callback) {
    const Turns::Change own(turns_);
    callback_ = callback;
    simulation_.on_contact(callback.is_none() ? nullptr : &Stepper::call, this);
  }

  void watch() {
    change([&](Simulation& simulation) {
      simulation.watch(impact::limits_of(scene_), impact::slowest_wave(scene_));
      return 0;
    });
  }

  /// @param friction  null, or its three numbers
  void add(const std::string& name, const KernelPointer& kernel, const Vector3& position,
           const std::array<double, 4>& attitude, const Vector3& velocity, const Vector3& spin,
           const std::optional<std::array<double, 3>>& friction) {
    std::optional<Friction> rubs;
    if (friction) rubs = {(*friction)[0], (*friction)[1], (*friction)[2]};
    change([&](Simulation& simulation) {
      store::in_file(scene_.file, [&] {
        return simulation.add(name, kernel, {position, attitude, velocity, spin}, rubs);
      });
    });
  }
  void remove(const std::string& name) {
    change([&](Simulation& simulation) {
      store::in_file(scene_.file, [&] {
        simulation.remove(number_of(name));
        return 0;
      });
    });
  }

  /// The state that bytes hold. Throws InputError as Simulation::state does.
  std::shared_ptr<Simulation::State> state(const std::string& bytes) {
    return change([&](const Simulation& simulation) {
      return store::in_file(scene_.file, [&] {
        return std::make_shared<Simulation::State>(simulation.state(std::as_bytes(std::span(bytes))));
      });
    });
  }

  /// Throws InputError if no body that is there has this name.
  std::size_t number_of(const std::string& name) const {
    if (const auto found = simulation_.find(name)) return *found;
    std::string names;
    for (const std::size_t body : simulation_.bodies())
      names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", simulation_.name(body));
    throw InputError(fmt::format("{}: there is no body \"{}\": there are {}.",
                                 scene_.file.filename().string(), name, names.empty() ? "none" : names));
  }
  std::vector<std::string> bodies() {
    return read([](const Simulation& simulation) {
      std::vector<std::string> out;
      for (const std::size_t body : simulation.bodies()) out.emplace_back(simulation.name(body));
      return out;
    });
  }

  /// Names, number of the point, place, normal and force of each point that touches.
  py::list contacts() {
    return read([](Simulation& simulation) { return listed(simulation.contacts()); });
  }

  /// (displacement, velocity) of the modes of a body.
  py::tuple modal_coordinates(const std::string& name) {
    return read([&](const Simulation& simulation) {
      const std::size_t body = number_of(name);
      py::array_t<double> displacement(length(simulation.modes(body))), velocity(displacement.size());
      simulation.modal_coordinates(body, displacement.mutable_data(), velocity.mutable_data());
      return py::make_tuple(displacement, velocity);
    });
  }

 private:
  static py::list listed(std::span<const Touching> contacts) {
    py::list out;
    for (const Touching& one : contacts)
      out.append(py::make_tuple(one.between[0], one.between[1], one.point, copy(one.place), copy(one.normal),
                                copy(one.force)));
    return out;
  }

  /// Calls the callback during a step, without the GIL at first. An exception ends the block, which rethrows
  /// it.
  static bool call(void* self, std::span<const Touching> contacts) {
    auto& stepper = *static_cast<Stepper*>(self);
    const py::gil_scoped_acquire gil;
    try {
      const py::object answer = stepper.callback_(stepper.simulation_.time(), listed(contacts));
      return answer.is_none() || answer.cast<bool>();
    } catch (...) {
      stepper.raised_ = std::current_exception();
      return false;
    }
  }

  /// Throws what the callback has thrown. Needs the GIL.
  void rethrow() {
    if (raised_) std::rethrow_exception(std::exchange(raised_, nullptr));
  }

  void check(StepStatus status) { impact::check(status, scene_, simulation_.time()); }

  scene::Scene scene_;
  Simulation simulation_;
  Turns turns_;
  py::object callback_ = py::none();
  std::exception_ptr raised_{};
};

/// A vector of every contact point as an array (m,3).
py::array_t<double> vectors(const Simulation& simulation, Vector3 ContactPoint::*which) {
  py::array_t<double> out({length(simulation.points().size()), length(3)});
  double* to = out.mutable_data();
  for (const ContactPoint& point : simulation.points()) to = std::copy_n((point.*which).data(), 3, to);
  return out;
}

/// A number of every contact point as an array (m).
py::array_t<double> numbers(const Simulation& simulation, double ContactPoint::*which) {
  py::array_t<double> out(length(simulation.points().size()));
  double* to = out.mutable_data();
  for (const ContactPoint& point : simulation.points()) *to++ = point.*which;
  return out;
}

py::dict energy(const Simulation& simulation) {
  const Energy e = simulation.energy();
  py::dict out;
  out["kinetic"] = e.kinetic;
  out["strain"] = e.strain;
  out["residual"] = e.residual;
  out["loads"] = e.loads;
  out["damping"] = e.damping;
  out["contact"] = e.contact;
  out["friction"] = e.friction;
  out["total"] = e.total();
  out["added"] = e.added;
  return out;
}

py::array_t<double> array(const contact::Matrix& values) {
  py::array_t<double> out({values.rows(), values.cols()});
  std::copy_n(values.data(), values.size(), out.mutable_data());
  return out;
}

py::array_t<double> array(const contact::Vector& values) {
  return py::array_t<double>(values.size(), values.data());
}

/// The constant system of a scene that Simulation steps (contact/model/model.hpp), by the names of its parts.
py::dict contact_system(const scene::Scene& scene, const std::vector<KernelPointer>& kernels,
                        const std::vector<Pickup>& pickups) {
  check_steppable(scene);
  const Scene asked = scene_of(scene, kernels, pickups);
  const contact::Model model = store::in_file(scene.file, [&] { return model_of(asked); });
  py::dict out;
  out["B"] = array(model.B);
  out["R"] = array(model.R);
  out["gap"] = array(model.gap);
  out["bulge"] = array(model.bulge);
  out["area"] = array(model.area);
  out["point_a"] = array(model.point_a);
  out["point_b"] = array(model.point_b);
  out["normal"] = array(model.normal);
  out["rate"] = array(model.v0);
  py::list rotations, translations;
  for (const contact::Bodies::Block& body : model.bodies) {
    rotations.append(array(contact::Matrix(body.rotation)));
    translations.append(array(contact::Vector(body.translation)));
  }
  out["rotation"] = rotations;
  out["translation"] = translations;
  out["pickups"] = array(pickups_of(asked, model));
  return out;
}

py::array_t<double> pickups(const Simulation& simulation,
                            double (Simulation::*what)(std::size_t) const noexcept) {
  py::array_t<double> out(length(simulation.pickups()));
  for (std::size_t k = 0; k < simulation.pickups(); ++k) out.mutable_data()[k] = (simulation.*what)(k);
  return out;
}

}  // namespace

void bind_simulation(py::module_& module) {
  py::class_<Simulation::State, std::shared_ptr<Simulation::State>>(module, "State")
      .def("bytes", [](const Simulation::State& state) {
        const std::vector<std::byte> bytes = state.bytes();
        return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      });
  py::class_<Pickup>(module, "Pickup")
      .def(py::init([](std::string body, std::string receiver, std::size_t candidate, Vector3 direction) {
        return Pickup{std::move(body), std::move(receiver), candidate, direction};
      }));
  module.def("contact_system", &contact_system);
  py::class_<Stepper> stepper(module, "Simulation");
  stepper.def(py::init<scene::Scene, const std::vector<KernelPointer>&, const std::vector<Pickup>&>())
      .def("step", &Stepper::step)
      .def("step_block", &Stepper::step_block)
      .def("save",
           [](Stepper& self) {
             return self.change(
                 [](const Simulation& s) { return std::make_shared<Simulation::State>(s.save()); });
           })
      .def("restore",
           [](Stepper& self, const Simulation::State& state) {
             return self.change([&](Simulation& s) { return s.restore(state); });
           })
      .def("state", &Stepper::state);
  const auto property = [&](const char* name, auto get) {
    stepper.def_property_readonly(name, [get](Stepper& self) { return self.read(get); });
  };
  property("steps", [](const Simulation& s) { return s.steps(); });
  property("time", [](const Simulation& s) { return s.time(); });
  property("active", [](const Simulation& s) { return s.active(); });
  property("force", [](const Simulation& s) { return copy(s.force()); });
  property("displacement", [](const Simulation& s) { return copy(s.displacement()); });
  property("tangential_force", [](const Simulation& s) {
    py::array_t<double> out({length(s.points().size()), length(3)});
    std::ranges::copy(s.tangential_force(), out.mutable_data());
    return out;
  });
  property("points", [](const Simulation& s) { return s.points().size(); });
  property("point_a", [](const Simulation& s) { return vectors(s, &ContactPoint::a); });
  property("point_b", [](const Simulation& s) { return vectors(s, &ContactPoint::b); });
  property("normal", [](const Simulation& s) { return vectors(s, &ContactPoint::normal); });
  property("initial_gap", [](const Simulation& s) { return numbers(s, &ContactPoint::gap); });
  property("area", [](const Simulation& s) { return numbers(s, &ContactPoint::area); });
  property("pickup_velocity", [](const Simulation& s) { return pickups(s, &Simulation::pickup_velocity); });
  property("pickup_displacement",
           [](const Simulation& s) { return pickups(s, &Simulation::pickup_displacement); });
  property("energy", &energy);
  property("warnings", [](const Simulation& s) { return s.warnings(); });
  property("quasi_static_modes", [](const Simulation& s) { return s.quasi_static_modes(); });
  stepper.def("add", &Stepper::add)
      .def("remove", &Stepper::remove)
      .def_property_readonly("bodies", &Stepper::bodies);
  stepper.def("body_motion", [](Stepper& self, const std::string& body) {
    const BodyMotion motion =
        self.read([&](const Simulation& s) { return s.body_motion(self.number_of(body)); });
    return py::make_tuple(copy(motion.position), copy(motion.attitude), copy(motion.velocity),
                          copy(motion.spin));
  });
  stepper.def("contacts", &Stepper::contacts)
      .def("on_contact", &Stepper::on_contact)
      .def("modal_coordinates", &Stepper::modal_coordinates)
      .def("watch", &Stepper::watch);
  stepper.def(
      "push", [](Stepper& self, const std::string& body, const Vector3& force, const Vector3& torque) {
        return self.change([&](Simulation& s) { return s.push(self.number_of(body), force, torque); });
      });
  stepper.def("push_at", [](Stepper& self, const std::string& body, const std::string& receiver,
                            std::size_t candidate, const Vector3& force) {
    return self.change([&](Simulation& s) {
      return s.push_at(self.number_of(body), {receiver, candidate}, force);
    });
  });
  stepper.def("mean_velocity", [](Stepper& self, const std::string& body) {
    return self.read([&](const Simulation& s) { return copy(s.mean_velocity(self.number_of(body))); });
  });
}

}  // namespace ricochet::python
