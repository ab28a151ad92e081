#include "files.h"

#include <stdlib.h>

#ifdef _WIN32
#include <windows.h>

FILE *files_open(const char *path) {
    wchar_t wide[4096];
    return MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, 4096) ? _wfopen(wide, L"rb") : NULL;
}
#else
FILE *files_open(const char *path) {
    return fopen(path, "rb");
}
#endif

void *files_read(const char *path, size_t *size) {
    FILE *file = files_open(path);
    long length = file && fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    char *bytes = length >= 0 ? malloc((size_t)length + 1) : NULL;
    if (bytes && (fseek(file, 0, SEEK_SET) != 0 || fread(bytes, 1, (size_t)length, file) != (size_t)length)) {
        free(bytes);
        bytes = NULL;
    }
    if (file) {
        fclose(file);
    }
    if (bytes) {
        bytes[length] = '\0';
    }
    if (size) {
        *size = bytes ? (size_t)length : 0;
    }
    return bytes;
}
