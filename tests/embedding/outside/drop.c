/* SPDX-License-Identifier: BSD-2-Clause */
/* Drops the bob of drop.cpp through the C header and compares with Galilei's law; pushes, turns, drops,
   removes and adds its ball. */
#include <ricochet/ricochet.h>

#if defined(EIGEN_WORLD_VERSION) || defined(MPI_VERSION) || defined(H5_VERS_MAJOR)
#error "ricochet.h brings in a library that its users did not ask for"
#endif

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

static void expect(int holds, const char* what) {
  if (holds) return;
  fprintf(stderr, "not so: %s (last error: %s)\n", what, ricochet_error());
  ++failures;
}

static int near(double x, double y, double tolerance) { return fabs(x - y) <= tolerance; }

static void refusals(const ricochet_kernel* kernel) {
  const double zero[3] = {0, 0, 0};
  expect(ricochet_kernel_load("nowhere.h5") == NULL, "a missing file is refused");
  expect(strstr(ricochet_error(), "nowhere.h5") != NULL, "the refusal names the file");
  expect(ricochet_kernel_load(NULL) == NULL, "a missing path is refused");
  expect(ricochet_scene_body(NULL, "bob", kernel, NULL, NULL, NULL) == RICOCHET_REFUSED,
         "no scene is refused");
  ricochet_scene* scene = ricochet_scene_new(1000);
  expect(ricochet_scene_body(scene, "bob", NULL, NULL, NULL, NULL) == RICOCHET_REFUSED,
         "no kernel is refused");
  expect(ricochet_scene_half_space(scene, "floor", zero, NULL) == RICOCHET_REFUSED, "no normal is refused");
  expect(ricochet_scene_angular_velocity(scene, "bob", zero) == RICOCHET_REFUSED,
         "the spin of an unknown body is refused");
  expect(ricochet_scene_impulse(scene, 7, 0) == RICOCHET_REFUSED, "an unknown admittance is refused");
  expect(ricochet_scene_friction(scene, 0.3, 0.3, 0) == RICOCHET_REFUSED,
         "friction without a pair is refused");
  expect(ricochet_scene_obstacle_velocity(scene, "floor", zero, NULL) == RICOCHET_REFUSED,
         "the velocity of an unknown obstacle is refused");
  expect(ricochet_scene_obstacle_motion(scene, "floor", zero, NULL, zero, zero, 1) == RICOCHET_REFUSED,
         "the motion of an unknown obstacle is refused");
  expect(ricochet_scene_load(scene, "bob", "push", zero, NULL, NULL, 0) == RICOCHET_REFUSED,
         "the load of an unknown body is refused");
  expect(ricochet_scene_arrival(scene, "bob", 1) == RICOCHET_REFUSED,
         "the arrival of an unknown body is refused");
  expect(ricochet_scene_half_space(scene, "floor", zero, zero) == RICOCHET_OK,
         "a scene is checked when it is run");
  expect(ricochet_simulation_new(scene) == NULL, "a normal of length 0 is refused");
  expect(strstr(ricochet_error(), "obstacles.floor.normal") != NULL, "the refusal names it");
  ricochet_scene_free(scene);
}

