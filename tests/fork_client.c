/* SPDX-License-Identifier: BSD-2-Clause */
/* fork_client PROGRAM WORD…: runs a program by the server of RICOCHET_FORK_SOCKET (fork_server.c), or by itself if the server cannot
 * run it in this environment. Its streams, its signals and its status are those of the program. */
#define _GNU_SOURCE
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fork_request.h"

extern char** environ;
static volatile int32_t program = 0;

static void forward(int number) {
  if (program > 0) kill(program, number);
}

static char* add(char* text, const char* string) { return stpcpy(text, string) + 1; }

int main(int words, char** word) {
  struct Request request = {.words = words - 1};
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  const char* path = getenv("RICOCHET_FORK_SOCKET");
  const int server = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  char* folder = getcwd(NULL, 0);
  if (words < 2) return 2;
  if (path) strncpy(address.sun_path, path, sizeof address.sun_path - 1);
  if (!folder || !path || connect(server, (struct sockaddr*)&address, sizeof address) != 0) {
    execv(word[1], word + 1);
    return 127;
  }
  request.bytes = strlen(folder) + 1;
  for (int i = 1; i < words; ++i) request.bytes += strlen(word[i]) + 1;
  for (char** variable = environ; *variable; ++variable, ++request.variables) request.bytes += strlen(*variable) + 1;
  for (int i = 0; i < RLIM_NLIMITS; ++i) getrlimit((__rlimit_resource_t)i, &request.limit[i]);
  char *text = malloc(request.bytes), *end = text;
  for (int i = 1; i < words; ++i) end = add(end, word[i]);
  for (char** variable = environ; *variable; ++variable) end = add(end, *variable);
  add(end, folder);

  union {
    struct cmsghdr head;
    char room[CMSG_SPACE(3 * sizeof(int))];
  } control = {.head = {.cmsg_len = CMSG_LEN(3 * sizeof(int)), .cmsg_level = SOL_SOCKET, .cmsg_type = SCM_RIGHTS}};
  memcpy(CMSG_DATA(&control.head), (int[]){0, 1, 2}, 3 * sizeof(int));
  struct iovec part = {&request, sizeof request};
  const struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control};
  int32_t number = 0, status = 0;
  signal(SIGPIPE, SIG_IGN);
  sendmsg(server, &message, 0);
  for (size_t done = 0; done < request.bytes;) {
    const ssize_t n = write(server, text + done, request.bytes - done);
    if (n <= 0) return 127;
    done += (size_t)n;
  }
  signal(SIGPIPE, SIG_DFL);
  struct sigaction action = {.sa_handler = forward, .sa_flags = SA_RESTART};
  for (int i = 0; i < 4; ++i) {
    const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};
    struct sigaction before;
    sigaction(signals[i], &action, &before);
    if (before.sa_handler == SIG_IGN) signal(signals[i], SIG_IGN);
  }
  if (read(server, &number, sizeof number) != sizeof number) return 127;
  if (number == 0) {
    execv(word[1], word + 1);
    return 127;
  }
  program = number;
  if (read(server, &status, sizeof status) != sizeof status) return 127;
  if (WIFSIGNALED(status)) {
    signal(WTERMSIG(status), SIG_DFL);
    raise(WTERMSIG(status));
  }
  return WEXITSTATUS(status);
}
