/* A master's loop over an FMI 2.0 instance, without the cost of Python calling C: microseconds of CPU time. */
#include <math.h>
#include <stddef.h>
#include <time.h>

typedef struct {
    void *component;
    int (*do_step)(void *, double, double, int);
    int (*get)(void *, const unsigned[], size_t, double[]);
    int (*set)(void *, const unsigned[], size_t, const double[]);
    unsigned input, outputs[2];
} Master;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The input that changes, N m. */
double torque(double t) {
    return 1e-2 * sin(40.0 * t);
}

/* `points` steps of `h`: outputs are read at every `ask`-th and at the end, the input is set at every `change`-th (0:
 * never). CPU time, s, negative after an error; the last outputs. */
double run(const Master *m, long points, double h, long ask, long change, double values[2]) {
    double started = now();
    int failed = 0;
    for (long k = 0; k < points; k++) {
        if (change && k % change == 0) {
            double u = torque((double)k * h);
            failed |= m->set(m->component, &m->input, 1, &u);
        }
        failed |= m->do_step(m->component, (double)k * h, h, 1);
        if (k % ask == ask - 1) {
            failed |= m->get(m->component, m->outputs, 2, values);
        }
    }
    failed |= m->get(m->component, m->outputs, 2, values);
    return failed ? -1.0 : now() - started;
}
