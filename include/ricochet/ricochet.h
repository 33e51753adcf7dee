/* SPDX-License-Identifier: BSD-2-Clause */
/* Impacts of elastic bodies from their kernels, for C and for languages that call C. The interface is that of
 * ricochet.hpp, which documents units and rules in full.
 *
 *   ricochet_kernel* kernel = ricochet_kernel_load("bar.kernel.h5");
 *   ricochet_scene* scene = ricochet_scene_new(44100);
 *   ricochet_scene_body(scene, "bar", kernel, NULL, NULL, down);
 *   ricochet_scene_half_space(scene, "floor", origin, up);
 *   ricochet_scene_pair(scene, "bar", "floor", NULL, &gap, NULL);
 *   ricochet_scene_pickup(scene, "bar", NULL, 0, up);
 *   ricochet_simulation* simulation = ricochet_simulation_new(scene);
 *   ricochet_simulation_step_block(simulation, 512, &block);
 *
 * A function that refuses its input returns NULL or RICOCHET_REFUSED; ricochet_error() then states in one
 * line where the problem is, what was found and what to do. Vectors are three doubles in SI units and world
 * axes. rotate_deg, translate, velocity, direction, gap, reach and receiver may be NULL if not given. Handles
 * of simulations are not checked. Objects may be freed in any order, because a simulation keeps the parts of
 * its scene and kernels that it needs. */
#ifndef RICOCHET_H
#define RICOCHET_H

#include <stddef.h>
#include <stdint.h>

#define RICOCHET_VERSION_MAJOR 0
#define RICOCHET_VERSION_MINOR 1
#define RICOCHET_VERSION_PATCH 0
#define RICOCHET_VERSION_NUMBER \
  (RICOCHET_VERSION_MAJOR * 10000 + RICOCHET_VERSION_MINOR * 100 + RICOCHET_VERSION_PATCH)

