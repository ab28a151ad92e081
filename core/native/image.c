/* Images: read, held against this library, laid out in memory. */

#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *symbol;
    Function function;
} Symbol;

/* Written when the library is made: in the order of their names. */
extern const Symbol tlismni_symbols[];
extern const size_t tlismni_symbol_count;
extern const char tlismni_sources[];

Function image_function(const char *symbol) {
    size_t low = 0, high = tlismni_symbol_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        int order = strcmp(symbol, tlismni_symbols[middle].symbol);
        if (order == 0) {
            return tlismni_symbols[middle].function;
        }
        if (order < 0) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return NULL;
}

/* CRC-32, eight bytes at a time: most of the time that it takes to open a large image. */
uint32_t image_checksum(const void *bytes, size_t size) {
    uint32_t table[8][256], sum = 0xffffffffu;
    for (uint32_t k = 0; k < 256; k++) {
        uint32_t x = k;
        for (int bit = 0; bit < 8; bit++) {
            x = (x >> 1) ^ (0xedb88320u & (0u - (x & 1u)));
        }
        table[0][k] = x;
    }
    for (uint32_t k = 0; k < 256; k++) {
        for (int n = 1; n < 8; n++) {
            table[n][k] = (table[n - 1][k] >> 8) ^ table[0][table[n - 1][k] & 0xffu];
        }
    }
    const unsigned char *p = bytes;
    for (; size >= 8; size -= 8, p += 8) {
        uint64_t x;
        memcpy(&x, p, sizeof x); /* of machines whose least byte comes first */
        x ^= sum;
        sum = table[7][x & 0xffu] ^ table[6][x >> 8 & 0xffu] ^ table[5][x >> 16 & 0xffu] ^ table[4][x >> 24 & 0xffu] ^
              table[3][x >> 32 & 0xffu] ^ table[2][x >> 40 & 0xffu] ^ table[1][x >> 48 & 0xffu] ^ table[0][x >> 56];
    }
    for (; size; size--, p++) {
        sum = (sum >> 8) ^ table[0][(sum ^ *p) & 0xffu];
    }
    return ~sum;
}

static tlismni_model *refuse(tlismni_model *model, char *why, size_t room, const char *text) {
    if (why && room) {
        snprintf(why, room, "%s", text);
    }
    tlismni_close(model);
    return NULL;
}

/* The next `size` bytes; NULL if there are not so many left. */
static const void *part(const char **at, const char *end, int64_t size) {
    if (size < 0 || size > end - *at || size % 8) {
        return NULL;
    }
    const void *found = *at;
    *at += size;
    return found;
}

/* `count` texts that stand one after the other, each ended by a zero. */
static bool read_texts(const char *text, int64_t size, int64_t count, const char **found) {
    const char *end = text + size;
    for (int64_t k = 0; k < count; k++) {
        const char *stop = text < end ? memchr(text, 0, (size_t)(end - text)) : NULL;
        if (!stop) {
            return false;
        }
        found[k] = text;
        text = stop + 1;
    }
    return true;
}

static bool inside(const int64_t *places, int64_t count, const char *memory, int64_t size, int64_t limit) {
    for (int64_t k = 0; k < count; k++) {
        if (places[k] < 0 || places[k] >= size / 8 || ((const int64_t *)memory)[places[k]] < 0 ||
            ((const int64_t *)memory)[places[k]] >= limit) {
            return false;
        }
    }
    return true;
}

/* What the shared part points to. */
static void relocate_shared(tlismni_model *m, const int64_t *to_shared, const int64_t *to_function) {
    int64_t *words = (int64_t *)m->shared;
    for (int64_t k = 0; k < m->head.shared_shared; k++) {
        words[to_shared[k]] += (int64_t)(intptr_t)m->shared;
    }
    for (int64_t k = 0; k < m->head.shared_function; k++) {
        words[to_function[k]] = (int64_t)(intptr_t)m->functions[words[to_function[k]]];
    }
}

