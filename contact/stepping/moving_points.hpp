// SPDX-License-Identifier: BSD-2-Clause
// The contact points of bodies that turn: where they are, and the matrices of the rows that may touch in a
// step.
//
// A point is a row of a pair with all that may touch there: a candidate of a body over a half-space or over
// the surface of another body, a summit of a curved surface over a half-space, or a crease of a that crosses
// one of b. An obstacle with a surface is a body b without candidates, which nothing moves. It keeps its
// number, so that forces, slip and banks follow it while it moves. A search finds what the points meet (Foot,
// crossing) and the summits; in between they are followed from element to element.
//
// A point has an end on each of its bodies: candidates with weights, and the arm r of one common place from
// the centre of the body. In the step from t_k, with the frame (c, A) of a body, its elastic displacement w =
// Φq at an end, a unit vector e of a row in world axes and e' = Aᵀe,
//
//   U = g − (gap at t_k) in normal rows
//   d = Σ_ends ± [ e·(Δv + ½Δ²g) + e'·(θ × r + Φ Δq) ],   θ = Δ J⁻¹π
//   M = Σ_ends e'ᵀ[ ½Δ² (1/m − r̂ J⁻¹ r̂) + Φ c Φᵀ ] e',   R = Σ_ends e'ᵀ R_body e'   between two points
//
// with the sign + on body a. A summit is where a curved surface faces a half-space or another body. It moves
// between candidates, under which R ripples: its own R is that of MovingCandidates::Patch. Candidates near a
// summit touch only when the surface is pressed by as much as it falls away over one spacing. A contact that
// is smaller than this so has one point, which moves smoothly.
// U + d is û of contact/law. The blocks Φ c Φᵀ and R_body between candidates are
// constant in body axes: they are gathered once, when a candidate joins those under points that may touch.
// Between points, only sums of M and R are formed; R is multiplied by forces between candidates.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "contact/complementarity/reserved_matrix.hpp"
#include "contact/law/contact_law.hpp"
#include "contact/motion/turning.hpp"
#include "contact/simd/dense.hpp"
#include "contact/stepping/moving_candidates.hpp"
#include "contact/stepping/moving_point.hpp"

namespace ricochet::contact {

class MovingPoints : public RowFlexibility {
 public:
  /// Allocates all memory. Bodies with the same kernel share their surface, also with those of `earlier`, if
  /// given. Throws InputError if a kernel does not allow bodies that turn.
  MovingPoints(const Model& model, const StepSystem& system, const MovingPoints* earlier = nullptr);

  /// Takes the points that a model has in common with an earlier one. Nothing is watched until the next
  /// search.
  void take(const MovingPoints& earlier, const Correspondence& from);
  /// Watches the points of a body no longer, and forgets what they met.
  void forget(int body) noexcept;

  /// Moves obstacles to where they are at a time.
  void move_obstacles(double time) noexcept;
  /// Moves them to where they are in the middle of a step, for `advance`.
  void drive_obstacles(double from, double to) noexcept;
  /// Whether an obstacle moves at any time within an interval.
  bool obstacles_move(double from, double to) const noexcept;
  /// Sets how far obstacles may move within an interval, for `watch`.
  void set_obstacle_travels(double from, double to) noexcept;
  /// Largest speed within it of the obstacle of a pair [m/s].
  double obstacle_speed(std::size_t pair, double from, double to) const noexcept;

