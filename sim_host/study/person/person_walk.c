#include "sim_host/study/person/person_walk.h"

#include <math.h>
#include <stdlib.h>

#include "sim_host/cli/recording_options.h"
#include "sim_host/loop/loop.h"

#define PUSH_FROM_S 5.0
#define PUSH_EVERY_S 3.0
#define PUSH_PHASE_S 0.17 /* later with every seed, seven times over */

double person_walk_mass_kg(const struct person *person)
{
    return person->torso_mass_kg + 2.0 * person->leg_mass_kg;
}

/* The impulse of the millisecond (tick) from before_s to now_s, N s. */
static double push_Ns(const struct person_walk *walk, double before_s, double now_s)
{
    const double first_s = PUSH_FROM_S + PUSH_PHASE_S * (double)(walk->seed % 7);
    const double before = floor((before_s - first_s) / PUSH_EVERY_S),
                 now = floor((now_s - first_s) / PUSH_EVERY_S);
    if (now <= before || now < 0.0) {
        return 0.0;
    }
    const bool forward = ((uint64_t)now + walk->seed) % 2 == 0;
    const double impulse_Ns = walk->push_m_s * person_walk_mass_kg(&walk->subject->person);
    return forward ? impulse_Ns : -impulse_Ns;
}

static void set_person(const struct person_walk *walk, struct reflex_person_params *params)
{
    struct person_muscles muscles = walk->subject->person.muscles;
    if (walk->gains != NULL) {
        muscles.gains = *walk->gains;
        muscles.start_speed_m_s = walk->start_speed_m_s;
        muscles.start_lean_rad = walk->start_lean_rad;
    }
    person_muscles_apply(&muscles, params);
    params->noise_share = walk->noise_share;
    params->noise_seed = walk->seed;
}

/* Whether the walk goes on behind a tick that ends at now_s. */
static bool goes_on(const struct person_walk *walk, const struct gait_measure *measure)
{
    return !measure->fell && measure->now_s < walk->until_s &&
           (walk->steps == 0 || measure->steps < (int)walk->steps);
}

static int walk_alone(const struct person_walk *walk, struct gait_measure *measure, char *message)
{
    static const struct reflex_person_loads alone;
    const struct person *body = &walk->subject->person;
    struct reflex_person_params params;
    struct reflex_person person;
    reflex_person_default(person_walk_mass_kg(body), body->leg_length_m, &params);
    set_person(walk, &params);
    params.step_s = walk->step_s;
    const char *bad = reflex_person_check(&params);
    if (bad != NULL) {
        snprintf(message, LOOP_MESSAGE_MAX, "%s: %s", body->name, bad);
        return -1;
    }
    reflex_person_init(&person, &params);
    const int a_millisecond = (int)(0.001 / params.step_s + 0.5);
    for (long ms = 1; goes_on(walk, measure); ms++) {
        const double impulse_Ns = push_Ns(walk, 0.001 * (double)(ms - 1), 0.001 * (double)ms);
        if (impulse_Ns != 0.0) {
            reflex_person_push(&person, (struct vector2){impulse_Ns, 0.0});
        }
        for (int i = 0; i < a_millisecond; i++) {
            reflex_person_step(&person, &alone);
        }
        gait_measure_take(measure, &person, 0.001 * (double)ms);
    }
    return 0;
}

static int configure_worn(const struct person_walk *walk, struct loop_config *config, char *message)
{
    struct subject subject = *walk->subject;
    struct control_params params;
    struct recording_options wearer;
    if (walk->r0_m > 0.0) {
        person_override(&subject.person, "start_r0_m", walk->r0_m);
    }
    recording_options_init(&wearer);
    wearer.by_reflexes = true;
    subject.is_person = true;
    if (subject_control_params(&subject, &params, message) != 0 ||
        loop_configure(config, &subject, &params,
                       (double)speed_table_speed(&params.table, params.start_r0_m), SENSORS_17BIT,
                       walk->seed, message) != 0 ||
        recording_options_apply(&wearer, config, message) != 0) {
        return -1;
    }
    set_person(walk, &config->plant.reflex);
    return 0;
}

static int walk_worn(const struct person_walk *walk, struct gait_measure *measure, char *message)
{
    struct loop_config *config = (struct loop_config *)malloc(sizeof *config);
    struct loop *loop = (struct loop *)malloc(sizeof *loop);
    int status = -1;
    if (config == NULL || loop == NULL) {
        snprintf(message, LOOP_MESSAGE_MAX, "out of memory");
    } else if (configure_worn(walk, config, message) == 0 &&
               loop_init(loop, config, NULL, message) == 0) {
        struct plant *plant = &loop->nodes.plant;
        const double start_s = (double)config->plant.recording_start_tick * config->plant.tick_s;
        double before_s = 0.0;
        while (goes_on(walk, measure)) {
            loop_tick(loop);
            const double now_s = (double)plant->tick * config->plant.tick_s - start_s;
            if (now_s > before_s) {
                const double impulse_Ns = push_Ns(walk, before_s, now_s);
                if (impulse_Ns != 0.0) {
                    reflex_person_push(&plant->reflex, (struct vector2){impulse_Ns, 0.0});
                }
                gait_measure_take(measure, &plant->reflex, now_s);
                before_s = now_s;
            }
        }
        loop_free(loop);
        status = 0;
    }
    free(loop);
    free(config);
    return status;
}

int person_walk_run(const struct person_walk *walk, struct gait_summary *summary, char *message)
{
    struct gait_measure *measure = (struct gait_measure *)malloc(sizeof *measure);
    int status = -1;
    if (measure == NULL) {
        snprintf(message, LOOP_MESSAGE_MAX, "out of memory");
        return -1;
    }
    gait_measure_init(measure, walk->from_s);
    status = walk->worn ? walk_worn(walk, measure, message) : walk_alone(walk, measure, message);
    gait_measure_summary(measure, summary);
    free(measure);
    return status;
}
