/* Steps and events: what `Slave.do_step` and `Run.advance` do in Python. */

#include "native_slave.h"

#include <math.h>

#define LARGEST_SLIP 1e-9

static double ulp(double x) {
    x = fabs(x);
    return nextafter(x, INFINITY) - x;
}

/* End of the step, before `stop` (`grid.py`); false with a line in the log. */
static bool check_step(const Slave *self, const char *function, double t, double h, double *end) {
    double own = tlismni_time(self->run);
    *end = t + h;
    if (!isfinite(t) || !isfinite(h) || h <= 0.0) {
        native_error(self, function, "communication point %g s and step %g s must be finite, the step greater than 0", t, h);
        return false;
    }
    double scale = fmax(fmax(fabs(own), fabs(t)), h);
    double slack = fmax(8.0 * ulp(scale), fmin(LARGEST_SLIP * scale, 0.01 * h));
    if (fabs(t - own) > slack) {
        native_error(self, function, "the communication point is %.17g s, but this slave is at %.17g s: step from there, or "
                    "set a stored state first", t, own);
        return false;
    }
    if (!(*end > own) || !isfinite(*end)) {
        native_error(self, function, "the communication step %g s is lost in rounding at %.17g s: make it larger", h, own);
        return false;
    }
    if (*end > self->stop + slack) {
        native_error(self, function, "the step from %.17g s by %g s ends after the stop time %.17g s of the experiment: make "
                    "it shorter, or set up the experiment without a stop time", t, h, self->stop);
        return false;
    }
    return true;
}

/* To `t` on the way to `goal`, or to an event before that which ends the step. */
static int advance(Slave *self, double t, double goal, StepEnd *end) {
    bool event, again;
    int status;
    while ((status = tlismni_step_to_event(self->run, t, &event)) == TLISMNI_OK && event) {
        double reached = tlismni_time(self->run);
        bool early = self->early_return && reached < goal;
        native_log_events(self);
        if (self->event_mode && (early || reached >= goal)) {
            *end = (StepEnd){reached, true, early};
            return status;
        }
        do {
            status = tlismni_happen(self->run, &again);
            native_log_events(self);
        } while (status == TLISMNI_OK && again);
        if (status != TLISMNI_OK) {
            return status;
        }
        if (early) {
            *end = (StepEnd){reached, false, true};
            return status;
        }
    }
    native_log_events(self);
    return status;
}

/* The same with an intermediate update where each step of the solver ends on the way. */
static int advance_with_updates(Slave *self, double target, StepEnd *end) {
    double goal = target, point, wanted;
    for (;;) {
        int status = tlismni_next_point(self->run, goal, &point);
        *end = (StepEnd){point, false, false};
        if (status == TLISMNI_OK) {
            status = advance(self, point, goal, end);
        }
        if (status != TLISMNI_OK || end->early || end->event_due || end->time >= goal) {
            end->early = status == TLISMNI_OK && end->time < target;
            return status;
        }
        self->phase = INTERMEDIATE;
        self->fresh = false;
        bool ends = self->host.update(&self->host, end->time, self->early_return, &wanted);
        if (self->phase != INTERMEDIATE) { /* there are no outputs with the inputs that the host has set */
            return tlismni_look(self->run);
        }
        self->phase = STEP_MODE;
        if (ends) {
            goal = fmin(goal, wanted);
            if (goal <= end->time) {
                end->early = true;
                return TLISMNI_OK;
            }
        }
    }
}

int slave_step(Slave *self, const char *function, double t, double h, StepEnd *end) {
    double goal;
    *end = (StepEnd){tlismni_time(self->run), false, false};
    if (!native_may(self, function, IN(STEP_MODE)) || !check_step(self, function, t, h, &goal)) {
        return STATUS_ERROR;
    }
    bool read = self->asked, plain = !(self->event_mode || self->early_return || self->host.update);
    native_want_what_was_asked(self);
    self->asked = self->fresh = false;
    *end = (StepEnd){goal, false, false};
    int status = plain          ? tlismni_step(self->run, goal, read)
                 : self->host.update ? advance_with_updates(self, goal, end)
                                : advance(self, goal, goal, end);
    if (status) {
        self->phase = FAILED;
        end->time = tlismni_time(self->run);
        return native_run_error(self, function, status);
    }
    self->fresh = plain && read; /* what an intermediate update has looked at is of a time before */
    if (plain) {
        native_log_events(self);
    } else if (end->event_due) {
        self->phase = EVENT_DUE;
    }
    return STATUS_OK;
}

int slave_enter_event_mode(Slave *self, const char *function) {
    if (!self->event_mode) {
        return native_error(self, function, "this instance has no event mode: instantiate it with eventModeUsed = true");
    }
    if (!native_may(self, function, IN(STEP_MODE) | IN(EVENT_DUE))) {
        return STATUS_ERROR;
    }
    self->phase = EVENT_MODE;
    return STATUS_OK;
}

int slave_update(Slave *self, const char *function, bool *again) {
    *again = false;
    if (!native_may(self, function, IN(EVENT_MODE))) {
        return STATUS_ERROR;
    }
    self->fresh = false;
    int status = tlismni_happen(self->run, again);
    if (status) {
        self->phase = FAILED;
        return native_run_error(self, function, status);
    }
    native_log_events(self);
    return STATUS_OK;
}

int slave_enter_step_mode(Slave *self, const char *function) {
    if (!native_may(self, function, IN(EVENT_MODE))) {
        return STATUS_ERROR;
    }
    self->phase = STEP_MODE;
    return STATUS_OK;
}

int slave_time(Slave *self, const char *function, double *time) {
    (void)function;
    *time = tlismni_time(self->run);
    return STATUS_OK;
}