static ricochet_simulation* drop(const ricochet_kernel* kernel) {
  const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1}, down[3] = {0, 0, -1}, gravity[3] = {0, 0, -9.81};
  const double gap = 1, along[3] = {1, 0, 0}, second[2] = {0, 1};
  ricochet_simulation* simulation;
  ricochet_scene* scene = ricochet_scene_new(1000);
  expect(ricochet_scene_body(scene, "bob", kernel, NULL, NULL, NULL) == RICOCHET_OK, "body");
  expect(ricochet_scene_angular_velocity(scene, "bob", origin) == RICOCHET_OK, "angular velocity");
  expect(ricochet_scene_half_space(scene, "floor", origin, up) == RICOCHET_OK, "half-space");
  expect(ricochet_scene_pair(scene, "bob", "floor", NULL, &gap, NULL) == RICOCHET_OK, "pair");
  expect(ricochet_scene_friction(scene, 0, 0, 0) == RICOCHET_OK, "no friction");
  expect(ricochet_scene_obstacle_velocity(scene, "floor", along, NULL) == RICOCHET_OK,
         "velocity of the floor");
  expect(ricochet_scene_obstacle_motion(scene, "floor", along, NULL, NULL, NULL, 1) == RICOCHET_REFUSED,
         "no times");
  expect(ricochet_scene_obstacle_motion(scene, "floor", along, NULL, second, second, 2) == RICOCHET_OK,
         "motion of the floor");
  expect(ricochet_scene_pickup(scene, "bob", NULL, 0, down) == RICOCHET_OK, "pickup");
  expect(ricochet_scene_gravity(scene, gravity) == RICOCHET_OK, "gravity");
  expect(ricochet_scene_arrival(scene, "bob", 0) == RICOCHET_OK, "arrival");
  expect(ricochet_scene_support(scene, "bob", "foot", along, NULL, NULL, 1) == RICOCHET_REFUSED,
         "a support without times");
  simulation = ricochet_simulation_new(scene);
  ricochet_scene_free(scene);
  return simulation;
}

/* A ball that spins about x falls on a floor, under a force along its own y, which turns with it. */
static void turn(const ricochet_kernel* kernel) {
  const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1}, high[3] = {0, 0, 10}, spin[3] = {20, 0, 0};
  const double along[3] = {0, 3, 0}, zero = 0, one = 1;
  ricochet_motion motion;
  ricochet_contact contact;
  ricochet_simulation* simulation;
  ricochet_scene* scene = ricochet_scene_new(1000);
  int k;
  expect(ricochet_scene_rotation(scene, 7) == RICOCHET_REFUSED, "an unknown rotation is refused");
  expect(ricochet_scene_load_axes(scene, RICOCHET_BODY) == RICOCHET_REFUSED,
         "axes without a load are refused");
  ricochet_scene_body(scene, "ball", kernel, NULL, high, NULL);
  ricochet_scene_angular_velocity(scene, "ball", spin);
  ricochet_scene_half_space(scene, "floor", origin, up);
  ricochet_scene_pair(scene, "ball", "floor", NULL, NULL, NULL);
  simulation = ricochet_simulation_new(scene);
  expect(ricochet_simulation_push(simulation, 0, along, NULL) == RICOCHET_REFUSED, "linear: no push");
  expect(strstr(ricochet_error(), "RICOCHET_FINITE") != NULL, "the refusal names the remedy");
  ricochet_simulation_free(simulation);
  expect(ricochet_scene_rotation(scene, RICOCHET_FINITE) == RICOCHET_OK, "rotation");
  ricochet_scene_load(scene, "ball", "push", along, &zero, &one, 1);
  expect(ricochet_scene_load_axes(scene, 7) == RICOCHET_REFUSED, "unknown axes are refused");
  expect(ricochet_scene_load_axes(scene, RICOCHET_BODY) == RICOCHET_OK, "axes");
  simulation = ricochet_simulation_new(scene);
  ricochet_scene_pressure(scene, "ball", "push", 1, NULL, NULL, 0);
  expect(ricochet_simulation_new(scene) == NULL, "a pressure is not taken for a force");
  expect(strstr(ricochet_error(), "give vector in place of pressure") != NULL,
         "the refusal names the remedy");
  ricochet_scene_free(scene);
  if (simulation == NULL) {
    expect(0, "a ball that turns is stepped");
    return;
  }
  for (k = 0; k < 100; ++k) expect(ricochet_simulation_step(simulation) == RICOCHET_OK, "it turns");
  ricochet_simulation_motion(simulation, 0, &motion);
  /* 20 rad/s for 0.1 s; of the angle, a step loses (0.02 rad)^2/12 */
  expect(near(motion.attitude[0], cos(1), 1e-4) && near(motion.attitude[1], sin(1), 1e-4), "attitude");
  expect(near(motion.spin[0], 20, 1e-12) && near(motion.spin[2], 0, 1e-12), "spin");
  expect(near(motion.velocity[1], 3.0 / 2 / 20 * sin(2), 1e-4), "v_y = F/(m w) sin w t");
  expect(near(motion.velocity[2], 3.0 / 2 / 20 * (1 - cos(2)), 1e-4), "v_z = F/(m w) (1 - cos w t)");
  /* Against its spin, as long as it takes to stop it: J w = 0.008 kg m^2 x 20 rad/s */
  {
    const double back[3] = {-1.6, 0, 0}, weight[3] = {0, 0, -19.62};
    expect(ricochet_simulation_push(simulation, 0, weight, back) == RICOCHET_OK, "push");
    for (k = 0; k < 100; ++k) ricochet_simulation_step(simulation);
    ricochet_simulation_motion(simulation, 0, &motion);
    expect(near(motion.spin[0], 0, 1e-10), "a torque stops the spin");
    expect(ricochet_simulation_push(simulation, 0, weight, NULL) == RICOCHET_OK, "the torque ends");
    expect(ricochet_simulation_contacts(simulation, &contact, 1) == 0, "nothing touches in the air");
  }
  for (k = 0; k < 5000 && ricochet_simulation_contacts(simulation, NULL, 0) == 0; ++k)
    expect(ricochet_simulation_step(simulation) == RICOCHET_OK, "it falls");
  expect(ricochet_simulation_contacts(simulation, &contact, 1) == 1, "it lands on its point");
  expect(contact.pair == 0 && contact.point == 0, "which is the only one");
  expect(near(contact.normal[2], -1, 1e-12) && contact.force[2] < 0, "it presses on the floor");
  ricochet_simulation_motion(simulation, 0, &motion);
  expect(near(contact.place[2], 0, 5e-2) && near(contact.place[0], motion.position[0], 0.1), "where it is");
  ricochet_simulation_free(simulation);
}

