/* Memory for the small arrays that compiled code makes and gives back within a call: a stack of the thread, so that
 * steps take nothing from `malloc`. What does not fit comes from there. */

#include "pieces.h"

#include <stdint.h>
#include <stdlib.h>

enum { ROOM = 1 << 16, HEAD = 16, UNIT = 16 };

#if defined _MSC_VER
#define OF_THREAD __declspec(thread)
#else
#define OF_THREAD __thread
#endif

static OF_THREAD struct {
    _Alignas(UNIT) char room[ROOM];
    size_t used, count; /* bytes, and pieces that are taken */
} stack;

/* Before each piece: its size, 0 for one of `malloc`. */

void *tlismni_take(int64_t size) {
    size_t whole = HEAD + ((size_t)size + UNIT - 1) / UNIT * UNIT;
    char *piece;
    if (size >= 0 && whole <= ROOM - stack.used) {
        piece = stack.room + stack.used;
        *(size_t *)(void *)piece = whole;
        stack.used += whole;
        stack.count++;
    } else if ((piece = malloc(whole))) {
        *(size_t *)(void *)piece = 0;
    }
    return piece ? piece + HEAD : NULL;
}

void tlismni_give(void *given) {
    char *piece = given ? (char *)given - HEAD : NULL;
    if (!piece) {
        return;
    }
    size_t whole = *(size_t *)(void *)piece;
    if (!whole) {
        free(piece);
        return;
    }
    if (--stack.count == 0) {
        stack.used = 0;
    } else if (piece + whole == stack.room + stack.used) {
        stack.used -= whole;
    }
}

void pieces_touch(void) {
    /* where the system makes a thread's memory when it is first used, that is now */
    *(volatile size_t *)&stack.count = stack.count;
}
