#include "open_file.h"

#ifdef _WIN32
#include <windows.h>

FILE *open_file(const char *path) {
    wchar_t wide[4096];
    return MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, 4096) ? _wfopen(wide, L"rb") : NULL;
}
#else
FILE *open_file(const char *path) {
    return fopen(path, "rb");
}
#endif
