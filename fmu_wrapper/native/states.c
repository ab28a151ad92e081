/* Stored states: copies of memory, and bytes for other instances and processes. */

#include "native_slave.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STATE_MAGIC "TLISFMUS"

/* What stands before the packed state of the run. The check is that of all before it. */
typedef struct {
    char magic[8];
    int64_t phase, stops;
    double stop;
    uint64_t check;
} StateHead;

static uint64_t check_of(const StateHead *head) {
    uint64_t sum = 14695981039346656037u;
    for (const unsigned char *p = (const unsigned char *)head; p < (const unsigned char *)&head->check; p++) {
        sum = (sum ^ *p) * 1099511628211u;
    }
    return sum;
}

/* A handle is the address of a state of this instance; anything else is an error, and no crash. */
static Stored *kept(const Slave *self, const char *function, const void *state) {
    for (Stored *s = self->stored; s; s = s->next) {
        if (s == state) {
            return s;
        }
    }
    native_error(self, function, "the FMU state %p is unknown to instance '%.60s': it was freed, or belongs to another "
                "instance (serialise it to carry it over)", state, self->host.name);
    return NULL;
}

static Stored *new_state(Slave *self, const char *function, size_t room) {
    Stored *s = malloc(sizeof *s + room);
    if (!s) {
        native_error(self, function, "there is no memory left for a state");
        return NULL;
    }
    s->next = self->stored;
    s->room = room;
    self->stored = s;
    return s;
}

/* The state that `*state` is a handle of, if it has enough room, or a new one. */
static Stored *room_for(Slave *self, const char *function, void **state, size_t room) {
    for (Stored *s = self->stored; s && *state; s = s->next) {
        if (s == *state) {
            if (s->room >= room) {
                return s;
            }
            *state = NULL;
            slave_free_state(self, function, s);
            break;
        }
    }
    return new_state(self, function, room);
}

int slave_get_state(Slave *self, const char *function, void **state) {
    if (!native_may(self, function, ~(IN(FAILED) | IN(INTERMEDIATE)))) {
        return STATUS_ERROR;
    }
    Stored *s = room_for(self, function, state, tlismni_saved_size(self->run));
    if (!s) {
        return STATUS_ERROR;
    }
    s->phase = self->phase;
    s->stop = self->stop;
    tlismni_save(self->run, s->saved);
    *state = s;
    return STATUS_OK;
}

int slave_set_state(Slave *self, const char *function, void *state) {
    Stored *s = native_may(self, function, ~IN(INTERMEDIATE)) ? kept(self, function, state) : NULL;
    if (!s) {
        return STATUS_ERROR;
    }
    if ((s->phase == EVENT_MODE || s->phase == EVENT_DUE) && !self->event_mode) {
        return native_error(self, function, "the state was stored in event mode, and this instance has none: instantiate it "
                           "with eventModeUsed = true");
    }
    self->phase = s->phase;
    self->stop = s->stop;
    self->fresh = false;
    int status = tlismni_restore(self->run, s->saved);
    native_take_parameters(self);
    if (status) {
        self->phase = FAILED;
        return native_run_error(self, function, status);
    }
    return STATUS_OK;
}

int slave_free_state(Slave *self, const char *function, void *state) {
    Stored *s = kept(self, function, state);
    if (!s) {
        return STATUS_ERROR;
    }
    Stored **link = &self->stored;
    while (*link != s) {
        link = &(*link)->next;
    }
    *link = s->next;
    free(s);
    return STATUS_OK;
}

void native_forget_states(Slave *self) {
    while (self->stored) {
        Stored *next = self->stored->next;
        free(self->stored);
        self->stored = next;
    }
}

int slave_state_size(Slave *self, const char *function, void *state, size_t *size) {
    Stored *s = kept(self, function, state);
    if (!s) {
        return STATUS_ERROR;
    }
    *size = sizeof(StateHead) + tlismni_packed_size(s->saved);
    return STATUS_OK;
}

int slave_write_state(Slave *self, const char *function, void *state, void *bytes, size_t size) {
    Stored *s = kept(self, function, state);
    if (!s) {
        return STATUS_ERROR;
    }
    size_t needed = sizeof(StateHead) + tlismni_packed_size(s->saved);
    if (size < needed) {
        return native_error(self, function, "the buffer holds %zu bytes, the stored state needs %zu", size, needed);
    }
    StateHead head = {{0}, s->phase, isfinite(s->stop), isfinite(s->stop) ? s->stop : 0.0, 0};
    memcpy(head.magic, STATE_MAGIC, sizeof head.magic);
    head.check = check_of(&head);
    memcpy(bytes, &head, sizeof head);
    int status = tlismni_pack(self->run, s->saved, (char *)bytes + sizeof head);
    return status ? native_run_error(self, function, status) : STATUS_OK;
}

int slave_read_state(Slave *self, const char *function, const void *bytes, size_t size, void **state) {
    StateHead head;
    if (size < sizeof head) {
        return native_error(self, function, "%zu bytes are no stored state of this FMU, which takes more", size);
    }
    memcpy(&head, bytes, sizeof head);
    if (memcmp(head.magic, STATE_MAGIC, sizeof head.magic) != 0 || head.check != check_of(&head) || head.phase < 0 ||
        head.phase > TERMINATED || head.phase == FAILED || head.phase == INTERMEDIATE) {
        return native_error(self, function, "the bytes are no stored state of this FMU, or damaged: store it again");
    }
    Stored *s = new_state(self, function, tlismni_state_size(self->model));
    if (!s) {
        return STATUS_ERROR;
    }
    s->phase = (Phase)head.phase;
    s->stop = head.stops ? head.stop : INFINITY;
    int status = tlismni_unpack(self->run, (const char *)bytes + sizeof head, size - sizeof head, s->saved);
    if (status) {
        slave_free_state(self, function, s);
        return native_run_error(self, function, status);
    }
    if (*state && *state != s) { /* what it was before is no longer asked for */
        for (Stored *old = self->stored; old; old = old->next) {
            if (old == *state) {
                slave_free_state(self, function, old);
                break;
            }
        }
    }
    *state = s;
    return STATUS_OK;
}
