#include "resources.h"

#include <stdlib.h>

#include "platform.h"

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
