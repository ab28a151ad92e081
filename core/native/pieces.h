/* Small pieces of memory for compiled code (`module.py`), from a stack of the thread. */
#ifndef TLISMNI_PIECES_H
#define TLISMNI_PIECES_H

#include <stddef.h>
#include <stdint.h>

void *tlismni_take(int64_t size);
void tlismni_give(void *given);

/* Have the stack of this thread. */
void pieces_touch(void);

#endif
