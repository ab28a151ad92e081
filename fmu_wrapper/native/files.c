#include "files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "open_file.h"

#define VARIABLES_MAGIC "TLISVARS"

/* What stands before the variables (`variable_file.py`). */
typedef struct {
    char magic[8];
    int64_t version, count;
    double rtol;
    char token[64];
} VariablesHead;

char *files_copy(const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = malloc(size);
    return copy ? memcpy(copy, text, size) : NULL;
}

static int hex_digit(char c) {
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    c |= 0x20;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

char *files_folder(const char *location) {
    char *path = location ? files_copy(location) : NULL;
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
        int high = *from == '%' ? hex_digit(from[1]) : -1, low = high >= 0 ? hex_digit(from[2]) : -1;
        *to++ = low >= 0 ? (char)(16 * high + low) : *from;
        from += low >= 0 ? 2 : 0;
    }
    while (to > path + 1 && to[-1] == '/') {
        to--;
    }
    *to = '\0';
    return path;
}

void *files_read(const char *path, size_t *size) {
    FILE *file = open_file(path);
    long length = file && fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    char *bytes = length >= 0 ? malloc((size_t)length + 1) : NULL;
    if (bytes && (fseek(file, 0, SEEK_SET) != 0 || fread(bytes, 1, (size_t)length, file) != (size_t)length)) {
        free(bytes);
        bytes = NULL;
    }
    if (file) {
        fclose(file);
    }
    *size = bytes ? (size_t)length : 0;
    return bytes;
}

bool files_variables(Slave *slave, size_t size, const char *token, char *why, size_t room) {
    const VariablesHead *head = slave->file;
    if (size < sizeof *head || memcmp(head->magic, VARIABLES_MAGIC, sizeof head->magic) != 0 || head->version != 1 ||
        head->count < 0 || (size - sizeof *head) / sizeof(Variable) != (size_t)head->count ||
        memchr(head->token, 0, sizeof head->token) == NULL) {
        snprintf(why, room, "the FMU's list of variables is damaged: export the FMU anew");
        return false;
    }
    if (strcmp(head->token, token) != 0) {
        snprintf(why, room, "the token is '%.60s', this FMU has '%s': take the one in its modelDescription.xml", token,
                 head->token);
        return false;
    }
    slave->variables = (const Variable *)(head + 1);
    slave->count = (size_t)head->count;
    slave->rtol = head->rtol;
    return true;
}
