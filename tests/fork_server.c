/* SPDX-License-Identifier: BSD-2-Clause */
/* Preloaded to ricochet-kernel or ricochet-mesh, lets one process serve many runs. Linking their hundreds of libraries takes longer
 * than most bodies of the tests. The process stops before main, where the libraries are linked, and forks for each client of the
 * socket RICOCHET_FORK_SOCKET (fork_client.c). The child takes over the words, environment, folder, limits and streams of the client.
 * The server ends with its standard input.
 *
 * A program that it runs starts ricochet-mesh by the server of the socket RICOCHET_FORK_MESH, if there is one.
 *
 * A program that it runs reads the file RICOCHET_TEST_MEMINFO, if there is one, in place of /proc/meminfo, as on a machine with less
 * memory. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fork_request.h"

extern char** environ;
typedef int (*Main)(int, char**, char**);
static Main program;

/* What libraries have read when they were linked. */
static const char* const linked[] = {"LD_PRELOAD", "LD_LIBRARY_PATH", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OPENBLAS_CORETYPE"};

static int receive(int socket, void* data, size_t size) {
  for (size_t done = 0; done < size;) {
    const ssize_t n = read(socket, (char*)data + done, size - done);
    if (n <= 0) return 0;
    done += (size_t)n;
  }
  return 1;
}

/* Ends this process if the client is gone. */
static void state(int socket, int32_t number) {
  if (write(socket, &number, sizeof number) != sizeof number) _exit(1);
}

static int receive_head(int socket, struct Request* request, int* streams) {
  char control[CMSG_SPACE(3 * sizeof(int))];
  struct iovec part = {request, sizeof *request};
  struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1, .msg_control = control, .msg_controllen = sizeof control};
  if (recvmsg(socket, &message, MSG_WAITALL) != sizeof *request || !CMSG_FIRSTHDR(&message)) return 0;
  memcpy(streams, CMSG_DATA(CMSG_FIRSTHDR(&message)), 3 * sizeof(int));
  return 1;
}

static char** next_strings(char** text, int count) {
  char** strings = calloc((size_t)count + 1, sizeof *strings);
  for (int i = 0; i < count; ++i) {
    strings[i] = *text;
    *text += strlen(*text) + 1;
  }
  return strings;
}

static int same(const char* a, const char* b) { return a == b || (a && b && strcmp(a, b) == 0); }

/* Serves one client: runs the program in a child, states its number and its status, and kills it if the client is gone. */
static void serve(int socket) {
  struct Request request;
  int streams[3], status = 0;
  if (!receive_head(socket, &request, streams)) _exit(1);
  char* text = malloc(request.bytes);
  if (!receive(socket, text, request.bytes)) _exit(1);
  char **words = next_strings(&text, request.words), **variables = next_strings(&text, request.variables), *folder = text;
  char** mine = environ;
  for (size_t i = 0; i < sizeof linked / sizeof *linked; ++i) {
    const char* here = getenv(i == 0 ? "RICOCHET_FORK_PRELOAD" : linked[i]);
    environ = variables;
    const int equal = same(here && *here ? here : NULL, getenv(linked[i]));
    environ = mine;
    if (equal) continue;
    state(socket, 0); /* the client must start a program of its own */
    _exit(0);
  }
  const int32_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (int i = 0; i < 3; ++i) dup2(streams[i], i);
    for (int i = 0; i < 3; ++i) close(streams[i]);
    close(socket);
    for (int i = 0; i < RLIM_NLIMITS; ++i) setrlimit((__rlimit_resource_t)i, &request.limit[i]);
    if (chdir(folder) != 0) _exit(126);
    environ = variables;
    exit(program(request.words, words, variables));
  }
  for (int i = 0; i < 3; ++i) close(streams[i]);
  state(socket, child);
  for (struct pollfd gone = {.fd = socket, .events = POLLIN}; waitpid(child, &status, WNOHANG) == 0;)
    if (poll(&gone, 1, 2) > 0) kill(child, SIGKILL);
  state(socket, status);
  _exit(0);
}

static int serve_all(int words, char** word, char** variables) {
  const char* path = getenv("RICOCHET_FORK_SOCKET");
  if (!path) return program(words, word, variables);
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  strncpy(address.sun_path, path, sizeof address.sun_path - 1);
  const int listening = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (bind(listening, (struct sockaddr*)&address, sizeof address) != 0 || listen(listening, 16) != 0) return 1;
  signal(SIGINT, SIG_IGN); /* meant for the tests */
  if (write(STDOUT_FILENO, "\n", 1) != 1) return 1;
  struct pollfd events[2] = {{.fd = listening, .events = POLLIN}, {.fd = STDIN_FILENO, .events = POLLIN}};
  for (;;) {
    if (poll(events, 2, -1) < 0 && errno != EINTR) return 1;
    while (waitpid(-1, NULL, WNOHANG) > 0) continue;
    if (events[1].revents) return 0;
    if (!events[0].revents) continue;
    const int client = accept4(listening, NULL, NULL, SOCK_CLOEXEC);
    if (fork() == 0) {
      signal(SIGINT, SIG_DFL);
      close(listening);
      serve(client);
    }
    close(client);
  }
}

static FILE* opened(const char* function, const char* path, const char* mode) {
  FILE* (*original)(const char*, const char*) = NULL;
  const char* const other = strcmp(path, "/proc/meminfo") == 0 ? getenv("RICOCHET_TEST_MEMINFO") : NULL;
  *(void**)&original = dlsym(RTLD_NEXT, function);
  return original(other ? other : path, mode);
}

FILE* fopen(const char* path, const char* mode) { return opened("fopen", path, mode); }
FILE* fopen64(const char* path, const char* mode) { return opened("fopen64", path, mode); }

int posix_spawn(pid_t* number, const char* path, const posix_spawn_file_actions_t* files, const posix_spawnattr_t* attributes,
                char* const* words, char* const* variables) {
  int (*original)(pid_t*, const char*, const posix_spawn_file_actions_t*, const posix_spawnattr_t*, char* const*, char* const*) = NULL;
  const char *const server = getenv("RICOCHET_FORK_MESH"), *const client = getenv("RICOCHET_FORK_CLIENT");
  *(void**)&original = dlsym(RTLD_NEXT, "posix_spawn");
  if (!server || !client || strcmp(basename(path), "ricochet-mesh") != 0)
    return original(number, path, files, attributes, words, variables);
  setenv("RICOCHET_FORK_SOCKET", server, 1); /* this process asks no server itself */
  return original(number, client, files, attributes, (char*[]){(char*)client, (char*)path, NULL}, environ);
}

int __libc_start_main(Main, int, char**, void (*)(void), void (*)(void), void (*)(void), void*);

int __libc_start_main(Main given, int words, char** word, void (*init)(void), void (*fini)(void), void (*end)(void), void* stack) {
  int (*start)(Main, int, char**, void (*)(void), void (*)(void), void (*)(void), void*) = NULL;
  *(void**)&start = dlsym(RTLD_NEXT, "__libc_start_main");
  program = given;
  return start(serve_all, words, word, init, fini, end, stack);
}