  /// What a body may do in a time.
  struct Travel {
    double energy = 0;    ///< of its elastic modes and of R, at most [J]
    double distance = 0;  ///< of a point with its frame [m]
    void archive(auto& a) { a(energy, distance); }
  };
  /// Whether the bodies of a pair may reach each other, whatever their shapes.
  bool may_meet(const Model::PairBlock& pair, std::span<const FloatingBody> bodies,
                std::span<const Travel> travels) const noexcept {
    return are_there(pair, bodies) && apart(pair, bodies) < margin(pair, travels);
  }
  /// Whether a body of a pair moves, and none has been taken out.
  static bool is_live(const Model::PairBlock& pair, std::span<const FloatingBody> bodies) noexcept {
    return are_there(pair, bodies) && (bodies[static_cast<std::size_t>(pair.a)].moves() ||
                                       (pair.b >= 0 && bodies[static_cast<std::size_t>(pair.b)].moves()));
  }
  /// Whether no body of a pair has been taken out.
  static bool are_there(const Model::PairBlock& pair, std::span<const FloatingBody> bodies) noexcept {
    return bodies[static_cast<std::size_t>(pair.a)].present &&
           (pair.b < 0 || bodies[static_cast<std::size_t>(pair.b)].present);
  }
  /// Smallest distance that a pair has left, whatever the phase of the modes of its bodies [m]; ∞ without
  /// points. @param energy  by body, of the elastic modes and of R, at most [J]
  double clearance(const Model::PairBlock& pair, std::span<const FloatingBody> bodies,
                   std::span<const Travel> energies) const noexcept;
  /// Largest distance of a point from the centre of the body [m].
  double radius(int body) const { return bodies_[static_cast<std::size_t>(body)].radius; }
  MovingCandidates& candidates(int k) { return body(k).candidates; }

  /// Begins an epoch: finds the points that may touch in it, and watches them and those with a force.
  /// @param travels  by body
  void watch(std::span<const FloatingBody> bodies, std::span<const Travel> travels,
             const MeanForce& forces) noexcept;

  /// A body asleep with a point that is watched, so that it may be touched; −1: none.
  int reached(std::span<const FloatingBody> bodies) const noexcept;

  /// Watches no point until the next search, because nothing can touch in a flight.
  void watch_none() noexcept;
  /// Whether `expect` saves time.
  bool should_expect() const noexcept {
    return std::ranges::any_of(bodies_, [](const Body& one) { return one.candidates.fills_cache(); });
  }
  /// Expects the free elastic motion of the next step, so that `place` computes both. @param dq  (N)
  void expect(const Vector& dq) noexcept {
    for (Body& one : bodies_) one.candidates.expect(dq);
  }
  /// Computes U of the watched points, and where they are. @param q  (N)
  void place(std::span<const FloatingBody> bodies, const Vector& q) noexcept;
  /// In the middle of a step: displacements d of the watched points. Chooses the points that may touch.
  /// Returns false if they have more rows than a step may hold.
  /// @param dq  (N) of the free elastic motion
  bool advance(std::span<const FloatingBody> bodies, const Vector& dq, double step,
               const MeanForce& forces) noexcept;

  std::span<const int> rows() const { return members_.rows; }  ///< those of points that may touch
  /// By position among these rows
  const Vector& at_start() const { return start_; }  ///< U [m]; 0 in tangential rows of points that slide
  const Vector& free() const { return free_; }       ///< U + d [m]
  const Vector& driven() const { return driven_; }   ///< displacement of obstacles in the step [m]
  double u(int row) const { return u_(row); }        ///< U of a row of the model [m]; likewise
  /// Writes U of all points (n). Those that are not watched are taken without their elastic displacement, or
  /// where they were; their tangential rows keep their values.
  void write_displacements(std::span<const FloatingBody> bodies, Vector& u) const noexcept;
  int pair_of(std::size_t position) const { return member_at(position).pair; }
  /// Whether the point moves along its bodies, so that its tangential displacements are sums over steps.
  bool slides(std::size_t position) const { return member_at(position).kind != Kind::half_space; }
  /// Whether the point is a summit that has come from another element. To be asked once in a step.
  bool has_jumped(std::size_t position) noexcept;
  /// The spring of the point in this step; no value for a tangential row.
  std::optional<PatchSpring> spring(std::size_t position) const noexcept;
  /// The flexibilities of a step. @param a  weight of the end in the mean; 1: of backward Euler throughout
  StepMatrices matrices(std::span<const FloatingBody> bodies, double step, double a) noexcept;
  void yield(std::span<const int> at, const Vector& p, Vector& y) noexcept override;
  Symmetric S() noexcept override;

