#include "variable_list.h"

#include <stdio.h>
#include <string.h>

#define VARIABLES_MAGIC "TLISVARS"

/* What stands before the variables (`native_export.py`). */
typedef struct {
    char magic[8];
    int64_t version, count, arrays, elements;
    double rtol;
    char token[64];
} VariablesHead;

/* Where the lists behind the head begin; false if they do not fit. */
static bool lists(Slave *slave, size_t size) {
    const VariablesHead *head = slave->file;
    int64_t most = (int64_t)size;
    if (head->count < 0 || head->arrays < 0 || head->elements < 0 || head->count > most || head->arrays > most ||
        head->elements > most) {
        return false;
    }
    slave->count = (size_t)head->count;
    slave->array_count = (size_t)head->arrays;
    slave->variables = (const Variable *)(head + 1);
    slave->arrays = (const ArrayOf *)(slave->variables + slave->count);
    slave->elements = (const uint32_t *)(slave->arrays + slave->array_count);
    if (size != sizeof *head + slave->count * sizeof(Variable) + slave->array_count * sizeof(ArrayOf) +
                    (size_t)head->elements * sizeof(uint32_t)) {
        return false;
    }
    for (size_t k = 0; k < slave->array_count; k++) {
        const ArrayOf *a = slave->arrays + k;
        if (a->first < 0 || a->count < 0 || a->first > head->elements || a->count > head->elements - a->first) {
            return false;
        }
    }
    return true;
}

bool native_take_variables(Slave *slave, size_t size, const char *token, char *why, size_t room) {
    const VariablesHead *head = slave->file;
    if (size < sizeof *head || memcmp(head->magic, VARIABLES_MAGIC, sizeof head->magic) != 0 || head->version != 2 ||
        memchr(head->token, 0, sizeof head->token) == NULL || !lists(slave, size)) {
        snprintf(why, room, "the FMU's list of variables is damaged: export the FMU anew");
        return false;
    }
    if (strcmp(head->token, token) != 0) {
        snprintf(why, room, "the token is '%.60s', this FMU has '%s': take the one in its modelDescription.xml", token,
                 head->token);
        return false;
    }
    slave->rtol = head->rtol;
    return true;
}
