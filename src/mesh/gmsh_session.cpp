// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/gmsh_session.hpp"

#include <cxxabi.h>
#include <gmsh.h>

#include <cstdlib>
#include <exception>
#include <memory>
#include <new>

namespace ricochet::mesh {

namespace {

bool has_broken_model = false;

}  // namespace

GmshSession::GmshSession() {
  if (has_broken_model) {
    gmsh::model::add("");
    gmsh::option::setNumber("Mesh.MeshSizeFactor", 1);  // the only option of open_model
    return;
  }
  std::string name = "gmsh", verbosity = "-v", none = "0";
  char* words[] = {name.data(), verbosity.data(), none.data()};
  gmsh::initialize(3, words, /*readConfigFiles=*/false);
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::option::setNumber("General.NumThreads", 1);
}

GmshSession::~GmshSession() {
  gmsh::onelab::clear();  // definitions of a .geo would override the defaults of the next one
  if (!has_broken_model) gmsh::finalize();
}

void GmshSession::keep_broken_model() { has_broken_model = true; }

void forget_meshes() { has_broken_model ? gmsh::model::remove() : gmsh::clear(); }

std::string text_of_current_exception() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return "needs more memory than there is: choose larger elements";
  } catch (const std::exception& error) {
    return error.what();
  } catch (const std::string& message) {
    return message;
  } catch (int code) {
    return "error " + std::to_string(code);
  } catch (...) {
    const std::type_info* const type = abi::__cxa_current_exception_type();
    if (type == nullptr) return "an unknown error";
    int status = 0;
    const std::unique_ptr<char, void (*)(void*)> name(
        abi::__cxa_demangle(type->name(), nullptr, nullptr, &status), std::free);
    return name ? name.get() : type->name();
  }
}

}  // namespace ricochet::mesh
