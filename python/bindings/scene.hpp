// SPDX-License-Identifier: BSD-2-Clause
// Scenes: conversion between text and checked data.
#pragma once

#include <pybind11/pybind11.h>

namespace ricochet::python {

void bind_scene(pybind11::module_& module);

}  // namespace ricochet::python
