/* What is in an FMU's resources. What is given back is to be freed; NULL: there is none. */
#ifndef TLISMNI_RESOURCES_H
#define TLISMNI_RESOURCES_H

/* The text in a file. */
char *resources_read(const char *path);

#endif
