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
