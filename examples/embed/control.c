/* A mechanism with impacts in the loop of a controller, in C alone.
 *
 *     python make_image.py control.image
 *     cc -o control control.c $(python -m tlismni.core.native)
 *     ./control control.image
 *
 * Every millisecond a torque is set that holds the crank's speed, as a controller in a machine would; impacts of the
 * slider on its stop happen within steps. At half time the state is kept; at the end the controller goes back to it and
 * tries another gain: the same past, another future. */

#include <stdio.h>
#include <stdlib.h>

#include <tlismni.h>

static const double STEP = 1e-3; /* s */

static void check(tlismni_status status, const tlismni_run *run) {
    if (status != TLISMNI_OK) {
        fprintf(stderr, "at t = %.6f s: %s\n", tlismni_time(run), tlismni_why(status));
        exit(1);
    }
}

/* Number of a name that the model must have. */
static size_t find(const tlismni_model *model, tlismni_kind kind, const char *name) {
    long number = tlismni_find(model, kind, name);
    if (number < 0) {
        fprintf(stderr, "the model has no '%s'\n", name);
        exit(1);
    }
    return (size_t)number;
}

/* Hold the crank's speed until `end`; the number of impacts on the way. */
static int control(tlismni_run *run, const tlismni_model *model, int first, int last, double gain) {
    size_t torque = find(model, TLISMNI_INPUT, "torque");
    size_t speed = find(model, TLISMNI_CHANNEL, "crank.angular_velocity");
    int impacts = 0;
    for (int k = first; k < last; k++) {
        tlismni_inputs(run)[torque] = gain * (6.0 - tlismni_channels(run)[speed]);
        check(tlismni_step(run, (k + 1) * STEP, true), run);
        tlismni_event events[8];
        size_t found = tlismni_events(run, events, 8);
        for (size_t i = 0; i < found && i < 8; i++) {
            if (events[i].kind == TLISMNI_IMPACT) {
                impacts++;
                printf("  impact at %.6f s, %.3f N s\n", events[i].time, events[i].impulse);
            }
        }
    }
    printf("  gain %g: %.6f rad/s at %.3f s, %lld steps of the solver\n", gain, tlismni_channels(run)[speed],
           tlismni_time(run), (long long)tlismni_steps(run));
    return impacts;
}

int main(int count, char **argument) {
    char why[500] = "name an image";
    tlismni_model *model = count == 2 ? tlismni_open(argument[1], why, sizeof why) : NULL;
    tlismni_run *run = model ? tlismni_start(model) : NULL;
    void *kept = model ? malloc(tlismni_state_size(model)) : NULL;
    if (!run || !kept) {
        fprintf(stderr, "%s\n", why);
        return 1;
    }
    check(tlismni_look(run), run);
    control(run, model, 0, 150, 2.0);
    tlismni_save(run, kept);
    int gentle = control(run, model, 150, 300, 2.0);
    check(tlismni_restore(run, kept), run);
    check(tlismni_look(run), run);
    int firm = control(run, model, 150, 300, 20.0);
    printf("%d impacts, and %d with the other gain\n", gentle, firm);
    free(kept);
    tlismni_end(run);
    tlismni_close(model);
    return 0;
}
