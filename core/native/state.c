/* States: copies of what decides the future of a run, and the same for other runs and processes. */

#include "codes.h"
#include "image.h"

#include <string.h>

#define PACKED_MAGIC "TLISTATE"

/* What stands before a packed state. */
typedef struct {
    char magic[8];
    int64_t version, image, checksum, size;
} PackedHead;

/* What a word of the tables is. */
enum { NUMBER, OWN, SHARED, OF_LIBRARY };

/* A saved state: Beside, then the decisive part of the memory. */

size_t tlismni_state_size(const tlismni_model *model) {
    return sizeof(Beside) + (size_t)model->head.decisive;
}

size_t tlismni_packed_size(const tlismni_model *model) {
    return sizeof(PackedHead) + tlismni_state_size(model) + (size_t)model->head.tables / 8;
}

void tlismni_save(const tlismni_run *run, void *bytes) {
    memcpy(bytes, &run->beside, sizeof run->beside);
    memcpy((char *)bytes + sizeof run->beside, run->own, (size_t)run->model->head.decisive);
}

void tlismni_restore(tlismni_run *run, const void *bytes) {
    memcpy(&run->beside, bytes, sizeof run->beside);
    memcpy(run->own, (const char *)bytes + sizeof run->beside, (size_t)run->model->head.decisive);
}

/* Number of a function of the image; -1 if it has it not. */
static int64_t function_number(const tlismni_model *m, uint64_t address) {
    for (int64_t k = 0; k < m->head.functions; k++) {
        if ((uint64_t)(uintptr_t)m->functions[k] == address) {
            return k;
        }
    }
    return -1;
}

tlismni_status tlismni_pack(const tlismni_run *run, const void *saved, void *bytes) {
    const tlismni_model *m = run->model;
    size_t size = tlismni_state_size(m), words = (size_t)m->head.tables / 8;
    char *state = (char *)bytes + sizeof(PackedHead), *kinds = state + size;
    memcpy(state, saved, size);
    memset(kinds, NUMBER, words);
    uint64_t own = (uint64_t)(uintptr_t)run->own, shared = (uint64_t)(uintptr_t)m->shared;
    for (size_t k = 0; k < words; k++) {
        char *place = state + sizeof(Beside) + 8 * k;
        uint64_t word;
        memcpy(&word, place, sizeof word);
        if (word - own < (uint64_t)m->head.own) {
            word -= own, kinds[k] = OWN;
        } else if (word - shared < (uint64_t)m->head.shared) {
            word -= shared, kinds[k] = SHARED;
        } else if (word >> 32 && word >> 48 == 0) {
            int64_t number = function_number(m, word);
            if (number < 0) {
                return NOT_PACKED;
            }
            word = (uint64_t)number, kinds[k] = OF_LIBRARY;
        }
        memcpy(place, &word, sizeof word);
    }
    PackedHead head = {{0}, IMAGE_VERSION, m->head.checksum, image_checksum(state, size + words), (int64_t)(size + words)};
    memcpy(head.magic, PACKED_MAGIC, sizeof head.magic);
    memcpy(bytes, &head, sizeof head);
    return TLISMNI_OK;
}

tlismni_status tlismni_unpack(const tlismni_run *run, const void *bytes, size_t given, void *saved) {
    const tlismni_model *m = run->model;
    size_t size = tlismni_state_size(m), words = (size_t)m->head.tables / 8;
    const char *state = (const char *)bytes + sizeof(PackedHead), *kinds = state + size;
    PackedHead head;
    if (given != tlismni_packed_size(m)) {
        return NOT_PACKED;
    }
    memcpy(&head, bytes, sizeof head);
    if (memcmp(head.magic, PACKED_MAGIC, sizeof head.magic) != 0 || head.version != IMAGE_VERSION ||
        head.image != m->head.checksum || head.size != (int64_t)(size + words) ||
        head.checksum != image_checksum(state, size + words)) {
        return NOT_PACKED;
    }
    const uint64_t limits[] = {0, (uint64_t)m->head.own, (uint64_t)m->head.shared, (uint64_t)m->head.functions};
    for (size_t k = 0; k < words; k++) { /* all of it before any of it is taken */
        uint64_t word;
        memcpy(&word, state + sizeof(Beside) + 8 * k, sizeof word);
        if (kinds[k] != NUMBER && ((unsigned char)kinds[k] > OF_LIBRARY || word >= limits[(int)kinds[k]])) {
            return NOT_PACKED;
        }
    }
    memcpy(saved, state, size);
    for (size_t k = 0; k < words; k++) {
        char *place = (char *)saved + sizeof(Beside) + 8 * k;
        uint64_t word;
        memcpy(&word, place, sizeof word);
        if (kinds[k] == OWN) {
            word += (uint64_t)(uintptr_t)run->own;
        } else if (kinds[k] == SHARED) {
            word += (uint64_t)(uintptr_t)m->shared;
        } else if (kinds[k] == OF_LIBRARY) {
            word = (uint64_t)(uintptr_t)m->functions[word];
        }
        memcpy(place, &word, sizeof word);
    }
    return TLISMNI_OK;
}
