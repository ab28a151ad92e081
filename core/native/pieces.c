/* Memory for the small arrays that compiled code makes and gives back within a call: a stack of the thread, so that
 * steps take nothing from `malloc`. What does not fit comes from there. */

#include "pieces.h"

#include <stdint.h>
#include <stdlib.h>

enum { ROOM = 1 << 16, UNIT = 16 };

#if defined _MSC_VER
#define OF_THREAD __declspec(thread)
#else
#define OF_THREAD __thread
#endif

/* Before each piece. */
typedef struct {
    size_t before; /* where the piece below begins; OF_MALLOC: it is none of the stack */
    size_t given;  /* 1: given back, but pieces above it are not */
} Head;
enum { HEAD = sizeof(Head) };
#define OF_MALLOC SIZE_MAX

static OF_THREAD struct {
    _Alignas(UNIT) char room[ROOM];
    size_t used, top; /* bytes, and where the uppermost piece begins */
} stack;

static Head *head_at(size_t place) {
    return (Head *)(void *)(stack.room + place);
}

void *tlismni_take(int64_t size) {
    size_t whole = HEAD + ((size_t)size + UNIT - 1) / UNIT * UNIT;
    Head *head;
    if (size >= 0 && whole <= ROOM - stack.used) {
        head = head_at(stack.used);
        *head = (Head){stack.top, 0};
        stack.top = stack.used;
        stack.used += whole;
    } else if ((head = malloc(whole))) {
        *head = (Head){OF_MALLOC, 0};
    }
    return head ? head + 1 : NULL;
}

void tlismni_give(void *piece) {
    Head *head = piece ? (Head *)piece - 1 : NULL;
    if (!head) {
        return;
    }
    if (head->before == OF_MALLOC) {
        free(head);
        return;
    }
    head->given = 1;
    while (stack.used && head_at(stack.top)->given) {
        stack.used = stack.top;
        stack.top = head_at(stack.top)->before;
    }
}

void pieces_touch(void) {
    /* where the system makes a thread's memory when it is first used, that is now */
    *(volatile size_t *)&stack.used = stack.used;
}