  /// The forces and torques on a body, in its axes, and the forces on its modes, under p by position.
  struct Load {
    Eigen::Vector3d force{0, 0, 0}, torque{0, 0, 0};
    double on_static = 0;  ///< work over the static displacements in the step [J]
  };
  /// @param modal  (N) is added to
  Load load(int body, const Vector& p, Vector& modal) noexcept;

  /// Writes where the watched points are, and the directions of their rows: of those that might touch in the
  /// last step, in its middle, along which the forces acted; they may have passed to another face or crease
  /// since.
  void write_frames(std::span<const FloatingBody> bodies, RowFrames& out) const noexcept;
  /// Writes the forces on candidates under p by position. Those on bodies asleep stay.
  /// @param out  by body (3M), 0 but for the last call's
  void write_forces(const Vector& p, std::span<const FloatingBody> bodies, std::vector<Vector>& out) noexcept;

  /// Without what is computed anew in each step.
  void archive(auto& a) {
    for (Body& one : bodies_) a(one.candidates);
    a(points_, far_, travelled_, watched_, is_watched_, members_, start_);
    a(free_, u_, near_, forced_);
  }

 private:
  using Point = MovingPoint;
  using Kind = Point::Kind;
  using End = Point::End;
  /// An obstacle with a surface.
  struct Solid {
    std::shared_ptr<const Obstacle> obstacle;
    std::shared_ptr<const BodySurface> surface;  ///< in its axes
    FloatingBody state;
    std::shared_ptr<const DrivenMotion> motion{};  ///< null if it does not move
    Pose start{}, from{}, to{};                    ///< at t = 0; at the ends of the step
    double radius = 0;                             ///< of the surface about the origin [m]

    void move_to(const Pose& pose) noexcept;
    /// Displacement in the step of what is at a place in the middle of it, world axes [m].
    Eigen::Vector3d moved(const Eigen::Vector3d& place) const noexcept;
  };
  /// The obstacle of a pair, if it moves.
  struct Drive {
    double raise = 0;     ///< of a half-space along the normal out of a, since t = 0 [m]
    double rises = 0;     ///< the same, in the step [m]
    double farthest = 0;  ///< displacement of any of its points in the step, at most [m]
    double travel = 0;    ///< until the next search, at most [m]
  };
  struct Body {
    Body(const Bodies::Block& block, std::shared_ptr<const BodySurface> surface, const Model& model,
         const StepSystem& system);
    const kernels::Kernel* kernel;
    std::shared_ptr<const BodySurface> surface;
    const BodySurface& shape() const { return *surface; }
    Eigen::Vector3d centre;  ///< body axes [m]
    double radius = 0;       ///< of the surface about the centre [m]
    double least_area = 0;   ///< of its patches [m²]
    MovingCandidates candidates;
    /// Free displacements in the step, of the frame and beside it, at most [m].
    double fastest = 0, elastic_fastest = 0;
    FloatingBody::FreeMotion free{};
    std::vector<char> used;                       ///< (M) scratch
    std::size_t first_lever = 0, last_lever = 0;  ///< of its ends in this step
    double shift = 0;                             ///< of the frame in the step, under a unit force [m/N]
    Eigen::Matrix3d turn;                         ///< under a unit moment [1/(N m)]
    std::size_t pulls = 0;                        ///< of its levers in a product
  };

