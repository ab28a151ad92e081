/* What the host is told. */

#include "slave.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define MESSAGE 1024

static const char *const NAMES[LOG_CATEGORIES] = {"logEvents",      "logStatusWarning", "logStatusDiscard", "logStatusError",
                                                  "logCompilation", "logTraceback",     "logAll"};

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

static void say(const Slave *self, int status, int category, const char *function, const char *format, va_list values) {
    char message[MESSAGE];
    int length = function ? snprintf(message, sizeof message, "%s: ", function) : 0;
    vsnprintf(message + length, sizeof message - (size_t)length, format, values);
    self->log(self, status, NAMES[category], message);
}

void slave_say(const Slave *self, int status, int category, const char *format, ...) {
    va_list values;
    if (self->heard & (1u << category)) {
        va_start(values, format);
        say(self, status, category, NULL, format, values);
        va_end(values);
    }
}

int slave_error(const Slave *self, const char *function, const char *format, ...) {
    va_list values;
    va_start(values, format);
    say(self, STATUS_ERROR, LOG_ERROR, function, format, values);
    va_end(values);
    return STATUS_ERROR;
}

int slave_refuses(const Slave *self, const char *function) {
    return slave_alive(self) ? slave_error(self, function, "this FMU has not got it, as its modelDescription.xml says; the "
                                           "FMU of the same model that runs with Python may have it")
                             : STATUS_ERROR;
}

int slave_run_error(Slave *self, const char *function, int status) {
    return slave_error(self, function, "at t = %.9g s: %s", tlismni_time(self->run), tlismni_why(status));
}

int slave_not_set(Slave *self, const char *function, size_t number, int status) {
    size_t other = tlismni_excluded_by(self->run, number);
    const char *one = tlismni_name(self->model, TLISMNI_PARAMETER, number);
    const char *kept = tlismni_name(self->model, TLISMNI_PARAMETER, other); /* none if there is no other */
    if (!one || !kept) {
        return slave_run_error(self, function, status);
    }
    return slave_error(self, function, "'%s' was set to %g, and '%s' is %g: one of these two must keep the value with which "
                       "it was exported, since an FMU without Python has no numbers for other values of both; export it "
                       "with these, or with Python", one, self->parameters[number], kept, self->parameters[other]);
}

bool slave_may(const Slave *self, const char *function, unsigned phases) {
    if (!slave_alive(self)) {
        return false;
    }
    if (!(phases & IN(self->phase))) {
        slave_error(self, function, "not now: %s", WAYS[self->phase]);
        return false;
    }
    return true;
}

bool slave_has_room(const Slave *self, const char *function, const void *room, size_t n) {
    if (n && !room) {
        slave_error(self, function, "NULL was given for an array or an answer: pass its address");
        return false;
    }
    return true;
}

int slave_choose_log(Slave *self, const char *function, bool on, const char *const categories[], size_t count) {
    unsigned chosen = 0;
    if (!slave_alive(self) || !slave_has_room(self, function, categories, count)) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < count; k++) {
        int found = 0;
        while (found < LOG_CATEGORIES && !(categories[k] && strcmp(categories[k], NAMES[found]) == 0)) {
            found++;
        }
        if (found == LOG_CATEGORIES) {
            return slave_error(self, function, "unknown log category '%.60s'", categories[k] ? categories[k] : "NULL");
        }
        chosen |= 1u << found;
    }
    if (!chosen || (chosen & (1u << LOG_ALL))) {
        chosen = (1u << LOG_CATEGORIES) - 1;
    }
    self->heard = on ? chosen : self->heard & ~chosen; /* switching off some leaves the others as they are */
    return STATUS_OK;
}

void slave_log_events(Slave *self) {
    static const char *const KINDS[] = {"impact", "graze", "rest", "close", "open", "slip", "stick"};
    enum { ROOM = 32 };
    if (!(self->heard & (1u << LOG_EVENTS))) {
        return;
    }
    tlismni_event events[ROOM];
    size_t found = tlismni_events(self->run, events, ROOM);
    for (size_t k = 0; k < (found < ROOM ? found : ROOM); k++) {
        const tlismni_event *e = &events[k];
        const char *contact = tlismni_name(self->model, TLISMNI_CONTACT, (size_t)e->contact);
        slave_say(self, STATUS_OK, LOG_EVENTS, "%s of contact '%s' at t = %.17g s, impulse %.6g", KINDS[e->kind],
                  contact ? contact : "?", e->time, e->impulse);
    }
    if (found > ROOM) {
        slave_say(self, STATUS_OK, LOG_EVENTS, "%zu events more", found - ROOM);
    }
}
