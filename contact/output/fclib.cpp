// SPDX-License-Identifier: BSD-2-Clause
#include "contact/output/fclib.hpp"

#include <fmt/format.h>

#include <system_error>
#include <utility>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {

namespace {

using base::hdf5::Writer;

constexpr Eigen::Index rows_each = 3;  ///< of a contact: normal, two tangential

void write_integer(Writer& file, const std::string& name, std::int64_t value) {
  file.write<std::int64_t>(name, std::vector{value}, {1}, "");
}

/// FCLIB reads texts of fixed length that end with a zero.
void write_text(Writer& file, const std::string& name, const std::string& text) {
  file.write_strings(name, {text + '\0'});
}

/// Writes W in compressed rows.
void write_matrix(Writer& file, const Eigen::MatrixXd& S) {
  const Eigen::Index m = S.rows();
  const double tangential = S.diagonal().mean();
  std::vector<std::int64_t> start{0}, column;
  std::vector<double> value;
  for (Eigen::Index i = 0; i < m; ++i) {
    for (Eigen::Index j = 0; j < m; ++j) {
      column.push_back(rows_each * j);
      value.push_back(S(i, j));
    }
    start.push_back(std::ssize(column));
    for (Eigen::Index t = 1; t < rows_each; ++t) {
      column.push_back(rows_each * i + t);
      value.push_back(tangential);
      start.push_back(std::ssize(column));
    }
  }
  constexpr std::int64_t compressed_rows = -2;
  const std::string group = "/fclib_local/W/";
  write_integer(file, group + "nzmax", std::ssize(value));
  write_integer(file, group + "m", rows_each * m);
  write_integer(file, group + "n", rows_each * m);
  write_integer(file, group + "nz", compressed_rows);
  file.write(group + "p", start, {start.size()}, "");
  file.write(group + "i", column, {column.size()}, "");
  file.write(group + "x", value, {value.size()}, "m/N");
}

void write_normal(Writer& file, const std::string& name, const Vector& normal, const std::string& unit) {
  std::vector<double> values(rows_each * normal.size(), 0.0);
  for (Eigen::Index i = 0; i < normal.size(); ++i) values[rows_each * i] = normal[i];
  file.write(name, values, {values.size()}, unit);
}

}  // namespace

ProblemFiles::ProblemFiles(const Model& model, const StepOptions& step, ProblemOptions options)
    : model_(model), options_(std::move(options)), system_(make_step_system(model, step)) {
  std::error_code failure;
  std::filesystem::create_directories(options_.folder, failure);
  if (failure)
    throw InputError(fmt::format("{}: cannot create this folder ({}): choose another with --fclib",
                                 options_.folder.string(), failure.message()));
}

void ProblemFiles::observe(const Stepper& stepper) {
  if (stepper.active() == 0 || stepper.residual().scale > 0) return;
  if (seen_++ % options_.every != 0) return;
  write(stepper);
  ++written_;
}

void ProblemFiles::write(const Stepper& stepper) const {
  const Vector& force = stepper.end_force();
  const Eigen::MatrixXd& S = stepper.weights() == backward_euler ? system_->S : system_->S_mean;
  const Vector gap = model_.gap - stepper.displacement();
  const Vector q = gap - S * force;
  const Eigen::Index m = force.size();
  Writer file(options_.folder / fmt::format("{}-i{:08}-{}.hdf5", options_.name, stepper.steps(), m));
  write_integer(file, "/fclib_local/spacedim", rows_each);
  write_matrix(file, S);
  write_normal(file, "/fclib_local/vectors/q", q, "m");
  file.write("/fclib_local/vectors/mu", std::vector<double>(m, 0.0), {static_cast<std::size_t>(m)}, "1");
  write_text(file, "/fclib_local/info/title", options_.title);
  write_text(
      file, "/fclib_local/info/description",
      fmt::format("Frictionless impact of elastic bodies, step {} (t = {:.9g} s) of {} contact points. "
                  "W: normal displacement by the forces at the end of the step [m/N]; r: these forces "
                  "[N]; u: gaps [m] at its end.",
                  stepper.steps(), stepper.time(), m));
  write_text(file, "/fclib_local/info/math_info",
             "Normal rows: a linear complementarity problem whose matrix is symmetric positive semidefinite, "
             "definite with residual flexibility. Tangential rows: uncoupled, mu = 0.");
  write_integer(file, "/guesses/number_of_guesses", 1);
  for (const char* answer : {"/solution", "/guesses/1"}) {
    write_normal(file, std::string(answer) + "/u", gap, "m");
    write_normal(file, std::string(answer) + "/r", force, "N");
  }
  file.commit();
}

}  // namespace ricochet::contact
