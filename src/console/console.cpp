// SPDX-License-Identifier: BSD-2-Clause
#include "src/console/console.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace ricochet::console {

namespace {

constexpr int name_width = 42;  // "part: slices, round 1 of 4 (2 at a time)"

}  // namespace

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string duration_of(double seconds) {
  if (seconds < 100) return fmt::format("{:.2f} s", seconds);
  if (seconds < 6000)
    return fmt::format("{:.0f} min {:02.0f} s", static_cast<double>(static_cast<int>(seconds / 60)),
                       static_cast<double>(static_cast<int>(seconds) % 60));
  return fmt::format("{:.1f} h", seconds / 3600);
}

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

Console::Console(bool quiet, std::function<double()> peak, Watch watch)
    : quiet_(quiet),
      peak_(std::move(peak)),
      watch_(std::move(watch)),
      terminal_(isatty(STDERR_FILENO) != 0) {}

void Console::begin(std::string name, std::int64_t total) {
  if (open_) end();
  name_ = std::move(name);
  total_ = total;
  done_ = 0;
  started_ = now();
  drawn_ = 0;
  open_ = true;
  draw(false);
}

void Console::advance(std::int64_t done) {
  done_ = done;
  if (watch_) watch_(name_, done, total_);
  // Reading the clock may take longer than a step, so with many steps it is read at every 64th only.
  if (open_ && terminal_ && !quiet_ && (total_ < 1000 || (done & 63) == 0)) draw(false);
}

void Console::advance(std::int64_t done, std::int64_t total) {
  total_ = total;
  advance(done);
}

void Console::end(const std::string& note) {
  if (!open_) return;
  open_ = false;
  phases_.push_back({name_, now() - started_, peak_(), note});
  draw(true);
}

void Console::draw(bool last) {
  if (quiet_) return;
  if (last) {
    fmt::print(stderr, "{}{}\n", terminal_ ? "\r\033[K" : "", line(phases_.back()));
    return;
  }
  const double time = now();
  if (!terminal_ || time - drawn_ < 0.1) return;
  drawn_ = time;
  if (total_ <= 0) {
    fmt::print(stderr, "\r\033[K{:<{}} …", name_, name_width);
  } else {
    constexpr int width = 24;
    const double part = std::clamp(static_cast<double>(done_) / static_cast<double>(total_), 0.0, 1.0);
    const int filled = static_cast<int>(part * width);
    const std::string left = part > 0 ? duration_of((time - started_) * (1 - part) / part) + " left" : "";
    fmt::print(stderr, "\r\033[K{:<{}} [{}{}] {:3.0f} %  {}", name_, name_width,
               std::string(static_cast<std::size_t>(filled), '#'),
               std::string(static_cast<std::size_t>(width - filled), '.'), 100 * part, left);
  }
  std::fflush(stderr);
}

void Console::say(const std::string& line) {
  if (quiet_) return;
  fmt::print("{}\n", line);
  std::fflush(stdout);  // a log shows each line when it is said
}

void Console::warn(const std::string& line) {
  if (!watch_) fmt::print(stderr, "warning: {}\n", line);
}

std::string Console::line(const Phase& phase) {
  return fmt::format("{:<{}} {:>10} {:>8.0f} MiB{}{}", phase.name, name_width, duration_of(phase.seconds),
                     phase.peak_mib, phase.note.empty() ? "" : "  ", phase.note);
}

void Console::total() {
  if (phases_.empty() || quiet_) return;
  Phase all{"total", 0, 0, ""};
  for (const Phase& phase : phases_) {
    all.seconds += phase.seconds;
    all.peak_mib = std::max(all.peak_mib, phase.peak_mib);
  }
  fmt::print(stderr, "{}\n", line(all));
}

}  // namespace ricochet::console
