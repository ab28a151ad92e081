/* The life of an instance. */

#include "slave.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../shim/location.h"
#include "files.h"

#define MAGIC 0x71150002u
#define PATH 4096

bool slave_alive(const Slave *self) {
    return self && self->magic == MAGIC;
}

static void at_start(Slave *self) {
    self->phase = INSTANTIATED;
    self->stop = INFINITY;
    self->fresh = self->asked = false;
}

/* Image and variables from the resources. */
static bool load(Slave *self, const char *function, const char *token, const char *location) {
    char path[PATH], why[512];
    char *folder = location ? location_path(location) : NULL;
    if (!folder) {
        slave_error(self, function, "the resource location is NULL: the URI of the FMU's resources folder is needed");
        return false;
    }
    snprintf(path, sizeof path, "%s/variables.bin", folder);
    size_t size;
    self->file = files_read(path, &size);
    if (!self->file) {
        slave_error(self, function, "cannot read '%.300s': the FMU's resources are missing; unzip the FMU completely and "
                    "pass the URI of its resources folder", path);
    } else if (!files_variables(self, size, token, why, sizeof why)) {
        slave_error(self, function, "%s", why);
    } else {
        snprintf(path, sizeof path, "%s/model.image", folder);
        void *image = files_read(path, &size);
        self->model = image ? tlismni_read_image(image, size, why, sizeof why) : NULL;
        if (!image) {
            slave_error(self, function, "cannot read '%.300s': the FMU's resources are missing", path);
        } else if (!self->model) {
            slave_error(self, function, "%s", why);
        }
        free(image);
    }
    free(folder);
    return self->model != NULL;
}

Slave *slave_new(const Slave *given, const char *function, const char *name, const char *token, const char *resources,
                 bool logging_on) {
    Slave *self = malloc(sizeof *self);
    if (!self) {
        return NULL;
    }
    *self = *given;
    self->magic = MAGIC;
    self->heard = logging_on ? (1u << LOG_CATEGORIES) - 1 : 0;
    self->model = NULL;
    self->run = NULL;
    self->parameters = self->room = NULL;
    self->wanted = NULL;
    self->is_wanted = NULL;
    self->wants = 0;
    self->intermediate = NULL;
    self->file = NULL;
    self->stored = NULL;
    self->name = text_copy(name && *name ? name : "instance");
    at_start(self);
    if (given->intermediates) {
        self->intermediate = malloc(given->intermediates * sizeof *self->intermediate);
        if (self->intermediate) {
            memcpy(self->intermediate, given->intermediate, given->intermediates * sizeof *self->intermediate);
        }
    }
    if (self->name && (self->intermediate || !given->intermediates) && load(self, function, token ? token : "", resources)) {
        size_t numbers = 2 * tlismni_count(self->model, TLISMNI_PARAMETER) + 3 * tlismni_count(self->model, TLISMNI_INPUT);
        size_t channels = tlismni_count(self->model, TLISMNI_CHANNEL);
        self->run = tlismni_start(self->model);
        self->parameters = malloc((numbers + 1) * sizeof *self->parameters);
        self->wanted = malloc((channels + 1) * sizeof *self->wanted);
        self->is_wanted = calloc(channels + 1, sizeof *self->is_wanted);
        if (!self->run || !self->parameters || !self->wanted || !self->is_wanted) {
            slave_error(self, function, "there is no memory left for an instance");
        }
    }
    if (self->run && self->parameters && self->wanted && self->is_wanted) {
        slave_take_parameters(self);
    } else {
        slave_free(self);
        return NULL;
    }
    return self;
}

void slave_free(Slave *self) {
    if (!slave_alive(self) || self->phase == INTERMEDIATE) { /* not while it is at work */
        return;
    }
    slave_forget_states(self);
    tlismni_end(self->run);
    tlismni_close(self->model);
    free(self->parameters);
    free(self->wanted);
    free(self->is_wanted);
    free(self->room);
    free(self->intermediate);
    free(self->file);
    free(self->name);
    self->magic = 0;
    free(self);
}

int slave_set_up(Slave *self, const char *function, bool tolerance_defined, double tolerance, double start,
                 bool stop_defined, double stop) {
    if (!slave_may(self, function, IN(INSTANTIATED))) {
        return STATUS_ERROR;
    }
    if (!isfinite(start) || (stop_defined && !(isfinite(stop) && stop >= start)) ||
        (tolerance_defined && !(isfinite(tolerance) && tolerance > 0.0))) {
        return slave_error(self, function, "start time %g s, stop time %g s and tolerance %g must be finite, the stop not "
                           "before the start, the tolerance greater than 0", start, stop_defined ? stop : INFINITY,
                           tolerance_defined ? tolerance : self->rtol);
    }
    if (start != tlismni_time(self->run)) {
        int status = tlismni_start_at(self->run, start);
        if (status) {
            return slave_run_error(self, function, status);
        }
        self->start = start;
        self->fresh = false;
    }
    if (tolerance_defined && tolerance != self->rtol) {
        slave_say(self, STATUS_WARNING, LOG_WARNING, "%s: the tolerance is %g, as exported, not %g: an FMU that needs no "
                  "Python cannot change it; export it with that rtol", function, self->rtol, tolerance);
    }
    self->stop = stop_defined ? stop : INFINITY;
    return STATUS_OK;
}

int slave_enter_initialization(Slave *self, const char *function) {
    if (!slave_may(self, function, IN(INSTANTIATED))) {
        return STATUS_ERROR;
    }
    self->phase = INITIALIZATION;
    return STATUS_OK;
}

int slave_exit_initialization(Slave *self, const char *function) {
    if (!slave_may(self, function, IN(INITIALIZATION))) {
        return STATUS_ERROR;
    }
    tlismni_want(self->run, TLISMNI_ALL); /* a start without accelerations is none */
    int status = tlismni_look(self->run);
    if (status) {
        return slave_run_error(self, function, status);
    }
    self->fresh = true;
    self->phase = self->event_mode ? EVENT_MODE : STEP_MODE;
    return STATUS_OK;
}

int slave_terminate(Slave *self, const char *function) {
    if (!slave_may(self, function, IN(STEP_MODE) | IN(EVENT_MODE) | IN(EVENT_DUE) | IN(FAILED))) {
        return STATUS_ERROR;
    }
    self->phase = TERMINATED;
    return STATUS_OK;
}

int slave_reset(Slave *self, const char *function) {
    if (!slave_may(self, function, ~IN(INTERMEDIATE))) {
        return STATUS_ERROR;
    }
    tlismni_restart(self->run);
    slave_take_parameters(self);
    at_start(self); /* stored states stay */
    return STATUS_OK;
}
