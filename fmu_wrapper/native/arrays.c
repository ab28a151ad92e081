/* Arrays of FMI 3.0: vectors whose elements are variables of their own. */

#include "native_slave.h"

#include <stdlib.h>

#include "../fmi/functions.h"

static const ArrayOf *array_of(const Slave *self, uint32_t reference) {
    size_t number = reference - self->count - 1;
    return reference > self->count && number < self->array_count ? self->arrays + number : NULL;
}

bool native_elements(const Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                     size_t values, Elements *found) {
    *found = (Elements){vr, order, n, NULL, NULL};
    size_t count = 0;
    bool any = false;
    for (size_t k = 0; k < n; k++) {
        const ArrayOf *array = array_of(self, vr[k]);
        any = any || array;
        count += array ? (size_t)array->count : 1;
    }
    if (!is_of_length(self, function, count, values)) {
        return false;
    }
    if (!any) {
        return true;
    }
    found->made = malloc((count + 1) * sizeof *found->made);
    found->orders = order ? malloc((count + 1) * sizeof *found->orders) : NULL;
    if (!found->made || (order && !found->orders)) {
        native_elements_end(found);
        native_error(self, function, "there is no memory left for the elements of %zu arrays", n);
        return false;
    }
    size_t at = 0;
    for (size_t k = 0; k < n; k++) {
        const ArrayOf *array = array_of(self, vr[k]);
        for (int32_t i = 0; i < (array ? array->count : 1); i++, at++) {
            found->made[at] = array ? self->elements[array->first + i] : vr[k];
            if (order) {
                found->orders[at] = order[k];
            }
        }
    }
    found->vr = found->made;
    found->order = found->orders;
    found->n = count;
    return true;
}

void native_elements_end(Elements *found) {
    free(found->made);
    free(found->orders);
}
