#include "sim_host/cli/person_fit.h"

#include <math.h>

/* A found event further from an edge belongs to another step. */
static const double APART_S = 0.15;
static const double BIAS_MOST_S = 0.08;
static const double ERROR_LEAST_S = 0.02;

struct mean {
    double mean_s;
    double most_off_s; /* largest difference from it */
    unsigned count;
};

/* The found event next to a moment, as difference; NaN without one near. */
static double difference_s(const struct gait_moments *found, double edge_s)
{
    double best_s = (double)NAN;
    for (size_t i = 0; i < found->count; i++) {
        const double off_s = found->at[i].event_s - edge_s;
        if (fabs(off_s) < APART_S && !(fabs(off_s) >= fabs(best_s))) {
            best_s = off_s;
        }
    }
    return best_s;
}

static struct mean mean_of(const struct gait_moments *found, const struct gait_moments *edges)
{
    double off_s[PERSON_FIT_EDGES];
    struct mean mean = {0.0, 0.0, 0};
    for (size_t i = 0; i < edges->count && mean.count < PERSON_FIT_EDGES; i++) {
        const double off = difference_s(found, edges->at[i].event_s);
        if (!isnan(off)) {
            off_s[mean.count++] = off;
            mean.mean_s += off;
        }
    }
    mean.mean_s = mean.count > 0 ? mean.mean_s / mean.count : 0.0;
    for (unsigned i = 0; i < mean.count; i++) {
        mean.most_off_s = fmax(mean.most_off_s, fabs(off_s[i] - mean.mean_s));
    }
    return mean;
}

bool person_fit_make(const struct gait_record *record, const struct control_params *params,
                     struct person_fit *fit)
{
    const double strike_before_s[] = {(double)params->strike_bias_left_s,
                                      (double)params->strike_bias_right_s};
    const double toe_off_before_s[] = {(double)params->toe_off_bias_left_s,
                                       (double)params->toe_off_bias_right_s};
    bool within = true;
    *fit = (struct person_fit){.edges = PERSON_FIT_EDGES};
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct mean strike =
            mean_of(&record->seen[side][GAIT_HEEL_STRIKE], &record->switch_closed[side]);
        const struct mean toe_off =
            mean_of(&record->seen[side][GAIT_LIFT_OFF], &record->switch_opened[side]);
        fit->strike_bias_s[side] = strike_before_s[side] + strike.mean_s;
        fit->toe_off_bias_s[side] = toe_off_before_s[side] + toe_off.mean_s;
        fit->strike_error_s = fmax(fit->strike_error_s, strike.most_off_s + PERSON_FIT_MARGIN_S);
        fit->edges = strike.count < fit->edges ? strike.count : fit->edges;
        fit->edges = toe_off.count < fit->edges ? toe_off.count : fit->edges;
        within = within && fabs(fit->strike_bias_s[side]) <= BIAS_MOST_S &&
                 fabs(fit->toe_off_bias_s[side]) <= BIAS_MOST_S;
    }
    fit->strike_error_s = fmax(fit->strike_error_s, ERROR_LEAST_S);
    return within && fit->edges >= PERSON_FIT_LEAST;
}

void person_fit_write(FILE *stream, const struct person_fit *fit, const struct person *person)
{
    struct person fitted = *person;
    person_override(&fitted, "strike_bias_left_s", fit->strike_bias_s[SIDE_LEFT]);
    person_override(&fitted, "strike_bias_right_s", fit->strike_bias_s[SIDE_RIGHT]);
    person_override(&fitted, "toe_off_bias_left_s", fit->toe_off_bias_s[SIDE_LEFT]);
    person_override(&fitted, "toe_off_bias_right_s", fit->toe_off_bias_s[SIDE_RIGHT]);
    person_write(stream, &fitted);
    fprintf(
        stream,
        "; Learned from %u edges of each foot's switch. The largest error of a strike in that run, and a\n"
        "; margin: %.4f s. As strike_error_s it allows assistance without switches; nothing tells\n"
        "; running from walking then.\n",
        fit->edges, fit->strike_error_s);
}
