/* States: copies of what decides the future of a run, and the same for other runs and processes.
 *
 * A state is Beside, the numbers of the run's memory in normal form (`simulation/normal_form.py`), and what of the matrices decides
 * (`assembly/matrix_state.py`). It has no addresses: records and structures stay as they are in the run, or are built again.
 * In front goes what has been counted so far, which decides nothing: behind it, bytes of two states are equal exactly if the
 * futures are. */

#include "codes.h"
#include "image.h"

#include <stdbool.h>
#include <string.h>

#define PACKED_MAGIC "TLISTATE"

typedef struct {
    int64_t size; /* bytes of the state, this head too */
    Counters counted;
    Noted noted;
    Beside beside;
} Saved;

/* What stands before a packed state. */
typedef struct {
    char magic[8];
    int64_t version, image, checksum, size;
} PackedHead;

/* Calls of compiled code follow numba's convention: places of the result and of what is raised come first. */
typedef int32_t (*OfWorkspace)(int64_t *result, void **raised, void *workspace);
typedef int32_t (*Save)(int64_t *result, void **raised, void *workspace, int64_t at);
typedef int32_t (*Normalise)(bool *result, void **raised, void *exchange, int64_t shift);
typedef int32_t (*Restore)(int64_t *result, void **raised, void *workspace, int64_t at, int64_t anew);

static size_t numbers_size(const tlismni_model *m) {
    return (size_t)(m->head.decisive - m->head.tables);
}

static void *workspace_of(const tlismni_run *run) {
    return run->own + run->model->places.workspace;
}

size_t tlismni_state_size(const tlismni_model *m) {
    return sizeof(Saved) + numbers_size(m) + 8 * (size_t)m->numbers.matrix_words;
}

size_t tlismni_saved_size(const tlismni_run *run) {
    int64_t words = 0;
    void *raised = NULL;
    ((OfWorkspace)run->model->functions[MATRIX_WORDS])(&words, &raised, workspace_of(run));
    return sizeof(Saved) + numbers_size(run->model) + 8 * (size_t)words;
}

void tlismni_save(const tlismni_run *run, void *bytes) {
    const tlismni_model *m = run->model;
    Saved *saved = bytes;
    char *numbers = (char *)(saved + 1), *matrices = numbers + numbers_size(m);
    int64_t words = 0;
    bool done = false;
    void *raised = NULL;
    memcpy(numbers, run->own + m->head.tables, numbers_size(m));
    ((Normalise)m->functions[NORMALISE])(&done, &raised, run->own + m->places.exchange,
                                         (int64_t)(numbers - (run->own + m->head.tables)));
    ((Save)m->functions[SAVE_MATRICES])(&words, &raised, workspace_of(run), (int64_t)(intptr_t)matrices);
    saved->size = matrices + 8 * words - (char *)bytes;
    saved->beside = run->beside;
    saved->noted = run->noted;
    saved->counted = *COUNTERS(run);
}

tlismni_status tlismni_restore(tlismni_run *run, const void *bytes) {
    const tlismni_model *m = run->model;
    const Saved *saved = bytes;
    const char *numbers = (const char *)(saved + 1), *matrices = numbers + numbers_size(m);
    int64_t how = 0, anew = saved->noted.beginning != run->noted.beginning;
    void *raised = NULL;
    run->beside = saved->beside;
    run->noted = saved->noted;
    *COUNTERS(run) = saved->counted;
    memcpy(run->own + m->head.tables, numbers, numbers_size(m));
    int32_t code = ((Restore)m->functions[RESTORE_MATRICES])(&how, &raised, workspace_of(run), (int64_t)(intptr_t)matrices, anew);
    if (code != 0 || (how != KEPT && how != BUILT)) {
        run->beside.failed = 1;
        run->noted.beginning = ++run->beginnings;
        return NOT_RESTORED;
    }
    if (how == BUILT) { /* which has forgotten what was known of other matrices */
        memcpy(run->own + m->head.tables, numbers, numbers_size(m));
    }
    return TLISMNI_OK;
}

size_t tlismni_packed_size(const void *saved) {
    return sizeof(PackedHead) + (size_t)((const Saved *)saved)->size;
}

tlismni_status tlismni_pack(const tlismni_run *run, const void *saved, void *bytes) {
    int64_t size = ((const Saved *)saved)->size;
    char *state = (char *)bytes + sizeof(PackedHead);
    memcpy(state, saved, (size_t)size);
    memset(state + offsetof(Saved, noted.beginning), 0, sizeof(int64_t)); /* says something in this run only */
    PackedHead head = {{0}, IMAGE_VERSION, run->model->head.checksum, image_checksum(state, (size_t)size), size};
    memcpy(head.magic, PACKED_MAGIC, sizeof head.magic);
    memcpy(bytes, &head, sizeof head);
    return TLISMNI_OK;
}

tlismni_status tlismni_unpack(tlismni_run *run, const void *bytes, size_t given, void *saved) {
    const tlismni_model *m = run->model;
    const char *state = (const char *)bytes + sizeof(PackedHead);
    PackedHead head;
    Saved first;
    int64_t words;
    size_t least = sizeof first + numbers_size(m) + sizeof words;
    if (given < sizeof head + least || given > sizeof head + tlismni_state_size(m)) {
        return NOT_PACKED;
    }
    memcpy(&head, bytes, sizeof head);
    memcpy(&first, state, sizeof first);
    memcpy(&words, state + least - sizeof words, sizeof words);
    if (memcmp(head.magic, PACKED_MAGIC, sizeof head.magic) != 0 || head.version != IMAGE_VERSION ||
        head.image != m->head.checksum || head.size != (int64_t)(given - sizeof head) || first.size != head.size ||
        (uint64_t)words != (given - sizeof head - least) / 8 + 1 || head.size % 8 ||
        head.checksum != image_checksum(state, given - sizeof head)) {
        return NOT_PACKED;
    }
    first.noted.beginning = ++run->beginnings;
    memcpy(saved, state, given - sizeof head);
    memcpy(saved, &first, sizeof first);
    return TLISMNI_OK;
}
