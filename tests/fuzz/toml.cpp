// SPDX-License-Identifier: BSD-2-Clause
// The TOML parser, instrumented for the fuzzer. It replaces that of the shared
// library and, like it, has no assertions.
#define NDEBUG
#define TOML_IMPLEMENTATION
#include <toml++/toml.h>
