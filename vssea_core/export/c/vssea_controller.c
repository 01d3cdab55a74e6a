/* One tick of the controller. Equation numbers are those of the paper; README.txt has the order of a tick.
 *
 * The order of arithmetic is that of the program the numbers come from: compile without -ffast-math, and with
 * -ffp-contract=off where the compiler would join a product and a sum, if the last digits are to agree.
 */
#include "vssea_controller.h"

#include <math.h>

#include "vssea_controller_numbers.h"

/* The spring divided by Y_tau. */
typedef struct {
    double torque;    /* sin(delta/2) / theta_ms^3, Eq. (3) */
    double stiffness; /* cos(delta/2) / (2 theta_ms^3), Eq. (4) */
    double back;      /* torque on the stiffness motor, -12 sin^2(delta/4) / theta_ms^4 */
} spring_t;

/* Where the gains that may follow the stiffness stand in a row of the table. */
enum { K1, K2, K3, K4, S1, S2, S3, X1, X2, X3, X4, PREFILTER, LINK, MOTOR = LINK + VSSEA_OBSERVER };

static spring_t spring_at(double deflection, double theta_ms)
{
    double x = 0.25 * deflection, q, c, s, ss, sine;
    double per_theta, per_cube;
    spring_t spring;

    if (fabs(x) > 0.78539816339744831) /* the law ends at a deflection of pi */
        x = copysign(0.78539816339744831, x);
    s = x * x; /* series, error below 2e-16 */
    ss = s * s;
    sine = (1.0 - s * (1.0 / 6.0))
           + ss * ((1.0 / 120.0 - s * (1.0 / 5040.0))
                   + ss * ((1.0 / 362880.0 - s * (1.0 / 39916800.0))
                           + ss * (1.0 / 6227020800.0 - s * (1.0 / 1307674368000.0))));
    c = (1.0 - s * 0.5)
        + ss * ((1.0 / 24.0 - s * (1.0 / 720.0))
                + ss * ((1.0 / 40320.0 - s * (1.0 / 3628800.0))
                        + ss * ((1.0 / 479001600.0 - s * (1.0 / 87178291200.0)) + ss * (1.0 / 20922789888000.0))));
    q = x * sine;
    per_theta = 1.0 / theta_ms;
    per_cube = per_theta * per_theta * per_theta;
    spring.torque = 2.0 * q * c * per_cube;
    spring.stiffness = (0.5 - q * q) * per_cube;
    spring.back = -12.0 * q * q * per_cube * per_theta;
    return spring;
}

/* Gains at a position of the stiffness motor, through the four nearest rows, which are evenly spaced in ln k. */
static const double *gains_at(double theta_ms, double row[VSSEA_ROW])
{
#if VSSEA_ROWS == 1
    (void)theta_ms;
    (void)row;
    return vssea_rows[0];
#else
    double at = rint(theta_ms * 1024.0) / 1024.0;
    double place = (log(0.5 * VSSEA_SPRING_CONSTANT / (at * at * at)) - VSSEA_FIRST_LN_K) * VSSEA_ROWS_PER_LN_K;
    double x, w0, w1, w2, w3;
    int first, i;

    place = fmin(fmax(place, 0.0), VSSEA_ROWS - 1.0);
    first = (int)place - 1;
    if (first < 0)
        first = 0;
    if (first > VSSEA_ROWS - 4)
        first = VSSEA_ROWS - 4;
    x = place - first;
    w0 = -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0;
    w1 = x * (x - 2.0) * (x - 3.0) / 2.0;
    w2 = -x * (x - 1.0) * (x - 3.0) / 2.0;
    w3 = x * (x - 1.0) * (x - 2.0) / 6.0;
    for (i = 0; i < VSSEA_ROW; i++)
        row[i] = w0 * vssea_rows[first][i] + w1 * vssea_rows[first + 1][i] + w2 * vssea_rows[first + 2][i]
                 + w3 * vssea_rows[first + 3][i];
    return row;
#endif
}

