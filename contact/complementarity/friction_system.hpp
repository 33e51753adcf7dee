// SPDX-License-Identifier: BSD-2-Clause
// The problem of friction_solver.hpp for the points that touch, as a dense system of few rows. A point has
// one row, or three with friction; its state is open, stick, or slip along a direction t.
//
// Newton's method solves for x, where D are the columns of the unknowns that the states leave, and
// E the rows,
//
//   Eᵀ (A (p + D x) − r) + C x = 0
//
//   stick   D = E = 1
//   slip    D = (n − μ t, t⊥),   E = (n, t⊥),   C = (0, |w_t| / (μ p_n))
//
// Here t⊥ is normal to t. C is due to w_t, which must turn with p_t.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <vector>

#include "contact/complementarity/bordered_factor.hpp"
#include "contact/complementarity/complementarity.hpp"
#include "contact/complementarity/friction_point.hpp"

namespace ricochet::contact {

/// t turned by a right angle.
inline Eigen::Vector2d across(const Eigen::Vector2d& t) { return {-t.y(), t.x()}; }

/// Only the constructor allocates.
class FrictionSystem {
 public:
  struct Touch {
    int row = 0;             ///< first row
    double coefficient = 0;  ///< μ; 0 for a point of one row
    ContactState state = ContactState::open;
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();  ///< t of slip
    double slip = 0;                                      ///< |w_t| of slip
    int rows() const { return coefficient > 0 ? 3 : 1; }
    void archive(auto& a) { a(row, coefficient, state, direction, slip); }
  };

  explicit FrictionSystem(int capacity);

  /// Removes all points and the factor.
  void clear() noexcept;
  /// Appends an open point. Its entries of A, r and p are undefined.
  void add(double coefficient) noexcept;
  int points() const { return count_; }
  int rows() const { return rows_; }
  Touch& operator[](int k) { return touch_[k]; }
  const Touch& operator[](int k) const { return touch_[k]; }

  /// (m,m) of its own, to be filled.
  ReservedMatrix::View A() noexcept {
    A_.others = nullptr;
    return A_.own.begin(rows_);
  }
  /// Uses a matrix (m,m) of others until the next call of this function or of A.
  void use(const double* matrix, Eigen::Index stride) noexcept {
    A_.own.begin(0);
    A_.others = matrix;
    A_.stride_of_others = stride;
  }
  double* p() { return p_.data(); }  ///< (m)
  double* r() { return r_.data(); }  ///< (m)
  const double* p() const { return p_.data(); }
  const double* w() const { return w_.data(); }  ///< (m) A p − r
  /// (m) A p of the forces that were multiplied last.
  const double* product() const { return product_.Ap.data(); }
  /// Whether p (m) are these forces to round-off.
  bool has_product(const double* p) const noexcept;
  /// To be called after A has changed.
  void set_matrix() noexcept;

  /// Sets the state of point k from its force, and from the state and the slip |w_t| of the problem before.
  void guess_state(int k, ContactState before, double slip) noexcept;

  /// Solves the system from the given p and states. `limited`: p is an iterate, in the cone.
  /// @param largest_r, largest_normal_r  |r|_∞ of the whole problem, over all rows and over normal rows
  /// @param left  in and out: iterations left
  SolveStatus solve(double largest_r, double largest_normal_r, int& left,
                    SolveStatistics& statistics) noexcept;
  /// Whether the solution is regular and the determinant of Newton's matrix is negative there.
  bool has_negative_determinant() noexcept;
  /// Looks for another solution near the present one. If it returns true, p, w and the states are those of
  /// the other one.
  bool find_another(SolveStatistics& statistics) noexcept;

  double tolerance() const { return sizes_.tolerance; }          ///< of w
  double normal_tolerance() const { return sizes_.of_normals; }  ///< of w in normal rows
  double scale() const;  ///< |r|_∞ + ‖A‖_∞ |p|_∞ of the last p

  void archive(auto& a) {
    a(count_, rows_, touch_, best_, answer_, held_, entries_, kept_, changed_, has_factor_, factor_, steps_);
    a(exact_, A_, p_, w_, r_, product_, cautious_, contradicted_, sizes_);
  }

