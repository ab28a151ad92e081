/* The life of an instance. */

#include "native_slave.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../fmi/files.h"
#include "variable_list.h"

#define MAGIC 0x71150002u
#define PATH 4096

Host *slave_host(const Slave *self) {
    Slave *instance = (Slave *)(uintptr_t)self; /* what is shown of it may change */
    return self && self->magic == MAGIC ? &instance->host : NULL;
}

static void at_start(Slave *self) {
    self->phase = INSTANTIATED;
    self->stop = INFINITY;
    self->fresh = self->asked = false;
}

/* Image and variables from the resources. */
static bool load(Slave *self, const char *function, const char *token, const char *folder) {
    char path[PATH], why[512];
    snprintf(path, sizeof path, "%s/variables.bin", folder);
    size_t size;
    self->file = files_read(path, &size);
    if (!self->file) {
        native_error(self, function, "cannot read '%.300s': the FMU's resources are missing; unzip the FMU completely and "
                    "pass the URI of its resources folder", path);
    } else if (!native_take_variables(self, size, token, why, sizeof why)) {
        native_error(self, function, "%s", why);
    } else {
        snprintf(path, sizeof path, "%s/model.image", folder);
        void *image = files_read(path, &size);
        self->model = image ? tlismni_read_image(image, size, why, sizeof why) : NULL;
        if (!image) {
            native_error(self, function, "cannot read '%.300s': the FMU's resources are missing", path);
        } else if (!self->model) {
            native_error(self, function, "%s", why);
        }
        free(image);
    }
    return self->model != NULL;
}

Slave *slave_new(const Host *host, const Asked *asked, const char *function, const char *token, const char *resources) {
    Slave *self = calloc(1, sizeof *self);
    if (!self) {
        return NULL;
    }
    self->magic = MAGIC;
    self->host = *host;
    self->event_mode = asked->event_mode;
    self->early_return = asked->early_return;
    self->intermediates = asked->intermediates;
    at_start(self);
    if (asked->intermediates) {
        self->intermediate = malloc(asked->intermediates * sizeof *self->intermediate);
        if (self->intermediate) {
            memcpy(self->intermediate, asked->intermediate, asked->intermediates * sizeof *self->intermediate);
        }
    }
    if ((self->intermediate || !asked->intermediates) && load(self, function, token, resources)) {
        size_t numbers = 2 * tlismni_count(self->model, TLISMNI_PARAMETER) + 3 * tlismni_count(self->model, TLISMNI_INPUT);
        size_t channels = tlismni_count(self->model, TLISMNI_CHANNEL);
        self->run = tlismni_start(self->model);
        self->parameters = malloc((numbers + 1) * sizeof *self->parameters);
        self->wanted = malloc((channels + 1) * sizeof *self->wanted);
        self->is_wanted = calloc(channels + 1, sizeof *self->is_wanted);
        if (!self->run || !self->parameters || !self->wanted || !self->is_wanted) {
            native_error(self, function, "there is no memory left for an instance");
        }
    }
    if (self->run && self->parameters && self->wanted && self->is_wanted) {
        native_take_parameters(self);
    } else {
        slave_free(self);
        return NULL;
    }
    return self;
}

void slave_free(Slave *self) {
    native_forget_states(self);
    tlismni_end(self->run);
    tlismni_close(self->model);
    free(self->parameters);
    free(self->wanted);
    free(self->is_wanted);
    free(self->room);
    free(self->intermediate);
    free(self->file);
    self->magic = 0;
    free(self);
}

int slave_set_up(Slave *self, const char *function, const Experiment *given) {
    const double start = given->start, stop = given->stop_defined ? given->stop : INFINITY;
    const double tolerance = given->tolerance_defined ? given->tolerance : self->rtol;
    if (!native_may(self, function, IN(INSTANTIATED))) {
        return STATUS_ERROR;
    }
    if (!isfinite(start) || (given->stop_defined && !(isfinite(stop) && stop >= start)) ||
        !(isfinite(tolerance) && tolerance > 0.0)) {
        return native_error(self, function, "start time %g s, stop time %g s and tolerance %g must be finite, the stop not "
                           "before the start, the tolerance greater than 0", start, stop, tolerance);
    }
    if (start != tlismni_time(self->run)) {
        int status = tlismni_start_at(self->run, start);
        if (status) {
            return native_run_error(self, function, status);
        }
        self->start = start;
        self->fresh = false;
    }
    if (tolerance != self->rtol) {
        host_say(&self->host, STATUS_WARNING, LOG_WARNING, "%s: the tolerance is %g, as exported, not %g: an FMU that needs no "
                  "Python cannot change it; export it with that rtol", function, self->rtol, tolerance);
    }
    self->stop = stop;
    return STATUS_OK;
}

int slave_enter_initialization(Slave *self, const char *function, const Experiment *experiment) {
    int status = experiment ? slave_set_up(self, function, experiment) : STATUS_OK;
    if (status != STATUS_OK || !native_may(self, function, IN(INSTANTIATED))) {
        return STATUS_ERROR;
    }
    self->phase = INITIALIZATION;
    return STATUS_OK;
}

int slave_exit_initialization(Slave *self, const char *function) {
    if (!native_may(self, function, IN(INITIALIZATION))) {
        return STATUS_ERROR;
    }
    tlismni_want(self->run, TLISMNI_ALL); /* a start without accelerations is none */
    int status = tlismni_look(self->run);
    if (status) {
        return native_run_error(self, function, status);
    }
    self->fresh = true;
    self->phase = self->event_mode ? EVENT_MODE : STEP_MODE;
    return STATUS_OK;
}

int slave_terminate(Slave *self, const char *function) {
    if (!native_may(self, function, IN(STEP_MODE) | IN(EVENT_MODE) | IN(EVENT_DUE) | IN(FAILED))) {
        return STATUS_ERROR;
    }
    self->phase = TERMINATED;
    return STATUS_OK;
}

int slave_reset(Slave *self, const char *function) {
    if (!native_may(self, function, ~IN(INTERMEDIATE))) {
        return STATUS_ERROR;
    }
    tlismni_restart(self->run);
    native_take_parameters(self);
    at_start(self); /* stored states stay */
    return STATUS_OK;
}

int slave_log_chosen(Slave *self, const char *function, bool on, const char *const categories[], size_t count) {
    (void)self, (void)function, (void)on, (void)categories, (void)count; /* nothing else is heard than by the host */
    return STATUS_OK;
}
