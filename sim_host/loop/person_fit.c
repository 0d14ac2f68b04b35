#include "sim_host/loop/person_fit.h"

#include <math.h>
#include <string.h>

#include "sim_host/subjects/ini.h"

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

static const char *const KEYS[] = {"strike_bias_left_s", "strike_bias_right_s",
                                   "toe_off_bias_left_s", "toe_off_bias_right_s"};
enum { KEYS_COUNT = sizeof KEYS / sizeof KEYS[0] };

static bool is_of_a_fit(const char *line)
{
    const char *text = line + strspn(line, " \t");
    for (int i = 0; i < KEYS_COUNT; i++) {
        const size_t length = strlen(KEYS[i]);
        if (strncmp(text, KEYS[i], length) == 0 && strchr(" \t=", text[length]) != NULL) {
            return true;
        }
    }
    return false;
}

static int copy_file(FILE *stream, const char *path)
{
    char line[INI_LINE_MAX];
    FILE *base = fopen(path, "r");
    if (base == NULL) {
        return -1;
    }
    while (fgets(line, sizeof line, base) != NULL) {
        if (!is_of_a_fit(line)) {
            fputs(line, stream);
        }
    }
    const bool failed = ferror(base) != 0;
    return fclose(base) == 0 && !failed ? 0 : -1;
}

static void write_subject(FILE *stream, const struct subject *subject)
{
    fprintf(stream,
            "[subject]\nname = %s\n\n"
            "[walker]\nM = %.9g\nm = %.9g\nl = %.9g\nk = %.9g\ng = %.9g\n\n"
            "[sea]\nstroke_max_m = %.9g\nspeed_max_m_s = %.9g\nforce_max_N = %.9g\n"
            "counts_per_m = %.9g\n",
            subject->name, subject->torso_mass_kg, subject->leg_mass_kg, subject->leg_length_m,
            subject->spring_N_per_m, subject->gravity_m_s2, subject->stroke_max_m,
            subject->speed_max_m_s, subject->force_max_N, subject->counts_per_m);
}

int person_fit_write(FILE *stream, const struct person_fit *fit, const char *base_path,
                     const struct subject *subject)
{
    const double values_s[KEYS_COUNT] = {
        fit->strike_bias_s[SIDE_LEFT], fit->strike_bias_s[SIDE_RIGHT],
        fit->toe_off_bias_s[SIDE_LEFT], fit->toe_off_bias_s[SIDE_RIGHT]};
    if (base_path == NULL) {
        write_subject(stream, subject);
    } else if (copy_file(stream, base_path) != 0) {
        return -1;
    }
    fputs("\n[controller]\n", stream);
    for (int i = 0; i < KEYS_COUNT; i++) {
        fprintf(stream, "%s = %.4f\n", KEYS[i], values_s[i]);
    }
    fprintf(
        stream,
        "; the largest error of a strike in that run, and a margin: %.4f s. As strike_error_s it\n"
        "; allows assistance without switches; nothing tells running from walking then\n",
        fit->strike_error_s);
    return 0;
}
