// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/apart.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmsh.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iterator>
#include <optional>

#include "base/memory.hpp"
#include "src/mesh/child.hpp"
#include "src/mesh/file_kinds.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/transport.hpp"

namespace ricochet::mesh {

namespace {

struct Limits {
  double bytes = 0, seconds = 0;
};

enum class Wanted { mesh, extent, triangles };

/// What a child is to read.
struct Request {
  Limits limits;
  Wanted wanted = Wanted::mesh;
  scene::Body body;
  RequestedGroups asked;
};

template <class Stream>
void pass(Stream& stream, Request& request) {
  pass_all(stream, request.limits, request.wanted, request.body, request.asked);
}

/// The answer is a sequence of parts: a header and its bytes.
enum class AnswerKind : std::uint64_t { progress, refused, failed, wanted };
struct Header {
  AnswerKind kind{};
  std::uint64_t size = 0;
};
struct Stage {
  std::int64_t done = 0, total = 0;
};

// ---- the parent ----

/// A positive number from the environment. Throws InputError if it is something else.
double from_environment(const char* name, double otherwise) {
  const char* text = std::getenv(name);
  if (text == nullptr) return otherwise;
  double value = 0;
  const auto [end, error] = std::from_chars(text, text + std::strlen(text), value);
  if (error != std::errc() || *end != '\0' || !(value > 0) || !std::isfinite(value))
    throw InputError(fmt::format("{} = \"{}\": must be a positive number", name, text));
  return value;
}

/// What gmsh may take in any case [MiB]. Whether the matrices of the mesh fit is judged before they are
/// assembled, with their figures.
constexpr double least_mib = 256;

Limits current_limits() {
  return {base::mib *
              from_environment("RICOCHET_MESH_MIB", std::max(base::available_bytes() / base::mib, least_mib)),
          from_environment("RICOCHET_MESH_SECONDS", 3600)};
}

/// The parts of an answer as they arrive.
class Answer {
 public:
  explicit Answer(const parallel::Progress& progress) : progress_(progress) {}

  void add(const char* data, std::size_t size) {
    bytes_.append(data, size);
    Header header;
    while (!last_ && bytes_.size() >= sizeof header) {
      std::memcpy(&header, bytes_.data(), sizeof header);
      if (bytes_.size() - sizeof header < header.size) return;
      if (header.kind == AnswerKind::progress) {
        Stage stage;
        std::memcpy(&stage, bytes_.data() + sizeof header, sizeof stage);
        if (progress_) progress_(stage.done, stage.total);
        bytes_.erase(0, sizeof header + header.size);
        continue;
      }
      last_ = header.kind;
      bytes_.erase(0, sizeof header);
    }
  }

  /// The kind of the last part, of which bytes() are the content, if it has arrived.
  std::optional<AnswerKind> last() const { return last_; }
  const std::string& bytes() const { return bytes_; }

