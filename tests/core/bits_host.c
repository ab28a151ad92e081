/* The channels of an image on a grid, bit by bit: bits_host <image> <end> <points> [parameter=value ...]
 *
 * Written for any processor: what one prints another has to print. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tlismni.h"

int main(int count, char **argument) {
    char why[500] = "";
    tlismni_model *model = tlismni_open(argument[1], why, sizeof why);
    tlismni_run *run = model ? tlismni_start(model) : NULL;
    if (!run) {
        fprintf(stderr, "%s\n", why);
        return 1;
    }
    for (int k = 4; k < count; k++) {
        char *value = strchr(argument[k], '=');
        *value = '\0';
        long number = tlismni_find(model, TLISMNI_PARAMETER, argument[k]);
        if (number < 0 || tlismni_set_parameter(run, (size_t)number, atof(value + 1))) {
            fprintf(stderr, "no parameter %s of this value\n", argument[k]);
            return 1;
        }
    }
    double end = atof(argument[2]);
    long points = atol(argument[3]);
    size_t channels = tlismni_count(model, TLISMNI_CHANNEL);
    for (long k = 0; k <= points; k++) {
        tlismni_status status = k ? tlismni_step(run, end * (double)k / (double)points, true) : tlismni_look(run);
        if (status) {
            printf("%ld %d %s\n", k, status, tlismni_why(status));
            break;
        }
        for (size_t i = 0; i < channels; i++) {
            unsigned long long bits;
            memcpy(&bits, tlismni_channels(run) + i, sizeof bits);
            printf("%016llx ", bits);
        }
        printf("%lld\n", (long long)tlismni_event_count(run));
    }
    tlismni_end(run);
    tlismni_close(model);
    return 0;
}