/* First tick: at rest in equilibrium, d = f and d' = d'' = 0; a zero estimate would kick the motor. */
static vssea_channel_t channel_at_rest(double theta, double d)
{
    vssea_channel_t channel;

    channel.theta = theta;
    channel.omega = 0.0;
    channel.d = d;
    channel.d1 = 0.0;
    channel.d2 = 0.0;
    channel.measured = theta;
    return channel;
}

#if VSSEA_FORM == VSSEA_POSITION

/* Position form: x- = A x + B0 phi0 + B1 phi1, x = x- + M (theta - x-[0]) with x = [theta, omega, d, d', d''].
 * g: A[0][1..4], A[1][1..4], B0[0], B1[0], B0[1], B1[1], M[0..4]; phi without damping, which is in A. */
static void update(const double *g, vssea_channel_t *channel, double theta, double phi0, double phi1)
{
    double w = channel->omega, d = channel->d, d1 = channel->d1, d2 = channel->d2, t = VSSEA_SAMPLE_TIME;
    double angle = channel->theta + g[0] * w + g[1] * d + g[2] * d1 + g[3] * d2 + g[8] * phi0 + g[9] * phi1;
    double speed = g[4] * w + g[5] * d + g[6] * d1 + g[7] * d2 + g[10] * phi0 + g[11] * phi1;
    double innovation = theta - angle;

    channel->theta = angle + g[12] * innovation;
    channel->omega = speed + g[13] * innovation;
    channel->d = d + t * d1 + 0.5 * t * t * d2 + g[14] * innovation;
    channel->d1 = d1 + t * d2 + g[15] * innovation;
    channel->d2 = d2 + g[16] * innovation;
    channel->measured = theta;
}

#else

/* Velocity form, Eq. (22) in d, d', d'': d+ = A d + h (omega+ - omega) + b0 f0 + b1 f1, with the nominal acceleration
 * f = phi - damping_rate omega at both ends of the period. g: A by rows, h, b0, b1; all 0 where the observer is off. */
static void update(const double *g, vssea_channel_t *channel, double theta, double omega, double phi0, double phi1,
                   double damping_rate)
{
    double d = channel->d, d1 = channel->d1, d2 = channel->d2, dv, f0, f1;

#if VSSEA_DIFFERENCE
    omega = VSSEA_DIFFERENCE_KEEP * channel->omega + VSSEA_DIFFERENCE_GAIN * (theta - channel->measured);
#endif
    dv = omega - channel->omega;
    f0 = phi0 - damping_rate * channel->omega;
    f1 = phi1 - damping_rate * omega;
    channel->theta = theta;
    channel->omega = omega;
    channel->d = g[0] * d + g[1] * d1 + g[2] * d2 + g[9] * dv + g[12] * f0 + g[15] * f1;
    channel->d1 = g[3] * d + g[4] * d1 + g[5] * d2 + g[10] * dv + g[13] * f0 + g[16] * f1;
    channel->d2 = g[6] * d + g[7] * d1 + g[8] * d2 + g[11] * dv + g[14] * f0 + g[17] * f1;
    channel->measured = theta;
}

#endif