 private:
  const parallel::Progress& progress_;
  std::optional<AnswerKind> last_;
  std::string bytes_;
};

/// One line about a child that died without an answer.
InputError no_answer(const scene::Body& body, const Ending& ending, const Limits& limits) {
  const std::string file = body.mesh.filename().string();
  const std::string said =
      ending.last_line.empty() ? "" : fmt::format("; its last message: {}", ending.last_line);
  const int signal = WIFSIGNALED(ending.status) ? WTERMSIG(ending.status) : 0;
  std::string what;
  if (ending.stuck)
    what = fmt::format("stopped working and was ended after {} s", longest_idle_s);
  else if (signal == SIGXCPU)
    what = fmt::format("was ended after {:.4g} s of processor time (RICOCHET_MESH_SECONDS allows more)",
                       limits.seconds);
  else if (signal == SIGKILL || ending.peak_bytes > 0.8 * limits.bytes)
    what = fmt::format("was ended with {:.0f} MiB in use, of {:.0f} MiB that it may take",
                       ending.peak_bytes / base::mib, limits.bytes / base::mib);
  else if (signal != 0)
    what = fmt::format("crashed ({})", strsignal(signal));
  else
    what = fmt::format("ended before there was a mesh{}",
                       body.mesh.extension() == ".geo" ? " (by Exit or Abort?)" : "");
  const char* const remedy =
      signal == 0 && !ending.stuck ? "remove what ends it from the file"
      : is_drawing(body.mesh)
          ? "choose other element sizes, repair the geometry, or mesh it elsewhere and name its .msh"
          : "read it by ricochet import mesh, or mesh it elsewhere and name its .msh";
  return gmsh_error(file, fmt::format("{}{}: {}", what, said, remedy));
}

/// Lets a child answer.
template <class Answered>
Answered ask(const scene::Body& body, Wanted wanted, const RequestedGroups& asked = {},
             const parallel::Progress& progress = {}) {
  Request request{current_limits(), wanted, body, asked};
  Packer packer;
  pass(packer, request);
  Answer answer(progress);
  const Ending ending = run_child(helper_program("ricochet-mesh"), packer.bytes,
                                  [&](const char* data, std::size_t size) { answer.add(data, size); });
  if (answer.last() == AnswerKind::refused) throw InputError(answer.bytes());
  if (answer.last() == AnswerKind::failed) throw std::runtime_error(answer.bytes());
  if (answer.last() != AnswerKind::wanted) throw no_answer(body, ending, request.limits);
  Unpacker unpacker(answer.bytes());
  Answered out;
  pass(unpacker, out);
  return out;
}

bool is_read_here(const scene::Body& body) { return body.mesh.extension() == ".msh"; }

// ---- the child ----

int answer_to = -1;
std::string name_of_file;

/// Called also while the process ends, so it neither throws nor allocates.
void write_part(AnswerKind kind, const char* data, std::size_t size) {
  const Header header{kind, size};
  const auto write_all = [](const char* from, std::size_t left) {
    while (left > 0) {
      const ssize_t n = write(answer_to, from, left);
      if (n < 0 && errno != EINTR) _exit(1);  // the parent is gone
      from += std::max<ssize_t>(n, 0);
      left -= static_cast<std::size_t>(std::max<ssize_t>(n, 0));
    }
  };
  write_all(reinterpret_cast<const char*>(&header), sizeof header);
  write_all(data, size);
}

void write_part(AnswerKind kind, const std::string& text) { write_part(kind, text.data(), text.size()); }

/// Of an exception that nobody can catch, because it leaves an OpenMP region.
[[noreturn]] void answer_uncaught() {
  write_part(AnswerKind::refused, gmsh_error(name_of_file, text_of_current_exception()).what());
  _exit(2);
}

void limit(int resource, double value) {
  rlimit old{};
  if (getrlimit(static_cast<__rlimit_resource_t>(resource), &old) != 0) return;
  const auto wanted = static_cast<rlim_t>(std::min(value, 9e18));
  old.rlim_cur = std::min(wanted, old.rlim_max);
  setrlimit(static_cast<__rlimit_resource_t>(resource), &old);
}

std::string all_of_stdin() {
  std::string bytes;
  char buffer[4096];
  for (ssize_t n = 0; (n = read(0, buffer, sizeof buffer)) > 0;)
    bytes.append(buffer, static_cast<std::size_t>(n));
  return bytes;
}

void answer_to_request(Request& request) {
  const GmshSession gmsh;
  gmsh::option::setNumber("General.Terminal", 1);
  gmsh::option::setNumber("General.Verbosity", 4);
  Packer packer;
  if (request.wanted == Wanted::extent) {
    Extent extent;
    with_gmsh_errors(name_of_file, [&] { extent = extent_of(request.body); });
    pass(packer, extent);
  } else if (request.wanted == Wanted::triangles) {
    Triangulation triangles = triangulate(request.body);
    pass(packer, triangles);
  } else {
    const auto progress = [](std::int64_t done, std::int64_t total) {
      const Stage stage{done, total};
      write_part(AnswerKind::progress, reinterpret_cast<const char*>(&stage), sizeof stage);
    };
    GlobalMesh mesh = read_mesh(request.body, progress, request.asked);
    pass(packer, mesh);
  }
  write_part(AnswerKind::wanted, packer.bytes);
  _exit(0);  // gmsh crashes when it deletes some models
}

}  // namespace

GlobalMesh read_mesh_apart(const scene::Body& body, const parallel::Progress& progress,
                           const RequestedGroups& asked) {
  if (is_read_here(body)) return read_mesh(body, progress, asked);
  return ask<GlobalMesh>(body, Wanted::mesh, asked, progress);
}

Extent extent_apart(const scene::Body& body) {
  if (!is_read_here(body)) return ask<Extent>(body, Wanted::extent);
  Extent extent;
  with_gmsh_errors(body.mesh.filename().string(), [&] { extent = extent_of(body); });
  return extent;
}

Triangulation triangulate_apart(const scene::Body& body) {
  return ask<Triangulation>(body, Wanted::triangles);
}

int answer_request() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // ends with its parent
  answer_to = fcntl(1, F_DUPFD_CLOEXEC, 3);
  dup2(2, 1);  // what gmsh prints
  Request request;
  try {
    const std::string bytes = all_of_stdin();
    Unpacker unpacker(bytes);
    pass(unpacker, request);
    name_of_file = request.body.mesh.filename().string();
  } catch (const std::exception&) {
    static constexpr char advice[] = "ricochet-mesh: is called by ricochet-kernel: run that instead\n";
    return write(2, advice, sizeof advice - 1) > 0 ? 2 : 1;
  }
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, std::ceil(request.limits.seconds));
  limit(RLIMIT_DATA, request.limits.bytes);
  std::set_terminate(answer_uncaught);
  try {
    answer_to_request(request);
  } catch (const InputError& error) {
    write_part(AnswerKind::refused, error.what());
  } catch (const std::exception& error) {
    write_part(AnswerKind::failed, error.what());
  }
  _exit(2);
}

}  // namespace ricochet::mesh