  const Point& member_at(std::size_t position) const {
    return points_[static_cast<std::size_t>(
        members_.points[static_cast<std::size_t>(members_.of_row[position])])];
  }
  /// Of a row of a member among the rows.
  Eigen::Index position(std::size_t member, int along) const {
    return static_cast<Eigen::Index>(members_.first_row[member] + along);
  }
  Body& body(int k) { return bodies_[static_cast<std::size_t>(k)]; }
  const Body& body(int k) const { return bodies_[static_cast<std::size_t>(k)]; }
  double smallest_element(const Point& point) const noexcept;
  double rise_of(const Model::PairBlock& pair) const noexcept;
  Side side(int k, std::span<const FloatingBody> bodies) const {
    return {body(k).shape(), body(k).centre, bodies[static_cast<std::size_t>(k)]};
  }
  Side side(const End& end, std::span<const FloatingBody> bodies) const {
    if (end.body >= 0) return side(end.body, bodies);
    const Solid& solid = solids_[static_cast<std::size_t>(end.solid)];
    return {*solid.surface, Eigen::Vector3d::Zero(), solid.state};
  }
  /// Of the second body of a pair, or of an obstacle with a surface.
  Side side_of_b(const Model::PairBlock& pair, std::span<const FloatingBody> bodies) const {
    return side(End{.body = pair.b, .solid = solid_of(pair)}, bodies);
  }
  const BodySurface& shape_of_b(const Model::PairBlock& pair) const {
    return pair.b < 0 ? *solids_[static_cast<std::size_t>(solid_of(pair))].surface : body(pair.b).shape();
  }
  /// Of mass, or the origin of an obstacle, own axes [m].
  Eigen::Vector3d centre_of(const End& end) const {
    return end.body < 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : body(end.body).centre;
  }
  /// Number of the obstacle of a pair, if it has a surface; otherwise −1.
  int solid_of(const Model::PairBlock& pair) const noexcept;
  std::shared_ptr<const BodySurface> known_surface(const kernels::Kernel* kernel) const;
  void add_solids(const MovingPoints* earlier);
  void add_points(const Model& model, int pair);
  /// Distance of a point from its half-space, without its elastic displacement [m].
  double height(const Point& point, const FloatingBody& state) const noexcept {
    return point.height(state) + drives_[static_cast<std::size_t>(point.pair)].raise;
  }
  double apart(const Model::PairBlock& pair, std::span<const FloatingBody> bodies) const noexcept;
  double inside(const Model::PairBlock& pair, std::span<const FloatingBody> bodies) const noexcept;
  double above(const Model::PairBlock& pair, const FloatingBody& state) const noexcept;
  double gap_along(const Model::PairBlock& pair, std::span<const FloatingBody> bodies,
                   const Eigen::Vector3d& n) const noexcept;
  double swing_of(const Model::PairBlock& pair, std::span<const Travel> travels) const noexcept;
  double margin(const Model::PairBlock& pair, std::span<const Travel> travels) const noexcept;
  /// Of the obstacle of a pair, also if the pair is that of the model.
  const Drive& drive_of(const Model::PairBlock& pair) const noexcept {
    return drives_[static_cast<std::size_t>(points_[static_cast<std::size_t>(pair.first_point)].pair)];
  }
  double swing_of(const Point& point, std::span<const Travel> travels) const noexcept;
  void find_feet(int pair, std::span<const FloatingBody> bodies, double margin,
                 const MeanForce& forces) noexcept;
  void list_summits(int pair, std::span<const FloatingBody> bodies, double margin) noexcept;
  void find_summits(int pair, std::span<const FloatingBody> bodies, double margin,
                    const MeanForce& forces) noexcept;
  void list_near(int summit, std::span<const FloatingBody> bodies, double near) noexcept;
  double square_way(const Point& candidate, const Point& summit) const noexcept;
  void follow_summit(Point& point, std::span<const FloatingBody> bodies) const noexcept;
  void stand_back() noexcept;
  void find_crossings(int pair, std::span<const FloatingBody> bodies, double margin,
                      const MeanForce& forces) noexcept;
  /// Under an end on a body.
  MovingCandidates::Patch patch(const Point& point, const End& end) const noexcept;
  Eigen::Vector3d elastic(const End& end, const Vector& q) noexcept;
  void place(int number, std::span<const FloatingBody> bodies, const Vector* q) noexcept;
  Eigen::Matrix3d in_world(const Point& point, std::span<const FloatingBody> bodies) const noexcept;
  Eigen::Vector3d normal_in_world(const Point& point, std::span<const FloatingBody> bodies) const noexcept;
  bool has_force(int number, const MeanForce& forces) const noexcept {
    return forces.end()(number) != 0 || forces.before()(number) != 0;
  }
  void watch(int number) noexcept;
  void unwatch() noexcept;
  bool is_nearest(const Point& point) const noexcept;
  void drop_members() noexcept;
  void add_members(const MeanForce& forces) noexcept;
  void join_candidates() noexcept;
  void set_rows(std::span<const FloatingBody> bodies, const Vector& dq) noexcept;
  bool repeats(const Point& point) const noexcept;
  double deepest_start(const Point& point, double approach) const noexcept;
  bool list_rows() noexcept;
  void list_levers() noexcept;
  void compare_patches() noexcept;
  void fill(double a, ReservedMatrix& S) noexcept;
  Eigen::Vector3d force_on(const End& end, std::size_t member, const Vector& p) const noexcept;