/* Bring the observers up to now, with the torques applied over the period that has just ended. */
static void observe(vssea_controller_t *c, const double *gains, const vssea_measurement_t *y, double applied_e,
                    double applied_ms)
{
    spring_t spring = spring_at(y->theta_e - y->theta_l, y->theta_ms);
    double per_l = 1.0 / VSSEA_LINK_INERTIA, per_e = 1.0 / VSSEA_MOTOR_INERTIA, per_ms = 1.0 / VSSEA_STIFFNESS_INERTIA;
    double tau_s0 = VSSEA_SPRING_CONSTANT * c->spring_torque, tau_s1 = VSSEA_SPRING_CONSTANT * spring.torque;
    double back0 = VSSEA_SPRING_CONSTANT * c->spring_back, back1 = VSSEA_SPRING_CONSTANT * spring.back;

    c->spring_torque = spring.torque;
    c->spring_back = spring.back;
    if (c->started == 0.0) {
        double d_l = tau_s1 * per_l, d_e = (applied_e - tau_s1) * per_e;

        c->link = channel_at_rest(y->theta_l, VSSEA_FORM == VSSEA_OFF ? 0.0 : d_l);
        c->motor = channel_at_rest(y->theta_e, VSSEA_FORM == VSSEA_OFF ? 0.0 : d_e);
        c->stiffness = channel_at_rest(y->theta_ms, (applied_ms - back1) * per_ms);
        c->started = 1.0;
        return;
    }
#if VSSEA_FORM == VSSEA_POSITION
    update(gains + LINK, &c->link, y->theta_l, tau_s0 * per_l, tau_s1 * per_l);
    update(gains + MOTOR, &c->motor, y->theta_e, (applied_e - tau_s0) * per_e, (applied_e - tau_s1) * per_e);
    update(vssea_stiffness_observer, &c->stiffness, y->theta_ms, (applied_ms - back0) * per_ms,
           (applied_ms - back1) * per_ms);
#else
    update(gains + LINK, &c->link, y->theta_l, y->omega_l, tau_s0 * per_l, tau_s1 * per_l, VSSEA_LINK_DAMPING * per_l);
    update(gains + MOTOR, &c->motor, y->theta_e, y->omega_e, (applied_e - tau_s0) * per_e, (applied_e - tau_s1) * per_e,
           VSSEA_MOTOR_DAMPING * per_e);
    update(vssea_stiffness_observer, &c->stiffness, y->theta_ms, y->omega_ms, (applied_ms - back0) * per_ms,
           (applied_ms - back1) * per_ms, VSSEA_STIFFNESS_DAMPING * per_ms);
#endif
}

#if VSSEA_PREDICT

typedef struct {
    double link, motor;
} pair_t;

/* theta_l'' and theta_e'' at `time` after the tick, Eq. (1) with the estimated disturbances going on. */
static pair_t accelerations(const vssea_controller_t *c, double ms_acceleration, double torque, double time,
                            double theta_l, double omega_l, double theta_e, double omega_e)
{
    double theta_ms = c->stiffness.measured + time * (c->stiffness.omega + 0.5 * time * ms_acceleration);
    double tau_s = VSSEA_SPRING_CONSTANT * spring_at(theta_e - theta_l, theta_ms).torque;
    double d_l = c->link.d + time * (c->link.d1 + 0.5 * time * c->link.d2);
    double d_e = c->motor.d + time * (c->motor.d1 + 0.5 * time * c->motor.d2);
    pair_t a;

    a.link = (tau_s - VSSEA_LINK_DAMPING * omega_l) * (1.0 / VSSEA_LINK_INERTIA) - d_l;
    a.motor = (torque - tau_s - VSSEA_MOTOR_DAMPING * omega_e) * (1.0 / VSSEA_MOTOR_INERTIA) - d_e;
    return a;
}

static vssea_channel_t channel_ahead(const vssea_channel_t *now, double theta, double omega, double time)
{
    vssea_channel_t ahead;

    ahead.theta = theta;
    ahead.omega = omega;
    ahead.d = now->d + time * (now->d1 + 0.5 * time * now->d2);
    ahead.d1 = now->d1 + time * now->d2;
    ahead.d2 = now->d2;
    ahead.measured = theta;
    return ahead;
}

