/* Parameters: words of a run's memory that follow from numbers of the model (`parameters.py`, `forms.py`). */

#include "codes.h"
#include "image.h"

#include <math.h>
#include <string.h>

/* A sum of Chebyshev polynomials of `p` between two limits, which come first, by Clenshaw's recurrence. */
static double series_of(const double *c, int64_t count, double p) {
    double x = (2.0 * p - (c[0] + c[1])) / (c[1] - c[0]), last = 0.0, before = 0.0;
    c += 2;
    for (int64_t k = count - 3; k > 0; k--) {
        double next = 2.0 * x * last - before + c[k];
        before = last;
        last = next;
    }
    return x * last - before + c[0];
}

/* What a word is for the value `p`; each operation rounds once, as in Python. */
static double word_of(const tlismni_model *model, const Word *word, double p) {
    double c = word->constant, u = p;
    if (word->form == SERIES) {
        return series_of(model->coefficients + word->first, word->count, p);
    }
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
    case 7:
        u = p * p;
        u = u * p;
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

/* The word at a place that follows from a parameter, whose words are sorted by place; NULL if it does not. */
static const Word *word_at(const tlismni_model *m, const Parameter *p, int64_t place) {
    int64_t low = p->first, high = p->first + p->count;
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        if (m->words[middle].place < place) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < p->first + p->count && m->words[low].place == place ? m->words + low : NULL;
}

/* What parameters that have other values than those of the image make of a word that several lead. */
static double of_several(const tlismni_run *run, const Word *word) {
    const tlismni_model *m = run->model;
    double own, found;
    memcpy(&own, m->own_bytes + word->place, sizeof own);
    found = own;
    int count = 0;
    for (int64_t k = 0; k < m->head.parameters; k++) {
        double value = REALS(run, parameters)[k];
        const Word *here = value != m->parameters[k].value ? word_at(m, m->parameters + k, word->place) : NULL;
        if (here) {
            double one = word_of(m, here, value);
            found = !count++ ? one : word->mode == PRODUCT ? found * (one / own) : found + (one - own);
        }
    }
    return found;
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

size_t tlismni_excluded_by(const tlismni_run *run, size_t number) {
    const tlismni_model *m = run->model;
    for (int64_t k = 0; k < m->head.exclusions; k++) {
        const Exclusion *e = m->exclusions + k;
        if (e->one == (int64_t)number && REALS(run, parameters)[e->other] != m->parameters[e->other].value) {
            return (size_t)e->other;
        }
    }
    return (size_t)m->head.parameters;
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
    double *values = REALS(run, parameters);
    if (value == values[number]) {
        return TLISMNI_OK;
    }
    if (value != p->value && tlismni_excluded_by(run, number) < (size_t)run->model->head.parameters) {
        return EXCLUDED;
    }
    values[number] = value;
    const Word *word = run->model->words + p->first;
    for (int64_t k = 0; k < p->count; k++, word++) {
        double *at = (double *)(run->own + word->place);
        *at = word->mode == ALONE && value != p->value ? word_of(run->model, word, value) : of_several(run, word);
    }
    run->beside.stale = run->beside.stale || p->begins;
    return TLISMNI_OK;
}

tlismni_status tlismni_start_at(tlismni_run *run, double t) {
    if (!isfinite(t)) {
        return WRONG_TIME;
    }
    if (run->beside.begun) {
        return HAS_BEGUN;
    }
    if (!run->model->numbers.begins) {
        return t == run->model->numbers.start ? TLISMNI_OK : NO_BEGINNING;
    }
    REALS(run, begin_numbers)[T0] = t;
    run->beside.now = t;
    run->beside.stale = 1;
    return TLISMNI_OK;
}

double tlismni_start_time(const tlismni_run *run) {
    return REALS(run, begin_numbers)[T0];
}