  /// Points that may touch, and their rows.
  struct Members {
    std::vector<int> points;        ///< their numbers
    std::vector<int> of_point;      ///< (m) position among members, or −1
    std::vector<int> rows, of_row;  ///< row and member by position
    std::vector<int> first_row;     ///< position of the normal row of each member; tangents follow
    void archive(auto& a) { a(points, of_point, rows, of_row, first_row); }
  };
  /// The levers of a member on its bodies; a body is −1 where it has none.
  struct Levers {
    std::array<int, 2> body{-1, -1};
    std::array<std::size_t, 2> at{};
    Eigen::Index rows = 0;
    bool is_summit = false;
  };
  /// What `matrices` makes of the members of a step.
  struct Flexibility {
    std::vector<simd::Lever> levers;      ///< of members, by body
    std::vector<std::size_t> lowest;      ///< likewise: the first place of an end and those after it
    std::vector<simd::Pull> pulls;        ///< scratch, as levers
    std::vector<Levers> of_member;        ///< by member
    std::vector<Eigen::Matrix3d> excess;  ///< by member, of summits: R of their patches beyond W R Wᵀ
    base::AlignedVector<double> displaced, columns;  ///< (7,C) of candidates; (n,4) of rows: scratch
    ReservedMatrix S, whole;                         ///< a M + R; M + R of a step with a < 1
    bool has_whole = false;
  };

  std::vector<Model::PairBlock> pairs_;
  std::vector<Body> bodies_;
  std::vector<Solid> solids_;
  std::vector<Drive> drives_;  ///< by pair
  std::vector<Point> points_;
  std::vector<std::array<std::vector<int>, 2>> point_of_;  ///< by pair, body and candidate, or −1
  std::vector<double> far_;  ///< by pair, distance of bodies that could not meet at the last search, or −1
  std::vector<double> travelled_;  ///< by pair, at most since the distances of its points are known [m]
  std::vector<int> watched_;
  std::vector<char> is_watched_;  ///< (m)
  Members members_;
  Vector start_, free_, driven_, u_;
  struct Crossing {
    int of_a, of_b;
    double distance;
  };
  std::vector<Crossing> crossings_;              ///< scratch
  static constexpr std::size_t most_found = 16;  ///< summits at a time
  std::vector<Foot> tops_;                       ///< scratch
  std::vector<Point> summits_;                   ///< scratch
  /// Candidates near the summits that are watched, which stand back.
  struct Near {
    int candidate, summit;  ///< numbers of points
    void archive(auto& a) { a(candidate, summit); }
  };
  std::vector<Near> near_;                  ///< by summit
  std::vector<std::array<int, 2>> forced_;  ///< body and candidate with a force in write_forces
  Flexibility flexibility_;
};

}  // namespace ricochet::contact
