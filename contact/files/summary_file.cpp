// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/summary_file.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/atomic_file.hpp"

namespace ricochet::contact {
namespace {

using Json = nlohmann::ordered_json;

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json text(const std::string& value) { return value.empty() ? Json(nullptr) : Json(value); }

Json shares(const std::optional<ErrorEstimate>& estimate) {
  if (!estimate) return nullptr;
  Json out{{"quantity", name_of(estimate->worst())},
           {"until_s", number(estimate->until_s)},
           {"total", estimate->total()}},
      all = Json::object();
  for (const auto& [cause, errors] : estimate->by_cause) out[name_of(cause)] = number(estimate->share(cause));
  for (const Quantity quantity : estimate->quantities()) {
    Json& of_quantity = all[std::string(name_of(quantity))] = {{"total", estimate->total(quantity)}};
    for (const auto& [cause, errors] : estimate->by_cause)
      of_quantity[name_of(cause)] = errors ? Json(errors->at(quantity)) : Json(nullptr);
  }
  out["quantities"] = std::move(all);
  return out;
}

Json json_of(const Figures& figures) {
  Json out = Json::object();
  for (const auto& [quantity, figure] : figures)
    out[std::string(name_of(quantity))] = {
        {"value", std::vector<double>(figure.value.begin(), figure.value.end())}, {"scale", figure.scale}};
  return out;
}

void write(const Json& json, const std::filesystem::path& path) {
  base::AtomicFile temporary(path);
  std::ofstream file(temporary.path());
  file << json.dump(2) << '\n';
  file.close();
  if (!file) temporary.fail();
  temporary.commit();
}

Json json_of(const Sound& sound) {
  return {{"file", sound.file}, {"full_scale_m_per_s", sound.full_scale_m_per_s}, {"rate_hz", sound.rate_hz}};
}

Json json_of(const AccelerationPeaks& peaks) {
  Json by_class = Json::object();
  for (const auto& [channel_class, peak] : peaks.by_class)
    by_class[std::to_string(channel_class)] = number(peak);
  return {{"peak_m_per_s2", peaks.peak_m_per_s2}, {"time_s", peaks.time_s}, {"cfc_peak_m_per_s2", by_class}};
}

Json json_of(const std::map<std::string, StressPeak>& stress) {
  Json out = Json::object();
  for (const auto& [body, peak] : stress)
    out[body] = {{"von_mises_pa", peak.von_mises_pa},
                 {"at", {peak.at.x(), peak.at.y(), peak.at.z()}},
                 {"gauge", peak.gauge.empty() ? Json() : Json(peak.gauge)},
                 {"time_s", peak.time_s},
                 {"ratio_to_yield", number(peak.ratio_to_yield)}};
  return out;
}

Json json_of(const std::map<std::string, GaugePeaks>& gauges) {
  Json out = Json::object();
  for (const auto& [name, peaks] : gauges)
    out[name] = {{"von_mises_pa", peaks.von_mises_pa},
                 {"von_mises_time_s", peaks.von_mises_time_s},
                 {"strain_peak", number(peaks.strain_peak)},
                 {"strain_time_s", number(peaks.strain_time_s)}};
  return out;
}

Json json_of(const Summary& summary) {
  Json episodes = Json::array(), touches = Json::array(), exit_velocity = Json::object(),
       neglected = Json::object(), acceleration = Json::object(), sounds = Json::object();
  for (const Episode& episode : summary.episodes)
    episodes.push_back({{"start_s", episode.start_s},
                        {"end_s", number(episode.end_s)},
                        {"impulse_ns", episode.impulse_ns},
                        {"peak_force_n", episode.peak_force_n},
                        {"approach_m_per_s", number(episode.approach_m_per_s)},
                        {"restitution", number(episode.restitution)}});
  for (const Touch& touch : summary.touches)
    touches.push_back({{"start_s", touch.start_s},
                       {"end_s", number(touch.end_s)},
                       {"bodies", {touch.a, touch.b}},
                       {"impulse_ns", touch.impulse.norm()}});
  for (const auto& [name, v] : summary.exit_velocity) exit_velocity[name] = {v.x(), v.y(), v.z()};
  for (const auto& [name, sizes] : summary.neglected)
    neglected[name] = {{"centrifugal_strain", number(sizes.centrifugal_strain)},
                       {"frequency_shift", sizes.frequency_shift},
                       {"mode_mixing", sizes.mode_mixing},
                       {"flexibility_compression", sizes.compression}};
  for (const auto& [name, peaks] : summary.acceleration) acceleration[name] = json_of(peaks);
  for (const auto& [name, sound] : summary.sounds) sounds[name] = json_of(sound);
  Json out{{"run", text(summary.run)},
           {"contact_start_s", number(summary.contact_start_s)},
           {"contact_end_s", number(summary.contact_end_s)},
           {"parted_s", number(summary.parted_s)},
           {"duration_s", summary.duration_s},
           {"contact_steps", summary.contact_steps},
           {"episodes", episodes},
           {"touches", touches},
           {"rotation", summary.rotation == Rotation::finite ? "finite" : "linear"},
           {"needs_turning_kernels", summary.needs_turning_kernels},
           {"neglected", neglected},
           {"separation_s", number(summary.separation_s)},
           {"peak_force_n", summary.peak_force_n},
           {"impulse_ns", summary.impulse_ns},
           {"exit_velocity", exit_velocity},
           {"restitution", number(summary.restitution)},
           {"energy_drift", number(summary.energy_drift)},
           {"energy_lost_contact", number(summary.energy_lost_contact)},
           {"energy_above_band", number(summary.energy_above_band)},
           {"rebound_above_band", number(summary.rebound_above_band)},
           {"energy_lost_friction", number(summary.energy_lost_friction)},
           {"friction_impulse_ns", number(summary.friction_impulse_ns)},
           {"max_slip_m", number(summary.max_slip_m)},
           {"ambiguous_steps", summary.ambiguous_steps ? Json(*summary.ambiguous_steps) : Json()},
           {"quantities", json_of(summary.quantities)},
           {"max_penetration_m", summary.max_penetration_m},
           {"limited_steps", summary.limited_steps},
           {"limited_residual", summary.limited_residual},
           {"modes", summary.modes},
           {"basis", summary.basis},
           {"modes_in_residual", summary.modes_in_residual},
           {"precision", summary.precision == Precision::float32 ? "single" : "double"},
           {"candidates", summary.candidates},
           {"unpaired", summary.unpaired},
           {"max_active", summary.max_active},
           {"error_estimate", shares(summary.error_estimate)},
           {"acceleration", acceleration},
           {"stress", json_of(summary.stress)},
           {"gauges", json_of(summary.gauges)},
           {"sounds", sounds},
           {"warnings", summary.warnings},
           {"real_time_factor", summary.real_time_factor},
           {"wall_s", summary.wall_s}};
  if (summary.sound) out["sound"] = json_of(*summary.sound);
  return out;
}

Json json_of(const EquilibriumSummary& summary) {
  Json pairs = Json::array();
  for (const EquilibriumSummary::Pair& pair : summary.pairs)
    pairs.push_back({{"force_n", pair.force_n},
                     {"approach_m", pair.approach_m},
                     {"contact_points", pair.contact_points},
                     {"contact_area_m2", pair.contact_area_m2},
                     {"peak_pressure_pa", pair.peak_pressure_pa},
                     {"friction_n", number(pair.friction_n)},
                     {"sticking_points", pair.sticking_points ? Json(*pair.sticking_points) : Json()},
                     {"slipping_points", pair.slipping_points ? Json(*pair.slipping_points) : Json()}});
  return {
      {"run", text(summary.run)},
      {"pairs", pairs},
      {"stress", json_of(summary.stress)},
      {"gauges", json_of(summary.gauges)},
      {"quantities", json_of(summary.quantities())},
      {"imbalance", summary.imbalance},
      {"max_penetration_m", summary.max_penetration_m},
      {"modes", summary.modes},
      {"candidates", summary.candidates},
      {"unpaired", summary.unpaired},
      {"ambiguous_increments", summary.ambiguous_increments ? Json(*summary.ambiguous_increments) : Json()},
      {"iterations", summary.iterations},
      {"error_estimate", shares(summary.error_estimate)},
      {"warnings", summary.warnings},
      {"wall_s", summary.wall_s}};
}

}  // namespace

std::string json_text(const Summary& summary) { return json_of(summary).dump(); }
void write_json(const Summary& summary, const std::filesystem::path& path) { write(json_of(summary), path); }

std::string json_text(const EquilibriumSummary& summary) { return json_of(summary).dump(); }
void write_json(const EquilibriumSummary& summary, const std::filesystem::path& path) {
  write(json_of(summary), path);
}

}  // namespace ricochet::contact