 private:
  void evaluate() noexcept;
  void set_tolerances() noexcept;
  double contradiction(int k) const noexcept;
  void change_state(int k) noexcept;
  bool classify() noexcept;
  bool project(int k) noexcept;
  double violation() const noexcept;
  bool keep_best(double error) noexcept;
  void restore_best() noexcept;
  void discard_factor() noexcept;
  const Eigen::Vector2d& direction_in_factor(int k) const noexcept;
  enum class Columns { D, E };
  void compress(const double* column, Columns of, double* out) const noexcept;
  double turning(const Touch& touch) const noexcept;
  void renew_factor() noexcept;
  bool holds_states() const noexcept;
  void append_unknown(int k, const Eigen::Vector3d& move, const Eigen::Vector3d& equation,
                      double turning) noexcept;
  void append_multiplier(int k, const Eigen::Vector3d& free, const Eigen::Vector3d& condition,
                         double compliance) noexcept;
  bool update_factor() noexcept;
  bool is_slow(double error, double before, double goal) const noexcept;
  bool find_step() noexcept;
  bool make_step() noexcept;
  SolveStatus try_newton(int& left, SolveStatistics& statistics, double target = 0) noexcept;
  void keep_answer() noexcept;
  void restore_answer() noexcept;
  double admitted(int k, int d) const noexcept;
  SolveStatus follow_load(int& left, SolveStatistics& statistics) noexcept;
  void set_ridge(double ridge) noexcept;
  SolveStatus follow_paths(int& left, SolveStatistics& statistics) noexcept;
  void sweep() noexcept;
  FrictionPoint local(int k) const noexcept;
  void set(int k, const FrictionPoint::Solution& solution) noexcept;
  double entry(int row) const { return A_.column(row)[row]; }
  double tangential_entry(int row) const { return std::max(entry(row + 1), entry(row + 2)); }

  /// A, its own or of others.
  struct Matrix {
    ReservedMatrix own;
    const double* others = nullptr;  ///< set anew in each solve
    Eigen::Index stride_of_others = 0;
    const double* column(int row) const {
      return others != nullptr ? others + row * stride_of_others : own.column(row);
    }
    Eigen::Index stride() const { return others != nullptr ? stride_of_others : own.stride(); }
    void archive(auto& a) { a(own); }
  };
  /// The forces that were multiplied last.
  struct Product {
    std::vector<double> p, Ap;
    int rows = 0;  ///< 0 if A has changed since
    void archive(auto& a) { a(p, Ap, rows); }
  };
  /// What factor and border hold of a point.
  struct Held {
    ContactState factored = ContactState::open;           ///< state in the factor
    ContactState state = ContactState::open;              ///< state with the border
    int at = 0;                                           ///< first unknown in the factor
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();  ///< t when it was factored
    double turning = 0;                                   ///< entry of C of a slipping point then
    void archive(auto& a) { a(factored, state, at, direction, turning); }
  };
  /// A row and column of the border: of an unknown with its equation, or a multiplier.
  struct Entry {
    int point = 0;
    bool is_unknown = false, turns = false;  ///< turns: an unknown with an entry of C
    Eigen::Vector3d move = Eigen::Vector3d::Zero(), equation = move;  ///< of an unknown
    double sign = 1;  ///< of the determinant without it over that with it
    void archive(auto& a) { a(point, is_unknown, turns, move, equation, sign); }
  };
  /// Points and forces to which the solver may return.
  struct Iterate {
    std::vector<Touch> touch;
    std::vector<double> p;
    double error = 0;
    void archive(auto& a) { a(touch, p, error); }
  };
  /// Steps of Broyden's method since the factor or its border has changed.
  struct Steps {
    static constexpr int most = 12;
    std::vector<double> step;  ///< (most, stride)
    std::array<double, most> squares{};
    std::ptrdiff_t stride = 0;
    int count = 0;
    void archive(auto& a) { a(step, squares, stride, count); }
  };
  /// Sizes of the problem, to which tolerances are relative.
  struct Sizes {
    double norm = 0, diagonal = 0;         ///< ‖A‖_∞, max A_ii
    double r = 0, normal_r = 0;            ///< largest |r|, over all rows and over normal rows
    double tolerance = 0, of_normals = 0;  ///< of w
    void archive(auto& a) { a(norm, diagonal, r, normal_r, tolerance, of_normals); }
  };
  /// The problem without the ridge of a regularised one.
  struct Plain {
    double ridge = 0;
    std::vector<double> A, r, centre;  ///< centre: forces at which the ridge does not act
  };
  static constexpr double proximal =
      1e-13;  ///< share of max A_ii added to the diagonal against singular matrices

  int count_ = 0, rows_ = 0;
  std::vector<Touch> touch_;
  Iterate best_, answer_;
  std::vector<Held> held_;
  std::vector<Entry> entries_;       ///< of the border
  std::vector<int> kept_, changed_;  ///< scratch
  bool has_factor_ = false;
  BorderedFactor factor_;
  Steps steps_;
  bool exact_ = false;  ///< whether each change of state renews the factor
  Matrix A_;
  std::vector<double> p_, w_, r_, x_, column_;
  Product product_;
  Plain plain_;
  bool cautious_ = true;       ///< whether few states change at once
  bool contradicted_ = false;  ///< whether states were left that contradict the forces
  Sizes sizes_;
};

}  // namespace ricochet::contact
