// Body of with_gmsh_errors.
#pragma once

#include <algorithm>
#include <cctype>
#include <exception>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

/// `message` in one line.
inline InputError gmsh_error(const std::string& where, std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return InputError(where + ": gmsh: " + message);
}

template <class Task>
void with_gmsh_errors(const std::string& where, Task&& task) {
  try {
    task();
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw gmsh_error(where, error.what());
  } catch (const std::string& message) {
    throw gmsh_error(where, message);
  } catch (int code) {
    throw gmsh_error(where, "error " + std::to_string(code));
  }
}

}  // namespace ricochet::mesh