/* A box that rises at 1 m/s hits the ball of 2 kg, which is a point, from below: it leaves with 2 m/s. Other
 * obstacles are there. */
static void hit(const ricochet_kernel* kernel) {
  const double under[3] = {0, 0, -0.5}, edges[3] = {4, 4, 1}, rise[3] = {0, 0, 1}, high[3] = {0, 0, 1};
  const double far[3] = {9, 0, 0}, sizes[3] = {0.2, 0.1, 0.3}, turn[3] = {0, 0, 30}, spin[3] = {0, 0, 1};
  const double times[2] = {0, 1}, factors[2] = {0, 0.01}, gap = 0.01;
  ricochet_motion motion;
  ricochet_simulation* simulation;
  ricochet_scene* scene = ricochet_scene_new(10000);
  ricochet_scene_body(scene, "ball", kernel, NULL, high, NULL);
  expect(ricochet_scene_obstacle(scene, "table", "cube", 0, under, NULL, edges) == RICOCHET_REFUSED,
         "an unknown shape is refused");
  expect(strstr(ricochet_error(), "none of sphere, cylinder") != NULL,
         "and the refusal names those that are");
  expect(ricochet_scene_obstacle(scene, "table", "box", 0, under, NULL, NULL) == RICOCHET_REFUSED,
         "no sizes are refused");
  expect(ricochet_scene_obstacle(scene, "table", "box", 0, under, NULL, edges) == RICOCHET_OK, "box");
  expect(ricochet_scene_obstacle_mesh(scene, "anvil", "nowhere.stl", 1, 0, under, NULL) == RICOCHET_REFUSED,
         "a missing surface is refused");
  expect(strstr(ricochet_error(), "nowhere.stl") != NULL, "and the refusal names it");
  expect(ricochet_scene_obstacle(scene, "ring", "torus", 0, far, turn, sizes) == RICOCHET_OK, "torus");
  expect(ricochet_scene_obstacle_velocity(scene, "table", rise, NULL) == RICOCHET_OK, "it rises");
  expect(ricochet_scene_obstacle_velocity(scene, "ring", NULL, spin) == RICOCHET_OK, "it turns");
  expect(ricochet_scene_obstacle_motion(scene, "ring", NULL, turn, times, factors, 2) == RICOCHET_OK,
         "and by a history");
  ricochet_scene_pair(scene, "ball", "table", NULL, &gap, NULL);
  expect(ricochet_simulation_new(scene) == NULL, "turns need finite rotations");
  expect(strstr(ricochet_error(), "obstacles.ring") != NULL, "and the refusal names what turns");
  ricochet_scene_obstacle_velocity(scene, "ring", NULL, NULL);
  simulation = ricochet_simulation_new(scene);
  ricochet_scene_free(scene);
  if (simulation == NULL) {
    expect(0, "a ball over a box is stepped");
    return;
  }
  expect(ricochet_simulation_step_block(simulation, 1000, NULL) == RICOCHET_OK, "it is hit");
  ricochet_simulation_motion(simulation, 0, &motion);
  expect(near(motion.velocity[2], 2, 1e-6), "it leaves with twice the speed of the box");
  ricochet_simulation_free(simulation);
}

