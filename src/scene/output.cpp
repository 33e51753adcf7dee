// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/output.hpp"

#include <algorithm>

#include "src/scene/loads.hpp"
#include "src/scene/near_miss.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::scene {

namespace {

bool has_direction(const Gauge& gauge) { return gauge.direction.has_value(); }

}  // namespace

const SectionOf<Output> output_keys{
    "[output]",
    "",
    {{"every", &Output::every, "samples", initial, from_to("1", "1e9"),
      "interval between rows of the result, in output samples; between rows of the contact, in contact "
      "steps; for receivers see `receivers_rate_hz`"},
     {"view", &Output::view, "", initial, any(),
      "keep each body's visualisation surface in its kernel, for pictures: the modes and, with "
      "`residual_flexibility`, the static response to each candidate. Each of them takes 12 bytes for each "
      "node; above 64 MiB, only the corners of elements are kept"},
     {"stress", Access(&Output::stress).if_changed(), "", initial, any(),
      "keep the [stress of each body's visualisation surface](results.md#stress-and-strain) in its kernel, "
      "and "
      "the largest of the whole run in the result. In kernels, each mode and static response takes 24 bytes "
      "more "
      "for each node. Sets `view`; not with `kernel = \"table\"`"},
     {"snapshot_every", &Output::snapshot_every, "samples", initial, at_least("0"),
      "interval between snapshots of the modal coordinates; 0: none"},
     {"vtk_every", &Output::vtk_every, "samples", initial, at_least("0"),
      "interval between frames of the [motion for ParaView](results.md#motion-in-paraview); 0: none. Sets "
      "`view`; not with `kernel = \"table\"`"},
     {"receivers_rate_hz", &Output::receivers_rate, "Hz",
      "rate_hz; with `every` above 1 at least " + std::to_string(static_cast<int>(audio_rows.value)),
      above("0"),
      "rows of receivers and gauges per second, rounded up so that rate_hz is a whole multiple, and at least "
      "rate_hz "
      "/ " +
          std::to_string(most_samples_per_receiver_row) +
          ". Below rate_hz, a low-pass filter removes what the rows cannot represent. Sound files do not "
          "depend on it"},
     {"sound", Type::table, "", none, any(),
      "`[output.sound]`, one or two receivers as a sound file for players",
      "{ receivers = \"mic\", direction = [0, 0, 1] }"},
     {"receiver", Type::tables, "", none, any(), "`[[output.receiver]]`, points whose motion is recorded"},
     {"gauge", Type::tables, "", none, any(), "`[[output.gauge]]`, points whose stress is recorded"}}};

const SectionOf<Receiver> receiver_keys{
    "[[output.receiver]]",
    "A point of a body whose motion is recorded and written as sound.",
    {{"name", &Receiver::name, "", required("it names the receiver's histories"), any(),
      "a name that no other receiver has; at most 100 bytes, no `/`, and not `body_force`, "
      "`body_force_residual` or `rotation`"},
     body_key<Receiver>(),
     at_key<Receiver>("the point"),
     at_body_key<Receiver>(),
     {"axes", choice<Receiver>(&Receiver::axes, {"world", "body"}).if_changed(), "", initial, any(),
      "components of the motion: along the axes of the world, or along those of the body's mesh, which turn "
      "with the body"}}};

const SectionOf<Gauge> gauge_keys{
    "[[output.gauge]]",
    "A point of a body whose stress is recorded, and a strain gauge if it has a direction.",
    {{"name", &Gauge::name, "", required("it names the gauge's histories"), any(),
      "a name that no other gauge has; as of a receiver"},
     body_key<Gauge>(),
     at_key<Gauge>("the point"),
     at_body_key<Gauge>(),
     {"direction", direction<Gauge>(&Gauge::direction), "", none, any(),
      "direction of the strain that is recorded beside the stress, in the axes of the key that gives the "
      "point"},
     {"length", Access(&Gauge::length).if_changed().only(has_direction, "a gauge with a direction"), "m",
      initial, at_least("0"),
      "length of the gauge: its strain is the mean over this length along `direction`, with the point in the "
      "middle; 0: the strain at the point. Places off a curved surface by at most 5 % of the length count at "
      "the "
      "nearest point of the body"}}};

