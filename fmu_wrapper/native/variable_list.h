/* The list of variables among the FMU's resources (variables.bin, written by `native_export.variables_file`). */
#ifndef TLISMNI_VARIABLE_LIST_H
#define TLISMNI_VARIABLE_LIST_H

#include "native_slave.h"

/* Take the variables from `slave->file`; false, with the reason in `why`, if they are none or `token` is another FMU's. */
bool native_take_variables(Slave *slave, size_t size, const char *token, char *why, size_t room);

#endif