/* Removes the ball and adds it again elsewhere. */
static void renew(const ricochet_kernel* kernel) {
  const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1}, gravity[3] = {0, 0, -9.81}, gap = 1;
  ricochet_motion motion = {{5, 0, 2}, {1, 0, 0, 0}, {0, 0, -3}, {0, 0, 7}}, now;
  ricochet_energy energy;
  ricochet_contact contact;
  size_t body = 7, bodies[2] = {7, 7};
  ricochet_scene* scene = ricochet_scene_new(1000);
  expect(ricochet_scene_body(scene, "ball", kernel, NULL, NULL, NULL) == RICOCHET_OK, "ball");
  expect(ricochet_scene_half_space(scene, "floor", origin, up) == RICOCHET_OK, "floor");
  expect(ricochet_scene_pair(scene, "ball", "floor", NULL, &gap, NULL) == RICOCHET_OK, "pair");
  expect(ricochet_scene_gravity(scene, gravity) == RICOCHET_OK, "gravity");
  ricochet_simulation* linear = ricochet_simulation_new(scene);
  expect(ricochet_simulation_remove(linear, 0) == RICOCHET_REFUSED, "linear rotations refuse");
  expect(strstr(ricochet_error(), "finite rotations") != NULL, "and the refusal names the setting");
  ricochet_simulation_free(linear);
  expect(ricochet_scene_rotation(scene, RICOCHET_FINITE) == RICOCHET_OK, "finite rotations");
  ricochet_simulation* simulation = ricochet_simulation_new(scene);
  ricochet_scene_free(scene);
  if (simulation == NULL) {
    expect(0, "simulation");
    return;
  }
  ricochet_state* state = ricochet_simulation_save(simulation);
  expect(ricochet_simulation_add(simulation, "ball", kernel, &motion, NULL, NULL) == RICOCHET_REFUSED,
         "a name that is taken is refused");
  expect(ricochet_simulation_add(simulation, "two", kernel, &motion, NULL, &body) == RICOCHET_REFUSED,
         "two balls without surfaces are refused");
  expect(ricochet_simulation_add(simulation, "two", kernel, NULL, NULL, &body) == RICOCHET_REFUSED,
         "no motion is refused");
  expect(body == 7, "and no number is written");
  expect(ricochet_simulation_step_block(simulation, 100, NULL) == RICOCHET_OK, "it falls");
  expect(ricochet_simulation_remove(simulation, 1) == RICOCHET_REFUSED, "an unknown body is refused");
  expect(ricochet_simulation_remove(simulation, 0) == RICOCHET_OK, "the ball is removed");
  expect(ricochet_simulation_bodies(simulation, bodies, 2) == 0, "nothing is left");
  expect(ricochet_simulation_find(simulation, "ball", &body) == RICOCHET_REFUSED, "its name is free");
  ricochet_simulation_energy(simulation, &energy);
  expect(energy.kinetic == 0, "and so is its energy");
  expect(near(energy.added, -2 * 0.5 * 0.981 * 0.981, 1e-12), "which it has taken away");
  expect(ricochet_simulation_add(simulation, "ball", kernel, &motion, NULL, &body) == RICOCHET_OK,
         "it is back");
  expect(body == 1 && ricochet_simulation_bodies(simulation, bodies, 2) == 1 && bodies[0] == 1,
         "with a new number");
  expect(ricochet_simulation_find(simulation, "ball", &body) == RICOCHET_OK && body == 1, "and its name");
  expect(ricochet_simulation_restore(simulation, state) == RICOCHET_REFUSED,
         "a state of other bodies is refused");
  ricochet_state_free(state);
  ricochet_simulation_motion(simulation, 0, &now);
  expect(isnan(now.position[0]), "the old number has no motion");
  expect(ricochet_simulation_push(simulation, 0, up, NULL) == RICOCHET_REFUSED, "and cannot be pushed");
  expect(ricochet_simulation_step_block(simulation, 100, NULL) == RICOCHET_OK, "it falls");
  ricochet_simulation_motion(simulation, body, &now);
  expect(near(now.position[2], 2 - 0.3 - 0.5 * 9.81 * 0.01, 1e-12) && now.position[0] == 5,
         "from where it was put");
  expect(near(now.velocity[2], -3.981, 1e-12) && near(now.spin[2], 7, 1e-12), "with its velocity and spin");
  for (int k = 0; k < 5000 && ricochet_simulation_contacts(simulation, &contact, 1) == 0; ++k)
    expect(ricochet_simulation_step(simulation) == RICOCHET_OK, "it falls on");
  expect(ricochet_simulation_contacts(simulation, &contact, 1) == 1, "it lands on its point");
  expect(strcmp(contact.a, "ball") == 0 && strcmp(contact.b, "floor") == 0, "of the ball, on the floor");
  ricochet_simulation_free(simulation);
}