/* Whether all words of parameters are in the part of a run's memory that has numbers. */
static bool parameters_inside(const tlismni_model *m) {
    for (int64_t k = 0; k < m->head.parameters; k++) {
        const Parameter *p = m->parameters + k;
        if (p->first < 0 || p->count < 0 || p->first > m->head.words || p->count > m->head.words - p->first) {
            return false;
        }
    }
    for (int64_t k = 0; k < m->head.words; k++) {
        const Word *w = m->words + k;
        if (w->place < m->head.tables || w->place > m->head.decisive - 8 || w->place % 8 || w->first < 0 || w->count < 0 ||
            (w->form == SERIES && w->count < 3) ||
            w->first > m->head.coefficients || w->count > m->head.coefficients - w->first) {
            return false;
        }
    }
    for (int64_t k = 0; k < m->head.exclusions; k++) {
        const Exclusion *e = m->exclusions + k;
        if (e->one < 0 || e->one >= m->head.parameters || e->other < 0 || e->other >= m->head.parameters) {
            return false;
        }
    }
    return true;
}

/* Everything behind the head; false if it does not fit together. */
static bool read_body(tlismni_model *m, const char *at, const char *end) {
    const Head *h = &m->head;
    int64_t names, counts[] = {h->shared_shared, h->shared_function, h->own_own, h->own_shared, h->own_function};
    const int64_t *lists[5];
    const void *numbers = part(&at, end, sizeof m->numbers), *places = part(&at, end, sizeof m->places);
    if (!numbers || !places) {
        return false;
    }
    memcpy(&m->numbers, numbers, sizeof m->numbers);
    memcpy(&m->places, places, sizeof m->places);
    for (int k = 0; k < 5; k++) {
        if (counts[k] > h->size || !(lists[k] = part(&at, end, 8 * counts[k]))) {
            return false;
        }
    }
    if (h->parameters < 0 || h->parameters > h->size || h->words < 0 || h->words > h->size ||
        !(m->parameters = part(&at, end, h->parameters * (int64_t)sizeof *m->parameters)) ||
        !(m->words = part(&at, end, h->words * (int64_t)sizeof *m->words)) || h->coefficients < 0 ||
        h->coefficients > h->size || !(m->coefficients = part(&at, end, h->coefficients * (int64_t)sizeof(double))) ||
        h->exclusions < 0 || h->exclusions > h->size ||
        !(m->exclusions = part(&at, end, h->exclusions * (int64_t)sizeof *m->exclusions))) {
        return false;
    }
    const char *function_text = part(&at, end, h->function_text), *text = part(&at, end, h->text_size);
    const char *shared = part(&at, end, h->shared), *own = part(&at, end, h->copied);
    const Numbers *n = &m->numbers;
    if (!function_text || !text || !shared || !own || at != end || h->own < h->copied || h->copied < h->decisive || h->tables > h->decisive ||
        h->tables < 0 || h->tables % 8 || h->functions < CALLED || h->functions > h->size || h->texts > h->size ||
        n->inputs < 0 || n->channels < 0 || n->contacts < 0 || n->inputs + n->channels + n->contacts + h->parameters != h->texts || !parameters_inside(m)) {
        return false;
    }
    const int64_t *place = (const int64_t *)&m->places;
    for (size_t k = 0; k < sizeof m->places / 8; k++) {
        if (place[k] < 0 || place[k] > h->own - 8 || place[k] % 8) {
            return false;
        }
    }
    names = h->functions > h->texts ? h->functions : h->texts;
    m->functions = malloc((size_t)h->functions * sizeof *m->functions);
    m->texts = malloc((size_t)(names ? names : 1) * sizeof *m->texts);
    m->room = malloc((size_t)h->shared + ALIGNED);
    if (!m->functions || !m->texts || !m->room || !read_texts(function_text, h->function_text, h->functions, m->texts)) {
        return false;
    }
    for (int64_t k = 0; k < h->functions; k++) {
        if (!(m->functions[k] = image_function(m->texts[k]))) {
            return false;
        }
    }
    m->shared = (char *)(((uintptr_t)m->room + ALIGNED - 1) / ALIGNED * ALIGNED);
    memcpy(m->shared, shared, (size_t)h->shared);
    m->own_bytes = own;
    m->own_own = lists[2], m->own_shared = lists[3], m->own_function = lists[4];
    if (!read_texts(text, h->text_size, h->texts, m->texts) ||
        !inside(lists[0], counts[0], m->shared, h->shared, h->shared) ||
        !inside(lists[1], counts[1], m->shared, h->shared, h->functions) ||
        !inside(lists[2], counts[2], own, h->tables, h->own) || !inside(lists[3], counts[3], own, h->tables, h->shared) ||
        !inside(lists[4], counts[4], own, h->tables, h->functions)) {
        return false;
    }
    relocate_shared(m, lists[0], lists[1]);
    return true;
}

