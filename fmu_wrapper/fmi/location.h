/* Texts and paths. What is given back is to be freed; NULL: there is no memory. */
#ifndef TLISMNI_LOCATION_H
#define TLISMNI_LOCATION_H

/* A copy of a text. */
char *text_copy(const char *text);

/* The path in a file URI, or the text itself if it is none (FMI 3.0 passes paths). */
char *location_path(const char *location);

#endif