/* The state as bytes: the way to another process. Then the bob is pushed upwards with twice its weight. */
static void store(ricochet_simulation* simulation, ricochet_simulation* other, const ricochet_state* state) {
  const double up[3] = {0, 0, 2 * 4 * 9.81};
  ricochet_motion motion;
  double before;
  size_t size = ricochet_state_bytes(state, NULL, 0);
  unsigned char* bytes = malloc(size);
  ricochet_state* read;
  expect(size > 0 && bytes != NULL && ricochet_state_bytes(state, bytes, size) == size, "bytes");
  if (bytes == NULL) return;
  read = ricochet_state_read(other, bytes, size);
  expect(read != NULL && ricochet_simulation_restore(other, read) == RICOCHET_OK, "they are read");
  ricochet_state_free(read);
  expect(ricochet_simulation_restore(simulation, state) == RICOCHET_OK, "both are there");
  ricochet_simulation_step_block(simulation, 100, NULL);
  ricochet_simulation_step_block(other, 100, NULL);
  expect(ricochet_simulation_pickup_displacement(simulation, 0) ==
             ricochet_simulation_pickup_displacement(other, 0),
         "and go on alike");
  bytes[size / 2] ^= 1;
  expect(ricochet_state_read(other, bytes, size) == NULL, "damaged ones are refused");
  expect(strstr(ricochet_error(), "damaged") != NULL, "and the refusal names the damage");
  expect(ricochet_state_read(other, NULL, 0) == NULL, "none is refused");
  free(bytes);

  ricochet_simulation_restore(other, state);
  ricochet_simulation_motion(other, 0, &motion);
  before = motion.velocity[2];
  expect(ricochet_simulation_push_at(other, 0, NULL, 0, up) == RICOCHET_OK, "a force at its point");
  ricochet_simulation_step_block(other, 20, NULL);
  ricochet_simulation_motion(other, 0, &motion);
  expect(near(motion.velocity[2], before + 9.81 * 0.02, 1e-12), "lifts it");
  expect(ricochet_simulation_push_at(other, 0, NULL, 0, NULL) == RICOCHET_OK, "the force ends");
  expect(ricochet_simulation_push_at(other, 0, NULL, 1, up) == RICOCHET_REFUSED, "it has one point");
  expect(ricochet_simulation_push_at(other, 0, "mic", 0, up) == RICOCHET_REFUSED, "and no receiver");
}

