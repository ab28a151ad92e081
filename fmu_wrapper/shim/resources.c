#include "resources.h"

#include <stdlib.h>
#include <string.h>

#include "platform.h"

char *text_copy(const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = malloc(size);
    if (copy) {
        memcpy(copy, text, size);
    }
    return copy;
}

static int hex_digit(char c) {
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    c |= 0x20;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

char *resources_path(const char *location) {
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
        int high = *from == '%' ? hex_digit(from[1]) : -1;
        int low = high >= 0 ? hex_digit(from[2]) : -1;
        *to++ = low >= 0 ? (char)(16 * high + low) : *from;
        from += low >= 0 ? 2 : 0;
    }
    while (to > path + 1 && to[-1] == '/') {
        to--;
    }
    *to = '\0';
    return path;
}

char *resources_read(const char *path) {
    FILE *file = platform_open(path);
    char *text = NULL;
    if (file && fseek(file, 0, SEEK_END) == 0) {
        long size = ftell(file);
        rewind(file);
        text = size >= 0 ? malloc((size_t)size + 1) : NULL;
        if (text && fread(text, 1, (size_t)size, file) != (size_t)size) {
            free(text);
            text = NULL;
        }
        if (text) {
            text[size] = '\0';
        }
    }
    if (file) {
        fclose(file);
    }
    return text;
}
