/* Robust position control of a variable stiffness series elastic actuator: one tick.
 *
 * C99, no memory allocation, math.h only, re-entrant. The tuning is in vssea_controller_numbers.h.
 * SI units and radians; all quantities of the equilibrium motor are at the gear side. Zeroed memory has not started.
 */
#ifndef VSSEA_CONTROLLER_H
#define VSSEA_CONTROLLER_H

#ifdef __cplusplus
extern "C" {
#endif

/* What is measured at a tick. Velocities are read only where the tuning uses measured ones. */
typedef struct {
    double theta_l, theta_e, theta_ms; /* link, equilibrium motor, stiffness motor [rad] */
    double omega_l, omega_e, omega_ms; /* their velocities [rad/s] */
} vssea_measurement_t;

/* What the drives made of the torques that were asked for [N m]. */
typedef struct {
    double applied_motor;     /* over the period that has just ended, after all limits */
    double applied_stiffness; /* the same, of the stiffness motor */
    double coming_motor;      /* over the period that begins now: the last tick's; read only with VSSEA_PREDICT */
    int motor_was_limited;    /* not 0 if a limit cut the motor torque of the last tick */
} vssea_torques_t;

/* A reference of the link and its four derivatives [rad, rad/s, ...]. */
typedef struct {
    double r, r1, r2, r3, r4;
} vssea_target_t;

/* A reference of the stiffness motor and two derivatives [rad, rad/s, rad/s^2]; the second has to be continuous. */
typedef struct {
    double r, r1, r2;
} vssea_stiffness_target_t;

/* References at this tick and one period later; the later one is read only with VSSEA_PREDICT. */
typedef struct {
    vssea_target_t now, next;
} vssea_reference_t;

typedef struct {
    vssea_stiffness_target_t now, next;
} vssea_stiffness_reference_t;

/* What the observer knows of one inertia: position, velocity, d, d', d'' [rad/s^2 ...], last measured position. */
typedef struct {
    double theta, omega, d, d1, d2, measured;
} vssea_channel_t;

/* All that is remembered between two ticks. */
typedef struct {
    vssea_channel_t link, motor, stiffness;
    double spring_torque, spring_back; /* of the last tick, divided by Y_tau */
    double started;                    /* 0 before the first tick */
    double twisting, twisting_next;    /* integral of the super-twisting law [rad/s^4], and if no limit acts */
} vssea_controller_t;

typedef struct {
    double motor_torque, stiffness_torque; /* asked for, before any limit [N m] */
    double e1, e2, e3, e4;                 /* error state, Eq. (6) */
    double sigma, snap;                    /* sliding variable, Eq. (14); nu [rad/s^4] */
    vssea_channel_t link, motor, stiffness; /* estimates at this tick; J_l link.d is the torque estimate */
    double twisting;                       /* integral in use, super-twisting law */
} vssea_output_t;

/* Forget everything: the next step starts at rest in equilibrium. */
void vssea_controller_init(vssea_controller_t *controller);

/* Call each tick while the drive is off; pass applied_motor = 0 to the next step. */
void vssea_controller_drive_is_off(vssea_controller_t *controller);

/* One tick: observers up to now, then the law. */
void vssea_controller_step(vssea_controller_t *controller, const vssea_measurement_t *measured,
                           const vssea_torques_t *torques, const vssea_reference_t *reference,
                           const vssea_stiffness_reference_t *stiffness_reference, vssea_output_t *output);

/* The same on plain vectors, without side effects: for a Simulink C Caller with a Unit Delay around the memory.
 * input: the members of vssea_measurement_t, vssea_torques_t, vssea_reference_t, vssea_stiffness_reference_t in order.
 * output: motor_torque, stiffness_torque, e1..e4, sigma, snap, link.d .d1 .d2, motor.d .d1 .d2, stiffness.d,
 * omega of link, motor and stiffness motor, twisting. */
#define VSSEA_MEMORY 23
#define VSSEA_INPUTS 26
#define VSSEA_OUTPUTS 19
void vssea_controller_flat(const double memory[VSSEA_MEMORY], const double input[VSSEA_INPUTS],
                           double next_memory[VSSEA_MEMORY], double output[VSSEA_OUTPUTS]);

/* Rest-to-rest move of 9th order from origin to target [rad] in duration, at time since its start [s]. */
void vssea_smooth_move(double origin, double target, double time, double duration, vssea_target_t *move);

#ifdef __cplusplus
}
#endif

#endif