#ifdef __cplusplus
extern "C" {
#endif

enum {
  RICOCHET_OK = 0,
  RICOCHET_NO_SOLUTION = 1, /* no contact forces keep the bodies apart */
  RICOCHET_NOT_FINITE = 2,  /* the motion is no longer finite */
  RICOCHET_REFUSED = 3,     /* see ricochet_error() */
  RICOCHET_CROWDED = 4      /* RICOCHET_FINITE: more points may touch at once than a step can hold */
};
enum { RICOCHET_JUMP = 0, RICOCHET_DIFFERENCE = 1 }; /* admittance of the impulse scheme */
enum { RICOCHET_LINEAR = 0, RICOCHET_FINITE = 1 };   /* rotation of free bodies: small, or by any angle */
enum { RICOCHET_WORLD = 0, RICOCHET_BODY = 1 };      /* axes in which a load is constant */

typedef struct ricochet_kernel ricochet_kernel;
typedef struct ricochet_scene ricochet_scene;
typedef struct ricochet_simulation ricochet_simulation;
typedef struct ricochet_state ricochet_state;

/* Version of the library at run time; RICOCHET_VERSION_NUMBER is that of the header at compile time. */
int ricochet_version(void);

/* Message of the last call that failed on this thread; "" before the first. Valid until the next failure. */
const char* ricochet_error(void);

/* Kernels. Load from one thread at a time; a loaded kernel is constant. */
ricochet_kernel* ricochet_kernel_load(const char* path);
void ricochet_kernel_free(ricochet_kernel* kernel);
double ricochet_kernel_mass(const ricochet_kernel* kernel);         /* [kg] */
size_t ricochet_kernel_modes(const ricochet_kernel* kernel);        /* N */
size_t ricochet_kernel_candidates(const ricochet_kernel* kernel);   /* M */
const double* ricochet_kernel_nodes(const ricochet_kernel* kernel); /* (M,3) [m], the body's frame */

/* Scenes: scheme "compliant" and no gravity unless set otherwise. */
ricochet_scene* ricochet_scene_new(double rate_hz);
void ricochet_scene_free(ricochet_scene* scene);
int ricochet_scene_body(ricochet_scene* scene, const char* name, const ricochet_kernel* kernel,
                        const double* rotate_deg, const double* translate, const double* velocity);
/* Initial angular velocity about the centre of mass, world axes [rad/s]; of a body that the scene has. */
int ricochet_scene_angular_velocity(ricochet_scene* scene, const char* body, const double* angular_velocity);
int ricochet_scene_half_space(ricochet_scene* scene, const char* name, const double* point,
                              const double* normal);
/* An obstacle of another shape around a point, with its axis along z before it is rotated: "sphere", "cylinder",
 * "capsule", "cone", "torus" with the sizes radius, radius_small, length, of which those that the shape does not
 * have are not read; or "box" with its edges along x, y, z [m]. inside: not 0 if bodies are inside. */
int ricochet_scene_obstacle(ricochet_scene* scene, const char* name, const char* shape, int inside,
                            const double* point, const double* rotate_deg, const double* sizes);
/* A closed surface from an STL or OBJ file, whose coordinates times scale are metres. */
int ricochet_scene_obstacle_mesh(ricochet_scene* scene, const char* name, const char* path, double scale,
                                 int inside, const double* point, const double* rotate_deg);
/* direction: a vector; gap, reach: one number [m]. */
int ricochet_scene_pair(ricochet_scene* scene, const char* a, const char* b, const double* direction,
                        const double* gap, const double* reach);
/* Coulomb friction of the pair that was added last: its coefficients at rest and in fast sliding, and the
 * sliding speed of the transition [m/s], which equal coefficients do not need. For scheme "compliant" only. */
int ricochet_scene_friction(ricochet_scene* scene, double static_coefficient, double dynamic_coefficient,
                            double stribeck_velocity);
/* Sets an obstacle of the scene in motion [m/s], [rad/s about its point]; half-spaces do not turn. */
int ricochet_scene_obstacle_velocity(ricochet_scene* scene, const char* obstacle, const double* velocity,
                                     const double* angular_velocity);
/* Adds a motion: a displacement [m] and a turn about its point (axis times angle [degrees]), times a factor that
 * is linear between `count` times [s]. */
int ricochet_scene_obstacle_motion(ricochet_scene* scene, const char* obstacle, const double* shift,
                                   const double* turn_deg, const double* time, const double* factor,
                                   size_t count);
/* A receiver of the kernel by name, or, if that is NULL, a candidate by its number. */
int ricochet_scene_pickup(ricochet_scene* scene, const char* body, const char* receiver, size_t candidate,
                          const double* direction);
int ricochet_scene_gravity(ricochet_scene* scene, const double* gravity);
/* A load of the kernel [Pa] or [N], or a support [m], by name: a vector times a factor, linear between `count`
 * times [s]. Without times, a load has always acted. */
int ricochet_scene_load(ricochet_scene* scene, const char* body, const char* load, const double* vector,
                        const double* time, const double* factor, size_t count);
/* The same for a load of the kernel that presses against the outward normal [Pa]. */
int ricochet_scene_pressure(ricochet_scene* scene, const char* body, const char* load, double pressure,
                            const double* time, const double* factor, size_t count);
/* The axes in which the vector of the load that was added last is constant while its body turns, with
 * RICOCHET_FINITE. Default: of the body for [Pa], of the world for [N]. */
int ricochet_scene_load_axes(ricochet_scene* scene, int axes);
int ricochet_scene_support(ricochet_scene* scene, const char* body, const char* support, const double* vector,
                           const double* time, const double* factor, size_t count);
/* Default: RICOCHET_LINEAR. */
int ricochet_scene_rotation(ricochet_scene* scene, int rotation);
/* The time at which a body of the scene is at its place with its velocity [s]; until then, it falls freely. */
int ricochet_scene_arrival(ricochet_scene* scene, const char* body, double arrival);
int ricochet_scene_impulse(ricochet_scene* scene, int admittance, double restitution);
/* Scheme "impulse": from event to event within a step. */
int ricochet_scene_exact_events(ricochet_scene* scene);

/* Simulations: use each from one thread at a time. Below, only ricochet_simulation_new, _add, _remove and _save, and
 * ricochet_state_bytes and _read allocate. */
typedef struct ricochet_block { /* each may be NULL */
  double* velocity;             /* (n,p) of the pickups [m/s] */
  double* total_force;          /* (n) [N] */
  double* force;                /* (n,m) [N] */
  double* displacement;         /* (n,m) [m] */
  double* tangential_force;     /* (n,m,3) of friction on body b [N] */
} ricochet_block;

typedef struct ricochet_energy { /* [J] */
  double kinetic, strain, residual, loads, damping, contact, friction;
  double added; /* part of loads: what bodies that were added brought, less what removed ones took away */
} ricochet_energy;

typedef struct ricochet_point {
  size_t pair; /* in the order of the calls of ricochet_scene_pair; (size_t)-1 for a body that was added */
  double a[3], b[3], normal[3]; /* points that face each other [m]; unit normal out of a */
  double gap, area;             /* initial [m]; of the patch of a [m^2] */
} ricochet_point;

typedef struct ricochet_motion { /* of a body as a whole, world axes */
  double position[3];            /* of its centre of mass [m] */
  double attitude[4];            /* unit quaternion w, x, y, z, from the axes of the kernel */
  double velocity[3], spin[3];   /* of that centre [m/s]; [rad/s] */
} ricochet_motion;

typedef struct ricochet_contact { /* a point with a force in the last step */
  size_t pair, point;             /* pair as above */
  const char *a, *b;              /* names of bodies, or of one and a half-space; valid until one is added or removed */
  double place[3], normal[3];     /* on body a, now [m]; unit, out of a. Linear rotations: at the start */
  double force[3];                /* on body b or the half-space, with friction: mean over the step [N] */
} ricochet_contact;

ricochet_simulation* ricochet_simulation_new(const ricochet_scene* scene);
void ricochet_simulation_free(ricochet_simulation* simulation);

/* Return RICOCHET_OK, RICOCHET_NO_SOLUTION, RICOCHET_NOT_FINITE or RICOCHET_CROWDED. A failed step changes nothing; rows of the
 * block from that step on are 0. block may be NULL. */
int ricochet_simulation_step(ricochet_simulation* simulation);
int ricochet_simulation_step_block(ricochet_simulation* simulation, int64_t steps,
                                   const ricochet_block* block);

int64_t ricochet_simulation_steps(const ricochet_simulation* simulation);
double ricochet_simulation_time(const ricochet_simulation* simulation);    /* [s] */
size_t ricochet_simulation_points(const ricochet_simulation* simulation);  /* m */
size_t ricochet_simulation_pickups(const ricochet_simulation* simulation); /* p */
int ricochet_simulation_active(const ricochet_simulation* simulation);     /* points with a force */
/* (m), of the last step; valid until the next step. */
const double* ricochet_simulation_force(const ricochet_simulation* simulation);        /* [N] */
const double* ricochet_simulation_displacement(const ricochet_simulation* simulation); /* [m] */
/* (m,3) of friction on body b [N]; 0 for points without friction. */
const double* ricochet_simulation_tangential_force(const ricochet_simulation* simulation);
/* point < m and pickup < p are not checked. body: in the order of the calls of ricochet_scene_body, or what
 * ricochet_simulation_add has returned; it stays that of its body. Of a body that was removed, motions are NaN. */
void ricochet_simulation_point(const ricochet_simulation* simulation, size_t point, ricochet_point* out);
double ricochet_simulation_pickup_velocity(const ricochet_simulation* simulation, size_t pickup);
double ricochet_simulation_pickup_displacement(const ricochet_simulation* simulation, size_t pickup);
void ricochet_simulation_mean_velocity(const ricochet_simulation* simulation, size_t body, double out[3]);
void ricochet_simulation_motion(const ricochet_simulation* simulation, size_t body, ricochet_motion* out);
/* Writes the points that touch, at most `count` of them. Returns how many there are. */
size_t ricochet_simulation_contacts(ricochet_simulation* simulation, ricochet_contact* out, size_t count);
/* Sets a force [N] and a torque about the centre of mass [N m] from outside, world axes, which act on a body
 * until they are set again; NULL: none. Returns RICOCHET_REFUSED unless rotations are finite and the body is there. */
int ricochet_simulation_push(ricochet_simulation* simulation, size_t body, const double* force,
                             const double* torque);

/* Sets a force [N] from outside at a point of a body, world axes, which acts from the next step on until it is set
 * again at this point; NULL: none. The point is a receiver of the kernel or, if that is NULL, the contact candidate.
 * Returns RICOCHET_REFUSED if the body or the point is not there, or if the kernel does not hold its motion along the
 * force, or if forces act at 1024 other points. */
int ricochet_simulation_push_at(ricochet_simulation* simulation, size_t body, const char* receiver,
                                size_t candidate, const double* force);

/* With RICOCHET_FINITE: adds a body, which may meet every other body and every half-space, and writes its number to
 * `body`, unless that is NULL. friction: NULL, or the three numbers of ricochet_scene_friction. Refused if the name
 * is taken or if the body would overlap another one. m may change. A body with the kernel of one that was removed
 * takes its place, which is fast. */
int ricochet_simulation_add(ricochet_simulation* simulation, const char* name, const ricochet_kernel* kernel,
                            const ricochet_motion* motion, const double* friction, size_t* body);
/* Removes a body, with its contacts. The numbers of the others stay. */
int ricochet_simulation_remove(ricochet_simulation* simulation, size_t body);
/* Writes the number of the body with this name. */
int ricochet_simulation_find(const ricochet_simulation* simulation, const char* name, size_t* body);
/* Writes the numbers of the bodies that are there, at most `count` of them. Returns how many there are. */
size_t ricochet_simulation_bodies(const ricochet_simulation* simulation, size_t* out, size_t count);
void ricochet_simulation_energy(const ricochet_simulation* simulation, ricochet_energy* out);

ricochet_state* ricochet_simulation_save(const ricochet_simulation* simulation);
/* Returns RICOCHET_REFUSED for a state of another system: if the kernels, the scene, or the bodies that were added and
 * removed differ. Allocates if another simulation, of an equal system, saved the state. */
int ricochet_simulation_restore(ricochet_simulation* simulation, const ricochet_state* state);
/* A state as bytes, for this version of the library and this kind of processor. Writes them if there are at most
 * `count`. Returns how many there are, or 0 if there is no memory. */
size_t ricochet_state_bytes(const ricochet_state* state, void* out, size_t count);
/* The state that these bytes hold, for a simulation of an equal system, perhaps in another process. NULL if they are
 * damaged, or of another system or version. */
ricochet_state* ricochet_state_read(const ricochet_simulation* simulation, const void* bytes, size_t count);
void ricochet_state_free(ricochet_state* state);

#ifdef __cplusplus
}
#endif

#endif