/* The state in which this tick's torque will meet the plant: one Runge-Kutta step with the torque that is on its way. */
static vssea_controller_t predicted(const vssea_controller_t *c, double torque, double ms_acceleration)
{
    double t = VSSEA_SAMPLE_TIME, h = 0.5 * t, moved;
    double x1 = c->link.theta, v1 = c->link.omega, y1 = c->motor.theta, w1 = c->motor.omega;
    double v2, v3, v4, w2, w3, w4;
    pair_t a1, a2, a3, a4;
    vssea_controller_t ahead = *c;

    a1 = accelerations(c, ms_acceleration, torque, 0.0, x1, v1, y1, w1);
    v2 = v1 + h * a1.link;
    w2 = w1 + h * a1.motor;
    a2 = accelerations(c, ms_acceleration, torque, h, x1 + h * v1, v2, y1 + h * w1, w2);
    v3 = v1 + h * a2.link;
    w3 = w1 + h * a2.motor;
    a3 = accelerations(c, ms_acceleration, torque, h, x1 + h * v2, v3, y1 + h * w2, w3);
    v4 = v1 + t * a3.link;
    w4 = w1 + t * a3.motor;
    a4 = accelerations(c, ms_acceleration, torque, t, x1 + t * v3, v4, y1 + t * w3, w4);
    ahead.link = channel_ahead(&c->link, x1 + t / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4),
                               v1 + t / 6.0 * (a1.link + 2.0 * a2.link + 2.0 * a3.link + a4.link), t);
    ahead.motor = channel_ahead(&c->motor, y1 + t / 6.0 * (w1 + 2.0 * w2 + 2.0 * w3 + w4),
                                w1 + t / 6.0 * (a1.motor + 2.0 * a2.motor + 2.0 * a3.motor + a4.motor), t);
    moved = t * (c->stiffness.omega + h * ms_acceleration);
    ahead.stiffness.theta = c->stiffness.theta + moved;
    ahead.stiffness.omega = c->stiffness.omega + t * ms_acceleration;
    ahead.stiffness.measured = c->stiffness.measured + moved;
    return ahead;
}

#endif

/* sgn(sigma), or what stands for it over +-layer_width. */
static double switched(double sigma)
{
    if (VSSEA_SWITCH == VSSEA_LAYER)
        return fmin(1.0, fmax(-1.0, sigma / VSSEA_LAYER_WIDTH));
    if (VSSEA_SWITCH == VSSEA_TANH)
        return tanh(sigma / VSSEA_LAYER_WIDTH);
    return sigma != 0.0 ? copysign(1.0, sigma) : 0.0;
}

/* Snap that drives sigma to zero, Eq. (16), and the super-twisting integral one tick later. */
static double reaching(double sigma, double twisting, double *twisting_next)
{
    double sign = switched(sigma);

    if (VSSEA_SWITCH == VSSEA_SUPER_TWISTING) {
        double pull = 1.5 * sqrt(VSSEA_TWISTING_GAIN * fabs(sigma)) * sign;

        *twisting_next = twisting + 1.1 * VSSEA_TWISTING_GAIN * VSSEA_SAMPLE_TIME * sign;
        return pull + twisting;
    }
    return VSSEA_SWITCHING_GAIN * sign;
}