int main(int count, char** arguments) {
  double velocity[400], mean[3];
  ricochet_block block = {velocity, NULL, NULL, NULL, NULL};
  ricochet_energy energy;
  ricochet_point point;
  ricochet_kernel* kernel = ricochet_kernel_load(count > 1 ? arguments[1] : NULL);
  if (kernel == NULL) {
    fprintf(stderr, "%s\n", ricochet_error());
    return 1;
  }
  expect(ricochet_version() == RICOCHET_VERSION_NUMBER, "header and library are of one version");
  expect(ricochet_kernel_mass(kernel) == 4 && ricochet_kernel_modes(kernel) == 1, "the kernel is the bob's");
  expect(ricochet_kernel_candidates(kernel) == 1 && ricochet_kernel_nodes(kernel)[2] == 0,
         "it has one point");
  refusals(kernel);
  ricochet_simulation* simulation = drop(kernel);
  ricochet_simulation* other = drop(kernel);
  ricochet_kernel_free(kernel);
  kernel = ricochet_kernel_load(count > 2 ? arguments[2] : NULL);
  expect(kernel != NULL, "the kernel of the ball");
  if (kernel != NULL) turn(kernel);
  if (kernel != NULL) renew(kernel);
  if (kernel != NULL) hit(kernel);
  ricochet_kernel_free(kernel);
  if (simulation == NULL || other == NULL) return 1;

  expect(ricochet_simulation_points(simulation) == 1 && ricochet_simulation_pickups(simulation) == 1,
         "sizes");
  ricochet_simulation_point(simulation, 0, &point);
  expect(point.normal[2] == -1 && near(point.gap, 1, 1e-15) && near(point.a[2], 1, 1e-15),
         "the point is below");
  expect(ricochet_simulation_step_block(simulation, 400, &block) == RICOCHET_OK, "it makes 400 steps");
  expect(ricochet_simulation_steps(simulation) == 400, "it has made 400 steps");
  expect(near(ricochet_simulation_time(simulation), 0.4, 1e-15), "t = 0.4 s");
  expect(near(velocity[399], 9.81 * 0.4, 1e-12), "v = g t");
  expect(velocity[399] == ricochet_simulation_pickup_velocity(simulation, 0), "a block is its steps");
  expect(near(ricochet_simulation_pickup_displacement(simulation, 0), 0.5 * 9.81 * 0.16, 1e-12),
         "s = g t^2 / 2");
  ricochet_simulation_mean_velocity(simulation, 0, mean);
  expect(near(mean[2], -9.81 * 0.4, 1e-12) && mean[0] == 0, "the body is as fast as its point");
  ricochet_simulation_energy(simulation, &energy);
  expect(near(energy.kinetic, 2 * 9.81 * 0.4 * 9.81 * 0.4, 1e-11), "m v^2 / 2");
  expect(near(energy.loads, energy.kinetic, 1e-11), "which is the work of its weight");

  ricochet_state* state = ricochet_simulation_save(simulation);
  expect(ricochet_simulation_step_block(simulation, 19600, NULL) == RICOCHET_OK, "it goes on");
  ricochet_simulation_energy(simulation, &energy);
  expect(energy.contact >= 0, "the floor gives no energy");
  expect(ricochet_simulation_displacement(simulation)[0] < 1 + 1e-12, "and does not give way");
  expect(ricochet_simulation_tangential_force(simulation)[0] == 0 && energy.friction == 0, "nothing rubs");
  expect(ricochet_simulation_restore(simulation, state) == RICOCHET_OK, "it returns");
  expect(ricochet_simulation_steps(simulation) == 400, "to where it was");
  expect(ricochet_simulation_step(simulation) == RICOCHET_OK, "and steps");
  expect(ricochet_simulation_restore(other, state) == RICOCHET_OK, "an equal one takes its state");
  store(simulation, other, state);
  ricochet_state_free(state);
  ricochet_simulation_free(simulation);
  ricochet_simulation_free(other);
  ricochet_simulation_free(NULL);
  return failures;
}
