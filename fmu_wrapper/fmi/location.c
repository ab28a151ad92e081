#include "location.h"

#include <stdlib.h>
#include <string.h>

char *text_copy(const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = malloc(size);
    return copy ? memcpy(copy, text, size) : NULL;
}

static int digit(char c) {
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    c |= 0x20;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

char *location_path(const char *location) {
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
        int high = *from == '%' ? digit(from[1]) : -1, low = high >= 0 ? digit(from[2]) : -1;
        *to++ = low >= 0 ? (char)(16 * high + low) : *from;
        from += low >= 0 ? 2 : 0;
    }
    while (to > path + 1 && to[-1] == '/') {
        to--;
    }
    *to = '\0';
    return path;
}