const char *tlismni_c_digest(void) {
    return tlismni_sources;
}

tlismni_model *tlismni_read_image(const void *bytes, size_t size, char *why, size_t room) {
    const size_t start = sizeof IMAGE_MAGIC - 1 + DIGEST_BYTES + SOURCES_BYTES;
    tlismni_model *m = calloc(1, sizeof *m);
    if (!m || !(m->bytes = malloc(size ? size : 1))) {
        return refuse(m, why, room, "there is no memory left for the image");
    }
    memcpy(m->bytes, bytes, size);
    if (size < start + sizeof m->head || memcmp(m->bytes, IMAGE_MAGIC, sizeof IMAGE_MAGIC - 1) != 0) {
        return refuse(m, why, room, "these bytes are no image of a model (tlismni.core.native.native_image makes one)");
    }
    const char *digest = m->bytes + sizeof IMAGE_MAGIC - 1;
    if (strncmp(digest, tlismni_digest, DIGEST_BYTES) != 0 || strncmp(digest + DIGEST_BYTES, tlismni_sources, SOURCES_BYTES) != 0) {
        return refuse(m, why, room, "the image was made with another version of this library: make it anew, or use that "
                                    "library (an FMU carries its own)");
    }
    memcpy(&m->head, m->bytes + start, sizeof m->head);
    const char *body = m->bytes + start + sizeof m->head;
    if (m->head.version != IMAGE_VERSION || m->head.size != (int64_t)size ||
        m->head.checksum != image_checksum(body, size - start - sizeof m->head)) {
        return refuse(m, why, room, "the image is damaged or cut off: copy it again");
    }
    if (!read_body(m, body, m->bytes + size)) {
        return refuse(m, why, room, "the image does not fit together, or there is no memory left for it: make it anew");
    }
    return m;
}

tlismni_model *tlismni_open(const char *path, char *why, size_t room) {
    FILE *file = path ? fopen(path, "rb") : NULL;
    if (!file) {
        return refuse(NULL, why, room, "the image cannot be read: there is no such file, or it may not be opened");
    }
    long size = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    char *bytes = size >= 0 ? malloc((size_t)size + 1) : NULL;
    tlismni_model *model = NULL;
    if (bytes && fseek(file, 0, SEEK_SET) == 0 && fread(bytes, 1, (size_t)size, file) == (size_t)size) {
        model = tlismni_read_image(bytes, (size_t)size, why, room);
    } else {
        refuse(NULL, why, room, "the image cannot be read");
    }
    free(bytes);
    fclose(file);
    return model;
}

void tlismni_close(tlismni_model *model) {
    if (model) {
        free(model->functions);
        free(model->texts);
        free(model->room);
        free(model->bytes);
        free(model);
    }
}

/* First name of a kind, and how many there are. */
static size_t names_of(const tlismni_model *m, tlismni_kind kind, size_t *count) {
    const Numbers *n = &m->numbers;
    switch (kind) {
    case TLISMNI_INPUT:
        *count = (size_t)n->inputs;
        return 0;
    case TLISMNI_CHANNEL:
        *count = (size_t)n->channels;
        return (size_t)n->inputs;
    case TLISMNI_CONTACT:
        *count = (size_t)n->contacts;
        return (size_t)(n->inputs + n->channels);
    case TLISMNI_PARAMETER:
        *count = (size_t)m->head.parameters;
        return (size_t)(n->inputs + n->channels + n->contacts);
    }
    *count = 0;
    return 0;
}

size_t tlismni_count(const tlismni_model *model, tlismni_kind kind) {
    size_t count;
    names_of(model, kind, &count);
    return count;
}

const char *tlismni_name(const tlismni_model *model, tlismni_kind kind, size_t number) {
    size_t count, first = names_of(model, kind, &count);
    return number < count ? model->texts[first + number] : NULL;
}

long tlismni_find(const tlismni_model *model, tlismni_kind kind, const char *name) {
    size_t count, first = names_of(model, kind, &count);
    for (size_t k = 0; name && k < count; k++) {
        if (strcmp(model->texts[first + k], name) == 0) {
            return (long)k;
        }
    }
    return -1;
}
