/* Statuses in words. */

#include "codes.h"
#include "image.h"

#define WITH_PYTHON "; use the FMU that runs with Python, or simulate it there"

/* Those of settling: see `simulation/failures.py`, which knows the contact's name. */
static const char *of_settling(int status) {
    switch (status) {
    case 2:
        return "more contacts touch at once than the image has room for" WITH_PYTHON;
    case 3:
        return "the equations of the contacts that are closed now are larger than the image has room for: prepare it with "
               "a run that meets them" WITH_PYTHON;
    case 10:
        return "the joints depend on one another where contacts strike: start elsewhere, or look at the mechanism in "
               "Python, which names them";
    case 11:
        return "a contact strikes what cannot move: it has neither mass nor freedom there";
    case 12:
        return "no impulses satisfy the laws of the contacts that strike: use PoissonImpact, or fewer contacts";
    case 13:
    case 14:
        return "the impacts at one instant do not come to an end: use a smaller restitution, or forces for contacts";
    case 15:
        return "no forces satisfy the contacts that touch: simulate it in Python, which says what they ask for";
    case 16:
        return "a sliding contact jams (Painleve): use a smaller coefficient of friction, or a force law";
    case 19:
    case 20:
        return "the constraints, those of closed contacts among them, depend on one another here, or the system's matrix is "
               "singular: start elsewhere, or look at the mechanism in Python, which names them";
    case 40:
        return "the run cannot begin: with these parameters the positions at the start violate the constraints beyond repair; "
               "set those that belong together";
    case 41:
        return "the run cannot begin: with these parameters the velocities at the start violate the constraints beyond repair; "
               "set those that belong together";
    case 42:
        return "the run cannot begin: with these parameters shapes of a contact overlap at the start";
    case 43:
        return "the run cannot begin: with these parameters the constraints depend on one another at the start, which is a "
               "singular position";
    case 44:
        return "the run cannot begin: with these parameters there are no accelerations at the start, or the image has no room "
               "for the equations";
    default:
        return "what happens at contacts at this instant cannot be settled: simulate it in Python, which says why";
    }
}

const char *tlismni_why(tlismni_status status) {
    if (status >= SETTLING && status < RAISED) {
        return of_settling(status - SETTLING);
    }
    switch (status) {
    case TLISMNI_OK:
        return "all is well";
    case OUTER_DIVERGED:
    case OUTER_SLOW:
        return "a step's equations cannot be solved, with new pivots and shorter steps either: look for a force that is "
               "not finite or not smooth, use a smaller fixed step or error control";
    case INNER_DIVERGED:
        return "the constraints cannot be met, with new pivots and shorter steps either: the mechanism is at the end of "
               "its reach; change inputs or start";
    case SINGULAR:
    case REANALYZE:
        return "the system's matrix is singular, or its pivots keep degrading, with shorter steps too";
    case NOT_FINITE:
        return "a value has become infinite or NaN: look at inputs and parameters, use smaller steps";
    case STEP_TOO_SMALL:
        return "error control asks for steps shorter than time can resolve: loosen rtol and atol, or look for a force "
               "that jumps or grows without bound";
    case NEAR_SINGULAR:
    case VIOLATED:
        return "the mechanism comes to a singular position, which only Python steps over as yet" WITH_PYTHON;
    case UNLOCATED:
        return "the time of a contact event could not be located, with new pivots and shorter steps either: use smaller "
               "steps, or move the contact a little";
    case DUE:
        return "a force or a driver jumps at a given time, where only Python starts anew as yet" WITH_PYTHON;
    case JAM:
        return "sliding contacts jam (Painleve's paradox): their friction presses the bodies together more than the normal "
               "forces keep them apart, so that rigid bodies have no (or no unique) accelerations: use smaller "
               "coefficients of friction, or force laws";
    case RAISED:
        return "compiled code has raised an error: memory is exhausted, or damaged";
    case NEEDS_EVENT:
        return "a contact force begins or ends, or contact events do not come to an end, which only Python handles as "
               "yet" WITH_PYTHON;
    case NEEDS_ROWS:
        return "the model has redundant constraints, of which only Python chooses those to leave out as yet" WITH_PYTHON;
    case EXCLUDED:
        return "a parameter excludes this one: numbers follow from both of them in a way that the image has only for one of them "
               "with another value than its own (tlismni_excluded_by); let the other one have the value of the image, or make an image with both" WITH_PYTHON;
    case NO_BEGINNING:
        return "a run of this image begins at the time of the image only: it has redundant constraints, of which only Python "
               "chooses those to leave out as yet" WITH_PYTHON;
    case TOO_MANY_STEPS:
        return "the way takes more steps of the solver than it may: ask for a shorter one, allow more, or look for an "
               "input that is out of proportion";
    case HAS_FAILED:
        return "the run has failed before: restore a state, or start another run";
    case WRONG_TIME:
        return "the time is not finite, or before the present one";
    case WRONG_INPUT:
        return "an input is not finite, nor is its derivative, or there is no such input: check what feeds it";
    case INPUT_REFUSED:
        return "no state meets constraints and equations of motion with these inputs: they ask for a position out of "
               "reach, or make a force that is not finite";
    case NOT_READ:
        return "the channels cannot be had at this time (a value is not finite, or the mechanism is near a singular "
               "position): ask at another time" WITH_PYTHON;
    case NOT_RESTORED:
        return "the state is none that this run has had: it is damaged, or of another run (pack it to carry it over)";
    case NOT_PACKED:
        return "the bytes are no packed state of this image, or are damaged";
    case NO_PARAMETER:
        return "the image has no such parameter: tlismni_find gives the number of a name";
    case OUT_OF_RANGE:
        return "the parameter's value is not finite, or outside the range that the image was prepared for: make the image "
               "with a value nearer to it";
    case HAS_BEGUN:
        return "parameters are set before a run goes on, or is looked at: restart it, then set them";
    case NO_DERIVATIVES:
        return "there are no derivatives here: the mechanism is near a singular position, its matrix takes pivots that the "
               "image was not prepared for, or a value is not finite";
    default:
        return "unknown status";
    }
}
