/* Runs the test vectors through both interfaces; says the largest error, relative to each output's largest value. */
#include <math.h>
#include <stdio.h>

#include "vssea_controller.h"
#include "vssea_test_vectors.h"

#define TOLERANCE 1e-12

static void by_structs(vssea_controller_t *controller, const double *in, double *out)
{
    const vssea_measurement_t y = {in[0], in[1], in[2], in[3], in[4], in[5]};
    const vssea_torques_t torques = {in[6], in[7], in[8], in[9] != 0.0};
    const vssea_reference_t reference = {{in[10], in[11], in[12], in[13], in[14]}, {in[15], in[16], in[17], in[18], in[19]}};
    const vssea_stiffness_reference_t stiffness = {{in[20], in[21], in[22]}, {in[23], in[24], in[25]}};
    vssea_output_t o;
    int i;

    vssea_controller_step(controller, &y, &torques, &reference, &stiffness, &o);
    {
        const double values[VSSEA_OUTPUTS] = {
            o.motor_torque, o.stiffness_torque, o.e1,          o.e2,           o.e3,        o.e4,         o.sigma,
            o.snap,         o.link.d,           o.link.d1,     o.link.d2,      o.motor.d,   o.motor.d1,   o.motor.d2,
            o.stiffness.d,  o.link.omega,       o.motor.omega, o.stiffness.omega, o.twisting,
        };
        for (i = 0; i < VSSEA_OUTPUTS; i++)
            out[i] = values[i];
    }
}

int main(void)
{
    static const double zero[VSSEA_MEMORY];
    double memory[2][VSSEA_MEMORY], out[2][VSSEA_OUTPUTS], scale[VSSEA_OUTPUTS], worst = 0.0;
    vssea_controller_t controller;
    int tick, i, way, worst_tick = 0, worst_output = 0;

    for (i = 0; i < VSSEA_OUTPUTS; i++) {
        scale[i] = 0.0;
        for (tick = 0; tick < VSSEA_TICKS; tick++)
            scale[i] = fmax(scale[i], fabs(vssea_expected[tick][i]));
    }
    vssea_controller_init(&controller);
    for (tick = 0; tick < VSSEA_TICKS; tick++) {
        by_structs(&controller, vssea_inputs[tick], out[0]);
        vssea_controller_flat(tick == 0 ? zero : memory[(tick + 1) % 2], vssea_inputs[tick], memory[tick % 2], out[1]);
        for (way = 0; way < 2; way++) {
            for (i = 0; i < VSSEA_OUTPUTS; i++) {
                double error = fabs(out[way][i] - vssea_expected[tick][i]);

                if (scale[i] > 0.0)
                    error /= scale[i];
                if (error <= worst)
                    continue;
                worst = error;
                worst_tick = tick;
                worst_output = i;
                if (isnan(error)) {
                    printf("tick %d: output %d is not a number\n", tick, i);
                    return 1;
                }
            }
        }
    }
    printf("%d ticks, largest relative error %.3g (output %d, tick %d)\n", VSSEA_TICKS, worst, worst_output, worst_tick);
    return worst <= TOLERANCE ? 0 : 1;
}