const SectionOf<Sound> sound_keys{
    "[output.sound]",
    "A sound file for players, `<slug>.wav`, besides the files of the receivers: mono or stereo, normalised "
    "to its largest sample.",
    {{"receivers", &Sound::receivers, "", required("name one receiver (mono) or two (left and right)"), any(),
      "name of a receiver (mono), or a list of two (left and right)"},
     {"direction", direction<Sound>(&Sound::direction), "",
      required("the component that is heard, for example the normal of the wall"), any(),
      "component of the velocity that is heard, in the `axes` of the receivers, for example the normal of "
      "the "
      "wall"},
     {"high_pass_hz", &Sound::high_pass_hz, "Hz", initial, from_to("0", "1000"),
      "corner of a high-pass filter (Butterworth, fourth order), which removes rigid motion; 0: none. It "
      "must be below half of `time.rate_hz`"},
     {"fade", &Sound::fade, "s", initial, at_least("0"),
      "duration of the fade at the end (raised cosine); 0: none"},
     {"format", choice<Sound>(&Sound::format, {sample_format_names.begin(), sample_format_names.end()}), "",
      initial, any(),
      "samples: integers of 16 or 24 bits, or floats of 32 bits. The header is the plain one that all "
      "players read"}}};

namespace {

/// Reads [[output.KIND]]: receivers or gauges.
template <class S>
std::vector<S> read_points(const Table& output, const char* kind, const SectionOf<S>& keys,
                           const Scene& scene) {
  std::vector<S> points;
  for (const Table& entry : output.array(kind, keys)) {
    S point;
    keys.read(entry, point);
    check_place(entry, "the point of the body");
    check_name(entry, "name", point.name);
    if (point.name == "time") entry.complain("name", "is that of the times in the result: choose another");
    check_exists(entry, "body", "body", point.body, names_of(scene.bodies));
    if (std::ranges::count(points, point.name, &S::name) > 0)
      entry.complain("name", fmt::format("another {} has this name: give each its own", kind));
    points.push_back(point);
  }
  return points;
}

/// Reads [output.sound], a sound of these receivers.
std::optional<Sound> read_sound(const Table& output, const std::vector<Receiver>& receivers) {
  const auto table = output.table("sound", sound_keys);
  if (!table) return std::nullopt;
  Sound sound;
  sound_keys.read(*table, sound);
  if (sound.receivers.size() > 2) table->complain("receivers", "must name one receiver or two");
  for (const std::string& name : sound.receivers)
    check_exists(*table, "receivers", "receiver", name, names_of(receivers));
  return sound;
}

}  // namespace

void read_output(const Table& root, Scene& scene) {
  Output& output = scene.output;
  const auto table = root.table("output", output_keys);
  if (!table) return;
  output_keys.read(*table, output);
  if (output.vtk_every > 0 && table->has("view") && !output.view)
    table->complain("view", "vtk_every needs the visualisation surfaces: leave view out, or set it to true");
  if (output.stress && table->has("view") && !output.view)
    table->complain("view", "stress needs the visualisation surfaces: leave view out, or set it to true");
  output.view = output.view || output.vtk_every > 0 || output.stress;
  const double samples = output.receivers_rate ? scene.time.rate_hz / output.receivers_rate->value : 1;
  if (scene.time.duration > 0 && !(samples >= 1 && samples <= most_samples_per_receiver_row))
    table->complain("receivers_rate_hz", fmt::format("must be from rate_hz / {} to rate_hz = {:g}",
                                                     most_samples_per_receiver_row, scene.time.rate_hz));
  output.receivers = read_points(*table, "receiver", receiver_keys, scene);
  output.gauges = read_points(*table, "gauge", gauge_keys, scene);
  output.sound = read_sound(*table, output.receivers);
  if (output.receivers_rate && output.receivers.empty() && output.gauges.empty())
    table->complain("receivers_rate_hz",
                    "needs [[output.receiver]] or [[output.gauge]]: add one, or leave it out");
}

}  // namespace ricochet::scene
