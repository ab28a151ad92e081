/* The FMU's resources. */
#ifndef TLISMNI_FILES_H
#define TLISMNI_FILES_H

#include "slave.h"

/* The bytes of a file, to be freed; NULL if it cannot be read. */
void *files_read(const char *path, size_t *size);

/* Take the variables from `slave->file`; false, with the reason in `why`, if they are none or `token` is another FMU's. */
bool files_variables(Slave *slave, size_t size, const char *token, char *why, size_t room);

#endif
