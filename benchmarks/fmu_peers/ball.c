/* A bouncing ball as C programmers write such FMUs (explicit steps of a millisecond, the bounce at the end of the step in
 * which it happens): what an FMU costs a host that does nearly nothing itself. FMI 2.0, the functions of native_host.c.
 * Value references: 1 height (m), 2 velocity (m/s). */

#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

#define STEP 1e-3
#define GRAVITY 9.81
#define RESTITUTION 0.8

typedef struct {
    double time, height, velocity;
} Ball;

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)functions, (void)visible, (void)logging;
    Ball *ball = malloc(sizeof *ball);
    if (ball) {
        *ball = (Ball){0.0, 1.0, 0.0};
    }
    return ball;
}

void fmi2FreeInstance(fmi2Component c) {
    free(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stop_defined, fmi2Real stop) {
    (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
    ((Ball *)c)->time = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    return c ? fmi2OK : fmi2Error;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    return c ? fmi2OK : fmi2Error;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    (void)c, (void)vr, (void)value;
    return n ? fmi2Error : fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    const Ball *ball = c;
    for (size_t k = 0; k < n; k++) {
        value[k] = vr[k] == 1 ? ball->height : ball->velocity;
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_way_back) {
    (void)no_way_back;
    Ball *ball = c;
    while (ball->time + 0.5 * STEP < t + h) {
        ball->time += STEP;
        ball->height += STEP * ball->velocity;
        ball->velocity -= STEP * GRAVITY;
        if (ball->height < 0.0 && ball->velocity < 0.0) {
            ball->height = 0.0;
            ball->velocity *= -RESTITUTION;
        }
    }
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    if (!*state && !(*state = malloc(sizeof(Ball)))) {
        return fmi2Error;
    }
    memcpy(*state, c, sizeof(Ball));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    memcpy(c, state, sizeof(Ball));
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(Ball);
    return fmi2OK;
}