/* Error state, the link's snap nu by Eq. (9) or (16), and the map from snap to torque with the stiffness moving. */
static void act(const vssea_controller_t *c, const double *g, const vssea_target_t *target,
                const vssea_stiffness_target_t *ms, double *twisting_next, vssea_output_t *o)
{
    const vssea_channel_t *link = &c->link, *motor = &c->motor, *stiffness = &c->stiffness;
    double theta_ms = stiffness->measured;
    spring_t spring = spring_at(motor->theta - link->theta, theta_ms);
    double tau_s = VSSEA_SPRING_CONSTANT * spring.torque, k = VSSEA_SPRING_CONSTANT * spring.stiffness;
    double per_theta = 1.0 / theta_ms, per_inertia = 1.0 / VSSEA_LINK_INERTIA;
    double known_rate = VSSEA_RATE_SHARE * stiffness->omega * per_theta;
    double ms_rate = VSSEA_MOVING_SHARE * stiffness->omega * per_theta;
    double ms_acceleration = VSSEA_MOVING_SHARE * ms->r2 * per_theta;
    double deflection_rate = motor->omega - link->omega;
    double tau_s_rate = k * deflection_rate - 3.0 * tau_s * known_rate;
    double beta = VSSEA_LINK_DAMPING * per_inertia;
    double a_l = tau_s * per_inertia - beta * link->omega - link->d;
    double j_l = tau_s_rate * per_inertia - beta * a_l - link->d1;
    double e1 = target->r - link->theta, e2 = target->r1 - link->omega, e3 = target->r2 - a_l, e4 = target->r3 - j_l;
    double sigma = g[S1] * e1 + g[S2] * e2 + g[S3] * e3 + e4;
    double snap, moving, a_e, asked;

    *twisting_next = 0.0;
    if (VSSEA_CONTROLLER == VSSEA_SLIDING_MODE) {
        double pull = reaching(sigma, c->twisting, twisting_next);

        snap = target->r4 + g[S1] * e2 + g[S2] * e3 + g[S3] * e4 + pull;
    } else {
        snap = target->r4 + g[K1] * e1 + g[K2] * e2 + g[K3] * e3 + g[K4] * e4;
    }
    moving = -0.25 * tau_s * deflection_rate * deflection_rate - 6.0 * k * deflection_rate * ms_rate
             + 12.0 * tau_s * ms_rate * ms_rate - 3.0 * tau_s * ms_acceleration;
    a_e = a_l + (VSSEA_LINK_INERTIA * (snap + link->d2) + VSSEA_LINK_DAMPING * j_l - moving) / k;
    o->motor_torque = VSSEA_MOTOR_INERTIA * (a_e + motor->d) + tau_s + VSSEA_MOTOR_DAMPING * motor->omega;
    if (VSSEA_CONTROLLER == VSSEA_BASELINE) { /* Fig. 2: u = -Kx x + N_r r */
        o->motor_torque = g[PREFILTER] * target->r - g[X1] * link->theta - g[X2] * link->omega - g[X3] * motor->theta
                          - g[X4] * motor->omega;
        snap = 0.0;
    }
    asked = ms->r2 + VSSEA_STIFFNESS_P * (ms->r - stiffness->theta) + VSSEA_STIFFNESS_D * (ms->r1 - stiffness->omega);
    o->stiffness_torque = VSSEA_STIFFNESS_INERTIA * (asked + stiffness->d) + VSSEA_STIFFNESS_DAMPING * stiffness->omega
                          + VSSEA_SPRING_CONSTANT * c->spring_back; /* Eq. (19) with r'', b_ms and tau_back */
    o->e1 = e1;
    o->e2 = e2;
    o->e3 = e3;
    o->e4 = e4;
    o->sigma = sigma;
    o->snap = snap;
}

void vssea_controller_init(vssea_controller_t *controller)
{
    static const vssea_controller_t zero;

    *controller = zero;
}

void vssea_controller_drive_is_off(vssea_controller_t *controller)
{
    controller->twisting = 0.0;
    controller->twisting_next = 0.0;
}

void vssea_controller_step(vssea_controller_t *controller, const vssea_measurement_t *measured,
                           const vssea_torques_t *torques, const vssea_reference_t *reference,
                           const vssea_stiffness_reference_t *stiffness_reference, vssea_output_t *output)
{
    double row[VSSEA_ROW];
    /* Gains are those at the last measured position of the stiffness motor. */
    const double *gains =
        gains_at(controller->started != 0.0 ? controller->stiffness.measured : stiffness_reference->now.r, row);

    if (!torques->motor_was_limited)
        controller->twisting = controller->twisting_next;
    observe(controller, gains, measured, torques->applied_motor, torques->applied_stiffness);
#if VSSEA_PREDICT
    {
        vssea_controller_t ahead = predicted(controller, torques->coming_motor, stiffness_reference->now.r2);

        act(&ahead, gains, &reference->next, &stiffness_reference->next, &controller->twisting_next, output);
    }
#else
    act(controller, gains, &reference->now, &stiffness_reference->now, &controller->twisting_next, output);
#endif
    output->link = controller->link;
    output->motor = controller->motor;
    output->stiffness = controller->stiffness;
    output->twisting = controller->twisting;
}

static const double *read_channel(const double *from, vssea_channel_t *channel)
{
    channel->theta = *from++;
    channel->omega = *from++;
    channel->d = *from++;
    channel->d1 = *from++;
    channel->d2 = *from++;
    channel->measured = *from++;
    return from;
}

