// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/fclib.hpp"

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

/// Row in the file of each row of the model, and of the two rows of each point without friction.
struct FileRows {
  std::vector<Eigen::Index> place;  ///< (n)
  std::vector<Eigen::Index> loose;  ///< the first of two, for each point without friction

  explicit FileRows(const Model& model) : place(static_cast<std::size_t>(model.rows())) {
    std::vector<bool> rubs(static_cast<std::size_t>(model.points()));
    for (const Model::FrictionPoint& point : model.friction) {
      rubs[point.point] = true;
      for (int along : {0, 1}) place[point.tangential + along] = rows_each * point.point + 1 + along;
    }
    for (Eigen::Index i = 0; i < model.points(); ++i) {
      place[i] = rows_each * i;
      if (!rubs[i]) loose.push_back(rows_each * i + 1);
    }
  }
};

/// Writes W in compressed rows.
/// @param points  m
void write_matrix(Writer& file, const Eigen::MatrixXd& S, const FileRows& rows, Eigen::Index points) {
  const double tangential = S.diagonal().head(points).mean();
  // Rows and columns of the file in ascending order, with those of S or −1
  std::vector<Eigen::Index> source(static_cast<std::size_t>(rows_each * points), -1);
  for (std::size_t k = 0; k < rows.place.size(); ++k) source[rows.place[k]] = static_cast<Eigen::Index>(k);
  std::vector<std::int64_t> start{0}, column;
  std::vector<double> value;
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (source[i] < 0) {
      column.push_back(static_cast<std::int64_t>(i));
      value.push_back(tangential);
    } else {
      for (std::size_t j = 0; j < source.size(); ++j) {
        if (source[j] < 0) continue;
        column.push_back(static_cast<std::int64_t>(j));
        value.push_back(S(source[i], source[j]));
      }
    }
    start.push_back(std::ssize(column));
  }
  constexpr std::int64_t compressed_rows = -2;
  const std::string group = "/fclib_local/W/";
  write_integer(file, group + "nzmax", std::ssize(value));
  write_integer(file, group + "m", rows_each * points);
  write_integer(file, group + "n", rows_each * points);
  write_integer(file, group + "nz", compressed_rows);
  file.write(group + "p", start, {start.size()}, "");
  file.write(group + "i", column, {column.size()}, "");
  file.write(group + "x", value, {value.size()}, "m/N");
}

void write_vector(Writer& file, const std::string& name, const Vector& x, const FileRows& rows,
                  const std::string& unit) {
  std::vector<double> values(rows.place.size() + 2 * rows.loose.size(), 0.0);
  for (std::size_t k = 0; k < rows.place.size(); ++k) values[rows.place[k]] = x(static_cast<Eigen::Index>(k));
  file.write(name, values, {values.size()}, unit);
}

}  // namespace

ProblemFiles::ProblemFiles(const Model& model, const StepOptions& step, ProblemOptions options)
    : model_(model),
      options_(std::move(options)),
      system_(make_step_system(borrowed(model), step)),
      matrices_(*system_),
      slip_(std::ssize(model.friction), model.rows(), step.step),
      displacement_(model.initial_displacement()),
      force_(Vector::Zero(model.rows())) {
  std::error_code failure;
  std::filesystem::create_directories(options_.folder, failure);
  if (failure)
    throw InputError(fmt::format("{}: cannot create this folder ({}): choose another with --fclib",
                                 options_.folder.string(), failure.message()));
}

void ProblemFiles::observe(const Stepper& stepper) {
  if (stepper.active() > 0 && !(stepper.residual().scale > 0) && seen_++ % options_.every == 0) {
    write(stepper);
  }
  if (model_.friction.empty()) return;
  slip_ = stepper.slip();
  displacement_ = stepper.displacement();
  force_ = stepper.end_force();
}

ProblemFiles::Problem ProblemFiles::problem_of(const Stepper& stepper) const {
  const Eigen::Index m = model_.points();
  Problem out{.S = matrices_.S,
              .u = -stepper.displacement(),
              .q = {},
              .p = stepper.end_force(),
              .mu = Vector::Zero(m)};
  // M and R do not couple islands, whose weights differ.
  for (Eigen::Index j = 0; j < out.S.cols(); ++j)
    if (stepper.weights(j) != backward_euler) out.S.col(j) = matrices_.S_mean.col(j);
  out.u.head(m) += model_.gap;
  for (std::size_t k = 0; k < system_->springs.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (const PatchSpring& spring = system_->springs[k]; spring.bulge > 0 && out.p(i) > 0)
      out.S(i, i) += spring.slope(out.p(i));
  }
  if (!model_.friction.empty()) {
    out.u.tail(out.u.size() - m) += displacement_.tail(out.u.size() - m);
    const double end = stepper.time(), begin = end - stepper.options().step;
    for (const Model::Belt& belt : model_.belts)
      out.u += (belt.history.at(end) - belt.history.at(begin)) * belt.slide;
  }
  out.q = out.u - out.S * out.p;
  for (std::size_t f = 0; f < model_.friction.size(); ++f) {
    const auto& [point, row, law] = model_.friction[f];
    out.mu(point) =
        slip_.coefficient(law, static_cast<Eigen::Index>(f), force_(point) > 0, out.q.segment<2>(row).norm());
  }
  return out;
}

void ProblemFiles::remove() {
  for (const std::filesystem::path& file : written_) std::filesystem::remove(file);
  written_.clear();
}

void ProblemFiles::write(const Stepper& stepper) {
  const Problem problem = problem_of(stepper);
  const Eigen::Index m = model_.points();
  const bool rubs = !model_.friction.empty();
  const FileRows rows(model_);
  const auto& path = written_.emplace_back(
      options_.folder / fmt::format("{}-i{:08}-{}.hdf5", options_.name, stepper.steps(), m));
  Writer file(path);
  write_integer(file, "/fclib_local/spacedim", rows_each);
  write_matrix(file, problem.S, rows, m);
  write_vector(file, "/fclib_local/vectors/q", problem.q, rows, "m");
  file.write("/fclib_local/vectors/mu", std::vector<double>(problem.mu.begin(), problem.mu.end()),
             {static_cast<std::size_t>(m)}, "1");
  write_text(file, "/fclib_local/info/title", options_.title);
  write_text(file, "/fclib_local/info/description",
             fmt::format("{} of elastic bodies, step {} (t = {:.9g} s) of {} contact points. "
                         "W: displacement by the forces at the end of the step [m/N]; r: these forces "
                         "[N]; u: gaps at its end{} [m].",
                         rubs ? "Impact with friction" : "Frictionless impact", stepper.steps(),
                         stepper.time(), m, rubs ? ", and minus the slip in the step" : ""));
  write_text(file, "/fclib_local/info/math_info",
             rubs ? "W is symmetric positive semidefinite, definite with residual flexibility. mu = 0 and "
                    "uncoupled tangential rows at points without friction."
                  : "Normal rows: a linear complementarity problem whose matrix is symmetric positive "
                    "semidefinite, definite with residual flexibility. Tangential rows: uncoupled, mu = 0.");
  write_integer(file, "/guesses/number_of_guesses", 1);
  for (const char* answer : {"/solution", "/guesses/1"}) {
    write_vector(file, std::string(answer) + "/u", problem.u, rows, "m");
    write_vector(file, std::string(answer) + "/r", problem.p, rows, "N");
  }
  file.commit();
}

}  // namespace ricochet::contact
