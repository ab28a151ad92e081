/* Where an FMU's resources are, for both kinds of FMU: copies of texts and file URIs. Header only: the library of machine
 * code and the shim are built apart. What is given back is to be freed; NULL: there is no memory. */
#ifndef TLISMNI_LOCATION_H
#define TLISMNI_LOCATION_H

#include <stdlib.h>
#include <string.h>

/* A copy of a text. */
static inline char *text_copy(const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = malloc(size);
    return copy ? memcpy(copy, text, size) : NULL;
}

static inline int location_digit(char c) {
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    c |= 0x20;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* The path in a file URI, or the text itself if it is none (FMI 3.0 passes paths). */
static inline char *location_path(const char *location) {
    char *path = text_copy(location);
    if (!path || strncmp(location, "file:", 5) != 0) {
        return path;
    }
    const char *from = location + 5;
    if (from[0] == '/' && from[1] == '/') {
        from += 2;
        from += strcspn(from, "/"); /* the host, empty or localhost */
    }
#ifdef _WIN32
    if (from[0] == '/' && from[1] && from[2] == ':') {
        from++;
    }
#endif
    char *to = path;
    for (; *from; from++) {
        int high = *from == '%' ? location_digit(from[1]) : -1, low = high >= 0 ? location_digit(from[2]) : -1;
        *to++ = low >= 0 ? (char)(16 * high + low) : *from;
        from += low >= 0 ? 2 : 0;
    }
    while (to > path + 1 && to[-1] == '/') {
        to--;
    }
    *to = '\0';
    return path;
}

#endif