static double *write_channel(double *to, const vssea_channel_t *channel)
{
    *to++ = channel->theta;
    *to++ = channel->omega;
    *to++ = channel->d;
    *to++ = channel->d1;
    *to++ = channel->d2;
    *to++ = channel->measured;
    return to;
}

static const double *read_target(const double *from, vssea_target_t *target)
{
    target->r = *from++;
    target->r1 = *from++;
    target->r2 = *from++;
    target->r3 = *from++;
    target->r4 = *from++;
    return from;
}

static const double *read_stiffness_target(const double *from, vssea_stiffness_target_t *target)
{
    target->r = *from++;
    target->r1 = *from++;
    target->r2 = *from++;
    return from;
}

void vssea_controller_flat(const double memory[VSSEA_MEMORY], const double input[VSSEA_INPUTS],
                           double next_memory[VSSEA_MEMORY], double output[VSSEA_OUTPUTS])
{
    vssea_controller_t c;
    vssea_measurement_t y;
    vssea_torques_t torques;
    vssea_reference_t reference;
    vssea_stiffness_reference_t stiffness;
    vssea_output_t o;

    memory = read_channel(read_channel(read_channel(memory, &c.link), &c.motor), &c.stiffness);
    c.spring_torque = memory[0];
    c.spring_back = memory[1];
    c.started = memory[2];
    c.twisting = memory[3];
    c.twisting_next = memory[4];
    y.theta_l = input[0];
    y.theta_e = input[1];
    y.theta_ms = input[2];
    y.omega_l = input[3];
    y.omega_e = input[4];
    y.omega_ms = input[5];
    torques.applied_motor = input[6];
    torques.applied_stiffness = input[7];
    torques.coming_motor = input[8];
    torques.motor_was_limited = input[9] != 0.0;
    input = read_target(read_target(input + 10, &reference.now), &reference.next);
    read_stiffness_target(read_stiffness_target(input, &stiffness.now), &stiffness.next);

    vssea_controller_step(&c, &y, &torques, &reference, &stiffness, &o);

    next_memory = write_channel(write_channel(write_channel(next_memory, &c.link), &c.motor), &c.stiffness);
    next_memory[0] = c.spring_torque;
    next_memory[1] = c.spring_back;
    next_memory[2] = c.started;
    next_memory[3] = c.twisting;
    next_memory[4] = c.twisting_next;
    output[0] = o.motor_torque;
    output[1] = o.stiffness_torque;
    output[2] = o.e1;
    output[3] = o.e2;
    output[4] = o.e3;
    output[5] = o.e4;
    output[6] = o.sigma;
    output[7] = o.snap;
    output[8] = o.link.d;
    output[9] = o.link.d1;
    output[10] = o.link.d2;
    output[11] = o.motor.d;
    output[12] = o.motor.d1;
    output[13] = o.motor.d2;
    output[14] = o.stiffness.d;
    output[15] = o.link.omega;
    output[16] = o.motor.omega;
    output[17] = o.stiffness.omega;
    output[18] = o.twisting;
}

void vssea_smooth_move(double origin, double target, double time, double duration, vssea_target_t *move)
{
    double x = time / duration, u = x * (1.0 - x), v = 1.0 - 2.0 * x, rate = 1.0 / duration, size = target - origin;

    move->r1 = move->r2 = move->r3 = move->r4 = 0.0;
    if (x <= 0.0) {
        move->r = origin;
    } else if (x >= 1.0) {
        move->r = origin + size;
    } else {
        move->r = origin + size * (x * x * x * x * x * (126.0 + x * (-420.0 + x * (540.0 + x * (-315.0 + 70.0 * x)))));
        move->r1 = size * rate * (630.0 * u * u * u * u);
        move->r2 = size * (rate * rate) * (2520.0 * u * u * u * v);
        move->r3 = size * (rate * rate * rate) * (7560.0 * u * u * v * v - 5040.0 * u * u * u);
        move->r4 = size * (rate * rate * rate * rate) * (15120.0 * u * v * v * v - 45360.0 * u * u * v);
    }
}
