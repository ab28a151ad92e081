/* What the host is told of a run. */

#include "native_slave.h"

static const char *const NAMES[] = {"instantiated", "initialization", "step",   "intermediate update",
                                    "event due",    "event",          "failed", "terminated"};

static const char *const WAYS[] = {
    [INSTANTIATED] = "enter and exit initialization mode first",
    [INITIALIZATION] = "exit initialization mode first",
    [STEP_MODE] = "reset first",
    [INTERMEDIATE] = "return from the callback of the intermediate update first",
    [EVENT_DUE] = "the last step ended at an event: enter event mode, update the discrete states, enter step mode",
    [EVENT_MODE] = "update the discrete states and enter step mode first",
    [FAILED] = "the last step failed: set a stored state, or reset",
    [TERMINATED] = "the run is terminated: reset, or set a stored state",
};

int native_run_error(Slave *self, const char *function, int status) {
    return native_error(self, function, "at t = %.9g s: %s", tlismni_time(self->run), tlismni_why(status));
}

int native_not_set(Slave *self, const char *function, size_t number, int status) {
    size_t other = tlismni_excluded_by(self->run, number);
    const char *one = tlismni_name(self->model, TLISMNI_PARAMETER, number);
    const char *kept = tlismni_name(self->model, TLISMNI_PARAMETER, other); /* none if there is no other */
    if (!one || !kept) {
        return native_run_error(self, function, status);
    }
    return native_error(self, function, "'%s' was set to %g, and '%s' is %g: one of these two must keep the value with which "
                       "it was exported, since an FMU without Python has no numbers for other values of both; export it "
                       "with these, or with Python", one, self->parameters[number], kept, self->parameters[other]);
}

bool native_may(const Slave *self, const char *function, unsigned phases) {
    if (!(phases & IN(self->phase))) {
        native_error(self, function, "CallOrderError: not in phase '%s': %s", NAMES[self->phase], WAYS[self->phase]);
        return false;
    }
    return true;
}

void native_log_events(Slave *self) {
    static const char *const KINDS[] = {"impact", "graze", "rest", "close", "open", "slip", "stick"};
    enum { ROOM = 32 };
    if (!(self->host.heard & (1u << LOG_EVENTS))) {
        return;
    }
    tlismni_event events[ROOM];
    size_t found = tlismni_events(self->run, events, ROOM);
    for (size_t k = 0; k < (found < ROOM ? found : ROOM); k++) {
        const tlismni_event *e = &events[k];
        const char *contact = tlismni_name(self->model, TLISMNI_CONTACT, (size_t)e->contact);
        host_say(&self->host, STATUS_OK, LOG_EVENTS, "%s of contact '%s' at t = %.17g s, impulse %.6g", KINDS[e->kind],
                  contact ? contact : "?", e->time, e->impulse);
    }
    if (found > ROOM) {
        host_say(&self->host, STATUS_OK, LOG_EVENTS, "%zu events more", found - ROOM);
    }
}
