/* Files by paths in UTF-8, apart from all else: what Windows declares for it has names like ours. */
#ifndef TLISMNI_OPEN_FILE_H
#define TLISMNI_OPEN_FILE_H

#include <stdio.h>

/* Open a file for reading; NULL if that is not possible. */
FILE *open_file(const char *path);

#endif
