// SPDX-License-Identifier: BSD-2-Clause
// The TOML parser with the fuzzer's eyes on it, in the place of the shared library's, and like that without
// its assertions.
#define NDEBUG
#define TOML_IMPLEMENTATION
#include <toml++/toml.h>
