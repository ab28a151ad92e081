/* Parameters: words of a run's memory that follow from numbers of the model (`parameters.py`, `forms.py`). */

#include "codes.h"
#include "image.h"

#include <math.h>

/* What a word is for the value `p`; each operation rounds once, as in Python. */
static double word_of(const Word *word, double p) {
    double c = word->constant, u = p;
    switch (word->form / 8) {
    case 1:
        u = -p;
        break;
    case 2:
        u = p * p;
        break;
    case 3:
        u = sqrt(p);
        break;
    case 4:
        u = 1.0 - p;
        break;
    case 5:
        u = 1.0 + p;
        break;
    case 6:
        u = p * p;
        u = 1.0 - u;
        break;
    default:
        break;
    }
    switch (word->form % 8) {
    case 1:
        return u * c;
    case 2:
        return u / c;
    case 3:
        return c / u;
    case 4:
        return u + c;
    case 5:
        return c - u;
    default:
        return u;
    }
}

static const Parameter *find(const tlismni_model *m, size_t number) {
    return number < (size_t)m->head.parameters ? m->parameters + number : NULL;
}

double tlismni_parameter(const tlismni_run *run, size_t number) {
    return find(run->model, number) ? REALS(run, parameters)[number] : (double)NAN;
}

tlismni_status tlismni_parameter_range(const tlismni_model *model, size_t number, double *least, double *largest) {
    const Parameter *p = find(model, number);
    if (!p) {
        return NO_PARAMETER;
    }
    *least = p->least;
    *largest = p->largest;
    return TLISMNI_OK;
}

tlismni_status tlismni_set_parameter(tlismni_run *run, size_t number, double value) {
    const Parameter *p = find(run->model, number);
    if (!p) {
        return NO_PARAMETER;
    }
    if (!(value >= p->least && value <= p->largest)) {
        return OUT_OF_RANGE;
    }
    if (run->beside.begun) {
        return HAS_BEGUN;
    }
    const Word *word = run->model->words + p->first;
    for (int64_t k = 0; k < p->count; k++, word++) {
        *(double *)(run->own + word->place) = word_of(word, value);
    }
    REALS(run, parameters)[number] = value;
    return TLISMNI_OK;
}
