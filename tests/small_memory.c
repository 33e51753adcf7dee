/* SPDX-License-Identifier: BSD-2-Clause */
/* Lets a program read the file RICOCHET_TEST_MEMINFO in place of /proc/meminfo, as on a machine with less
 * memory. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static FILE* opened(const char* function, const char* path, const char* mode) {
  FILE* (*original)(const char*, const char*) = NULL;
  *(void**)&original = dlsym(RTLD_NEXT, function);
  return original(strcmp(path, "/proc/meminfo") == 0 ? getenv("RICOCHET_TEST_MEMINFO") : path, mode);
}

FILE* fopen(const char* path, const char* mode) { return opened("fopen", path, mode); }
FILE* fopen64(const char* path, const char* mode) { return opened("fopen64", path, mode); }
