/* Where an FMU's resources are, and what is in them. What is given back is to be freed; NULL: there is none. */
#ifndef TLISMNI_RESOURCES_H
#define TLISMNI_RESOURCES_H

/* A copy of a text. */
char *text_copy(const char *text);

/* The path in a file URI, or the text itself if it is none (FMI 3.0 passes paths). */
char *resources_path(const char *location);

/* The text in a file. */
char *resources_read(const char *path);

#endif
