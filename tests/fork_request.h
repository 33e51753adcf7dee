/* SPDX-License-Identifier: BSD-2-Clause */
/* What fork_client.c sends to fork_server.c, with its three streams. */
#pragma once

#include <stdint.h>
#include <sys/resource.h>

/* Strings that end with 0 follow, `bytes` in all: the words, the variables of the environment and the folder. */
struct Request {
  int32_t words, variables;
  uint64_t bytes;
  struct rlimit limit[RLIM_NLIMITS];
};
