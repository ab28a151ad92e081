/* Files by paths in UTF-8, apart from all else: what Windows declares for it has names like ours. */
#ifndef TLISMNI_FILES_H
#define TLISMNI_FILES_H

#include <stdio.h>

/* Open a file for reading; NULL if that is not possible. */
FILE *files_open(const char *path);

/* The bytes of a file, and a zero behind them, to be freed; NULL if it cannot be read. `size` may be NULL. */
void *files_read(const char *path, size_t *size);

#endif
