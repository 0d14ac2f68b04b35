/* afo soak: walks for days of simulated time, with speed commands, pushes, falls and
 * restarts, and watches that nothing drifts, grows or runs over unnoticed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "firmware/version.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/progress.h"
#include "sim_host/faults/injector.h"
#include "sim_host/loop/loop.h"
#include "sim_host/loop/soak_watch.h"
#include "sim_host/programs/commands.h"
#include "sim_host/subjects/subject.h"

enum {
    KEY_TICKS = 0x600,
    KEY_SEED,
    KEY_INJECT,
    TICKS_LEAST = 60000, /* 3 s a part, and beyond the ends of clocks and counters */
    REPORT_PARTS = 20,
    COMMAND_MS = 120000, /* a new speed command, on average */
    PUSH_MS = 90000,
    RESET_AFTER_TICKS = 1500,
    SETTLED_STEPS = 40,      /* after a change of command, before a step counts for the mean */
    COUNTED_STEPS = 500,     /* fewer settled steps than this say nothing about a mean */
    PAUSE_MAX_TICKS = 20000, /* between two steps: a fall, its fault, a reset, engaging anew */
    INJECT_EVERY_TICKS = 10000,
    TELL_TICKS = 10000
};

/* What a tick takes, about. */
#define TICK_S 5.5e-6

/* What can be made ill, to show that it is noticed. */
enum injection {
    INJECT_NOTHING,
    INJECT_LEAK,
    INJECT_WRAP,
    INJECT_STUCK,
    INJECT_CLOCK,
    INJECT_STOP,
    INJECTIONS
};
static const char *const injection_names[INJECTIONS] = {"nothing", "leak",  "wrap",
                                                        "stuck",   "clock", "stop"};

struct options {
    uint64_t ticks, seed;
    enum injection injection;
};

struct part {                                      /* one of REPORT_PARTS stretches of the soak */
    uint64_t steps, counted, falls, faults, pause; /* the longest between two steps, ticks */
    double off_sum, off_worst;                     /* measured minus commanded apex speed, shares */
};

struct soak {
    struct loop loop;
    struct part part[REPORT_PARTS];
    struct soak_watch watch;
    uint64_t rng;
    uint32_t last_number, settled;
    uint64_t fault_since, step_tick;
    bool in_fault, was_down;
    void *volatile lost; /* what the leak has lost */
};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    switch (key) {
    case KEY_TICKS:
        options->ticks = option_whole(state, "--ticks", text, TICKS_LEAST, UINT64_C(100000000000));
        break;
    case KEY_SEED:
        options->seed = option_whole(state, "--seed", text, 0, UINT64_MAX);
        break;
    case KEY_INJECT:
        options->injection =
            (enum injection)(1 + option_choice(state, "--inject", text, &injection_names[1],
                                               INJECTIONS - 1, sizeof injection_names[0]));
        break;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static int set_up(struct soak *soak, const struct options *options)
{
    char message[LOOP_MESSAGE_MAX] = "";
    struct subject subject;
    struct control_params params;
    struct loop_config config;
    subject_default(&subject);
    if (subject_control_params(&subject, &params, message) != 0 ||
        loop_configure(&config, &subject, &params, 0.45, SENSORS_17BIT, options->seed, message) !=
            0) {
        return program_complain("%s", message);
    }
    config.plant.start_hold.hold_after_fall = true;
    if (loop_init(&soak->loop, &config, NULL, message) != 0) {
        return program_complain("%s", message);
    }
    soak_watch_init(&soak->watch, &soak->loop);
    soak->rng = options->seed;
    return 0;
}

/* One in so many ticks. */
static bool once_in(struct soak *soak, double ms)
{
    return injector_random(&soak->rng) * ms < 1.0;
}

static void disturb(struct soak *soak)
{
    struct controller_objects *objects = &soak->loop.rig.task.node.objects;
    if (once_in(soak, COMMAND_MS)) {
        objects->desired_speed_rad_s = (float)(0.42 + 0.4 * injector_random(&soak->rng));
        soak->settled = 0;
    }
    if (once_in(soak, PUSH_MS)) {
        /* Most are small; one in twenty throws the walker down. */
        const double size = once_in(soak, 20.0) ? 0.5 : 0.002;
        plant_push(&soak->loop.nodes.plant, size * (injector_random(&soak->rng) - 0.5), 0.0);
        soak->settled = 0;
    }
}

/* What an operator does: after a fault or a stop, ask anew and reset. */
static void operate(struct soak *soak, struct part *part)
{
    struct control_task *task = &soak->loop.rig.task;
    struct controller_objects *objects = &task->node.objects;
    const enum supervisor_state state = task->output.state;
    const bool stopped = state == SUPERVISOR_FAULT || state == SUPERVISOR_STANDBY;
    if (stopped && !soak->in_fault) {
        part->faults++;
        soak->fault_since = soak->loop.tick;
    }
    soak->in_fault = stopped;
    if (!stopped) {
        objects->walk_requested = 1;
    } else if (soak->loop.tick - soak->fault_since > RESET_AFTER_TICKS) {
        objects->walk_requested = soak->loop.tick % 2 == 0 ? 1 : 0;
        objects->reset_requested = 1;
    }
}

/* The mutations that the watching must notice; each now and then in the second half. */
static void inject(struct soak *soak, const struct options *options)
{
    struct control_task *task = &soak->loop.rig.task;
    const bool now = soak->loop.tick % INJECT_EVERY_TICKS == 0;
    if (soak->loop.tick < options->ticks / 2) {
        return;
    }
    switch (options->injection) {
    case INJECT_LEAK:
        soak->lost = now ? malloc(1) : soak->lost;
        break;
    case INJECT_WRAP: /* as an addition that does not saturate */
        task->node.objects.counters.late_answers += now ? 3 : 0;
        break;
    case INJECT_STUCK:
        task->node.objects.counters.syncs_sent -= now ? 1 : 0;
        break;
    case INJECT_CLOCK:
        task->tick += now ? 1 : 0;
        break;
    case INJECT_STOP:
        soak->loop.rig.stop_pressed = true;
        break;
    default:
        break;
    }
}

static void watch_walk(struct soak *soak, struct part *part)
{
    const struct controller *controller = &soak->loop.rig.task.controller;
    const struct step_record *step = &controller->last_step;
    const bool down = plant_fault(&soak->loop.nodes.plant) != WALK_FAULT_NONE;
    part->falls += down && !soak->was_down ? 1 : 0;
    soak->was_down = down;
    const uint64_t pause = soak->loop.tick - soak->step_tick;
    part->pause = pause > part->pause ? pause : part->pause;
    if (step->number == soak->last_number) {
        return;
    }
    soak->last_number = step->number;
    soak->step_tick = soak->loop.tick;
    part->steps++;
    soak->settled++;
    if (down || step->number < SETTLED_STEPS) {
        soak->settled = 0;
    }
    if (soak->settled > SETTLED_STEPS) {
        const double off = (double)(step->measured_speed_rad_s - step->commanded_speed_rad_s) /
                           (double)step->commanded_speed_rad_s;
        part->counted++;
        part->off_sum += off;
        part->off_worst = fabs(off) > part->off_worst ? fabs(off) : part->off_worst;
    }
}

static void report_part(const struct soak *soak, int index, const struct part *part)
{
    printf("  %2d  %10llu  %8llu %6llu %6llu  %7llu   %+9.2e  %8.2e  %zu\n", index + 1,
           (unsigned long long)soak->loop.tick, (unsigned long long)part->steps,
           (unsigned long long)part->falls, (unsigned long long)part->faults,
           (unsigned long long)part->pause,
           part->counted > 0 ? part->off_sum / (double)part->counted : 0.0, part->off_worst,
           soak->watch.heap_bytes);
    fflush(stdout);
}

static void run(struct soak *soak, const struct options *options)
{
    struct progress progress;
    printf("%llu ticks, %.1f h of walking, in %d parts, seed %llu; afo %s\n",
           (unsigned long long)options->ticks, (double)options->ticks / 3.6e6, REPORT_PARTS,
           (unsigned long long)options->seed, version_text());
    puts("part       ticks     steps  falls  stops  longest   mean off    worst off  heap\n"
         "                                          pause");
    fflush(stdout);
    program_announce((double)options->ticks * TICK_S, "%llu ticks",
                     (unsigned long long)options->ticks);
    progress_begin(&progress, "ticks", options->ticks, false);
    for (int index = 0; index < REPORT_PARTS; index++) {
        struct part *part = &soak->part[index];
        const uint64_t end = options->ticks * (uint64_t)(index + 1) / REPORT_PARTS;
        while (soak->loop.tick < end) {
            disturb(soak);
            operate(soak, part);
            loop_tick(&soak->loop);
            inject(soak, options);
            watch_walk(soak, part);
            soak_watch_tick(&soak->watch, &soak->loop);
            if (soak->loop.tick % TELL_TICKS == 0) {
                progress_tell(&progress, soak->loop.tick);
            }
        }
        soak_watch_memory(&soak->watch);
        report_part(soak, index, part);
    }
    progress_end(&progress);
}

static bool expect(bool holds, const char *what)
{
    printf("%s: %s\n", holds ? "well" : "ILL ", what);
    return holds;
}

static bool soak_passed(const struct soak *soak)
{
    const struct soak_watch *watch = &soak->watch;
    bool walks = true, steady = true;
    uint64_t counted = 0;
    for (int i = 0; i < REPORT_PARTS; i++) {
        const struct part *part = &soak->part[i];
        walks = walks && part->steps > 0 && part->pause <= PAUSE_MAX_TICKS;
        counted += part->counted;
        steady = steady && (part->counted < COUNTED_STEPS ||
                            fabs(part->off_sum / (double)part->counted) < 2e-3);
    }
    bool well = expect(walks, "it walks in every part, and is never out of step for 20 s");
    well =
        expect(steady, "the mean apex speed is the commanded one within 0.2 % in every part of 500 "
                       "settled steps or more") &&
        well;
    for (int ill = 0; ill < SOAK_ILLS; ill++) {
        well = expect(watch->ill[ill] == 0, soak_ill_name((enum soak_ill)ill)) && well;
        if (watch->ill[ill] != 0) {
            printf("      %llu times, first at tick %llu\n", (unsigned long long)watch->ill[ill],
                   (unsigned long long)watch->first_ill[ill]);
        }
    }
    printf("%llu ticks, %.1f h of walking, %llu settled steps counted\n",
           (unsigned long long)soak->loop.tick, (double)soak->loop.tick / 3.6e6,
           (unsigned long long)counted);
    return well;
}

int afo_soak(int argc, char **argv)
{
    static const struct argp_option option_list[] = {
        {"ticks", KEY_TICKS, "N", 0, "control ticks to walk (default 100000000: 28 hours)", 0},
        {"seed", KEY_SEED, "N", 0, "seed of commands and disturbances (default 1)", 0},
        {"inject", KEY_INJECT, "WHAT", 0,
         "make something ill, to see it noticed: leak, wrap, stuck, clock or stop", 0},
        {0}};
    static const struct argp parser = {
        option_list,
        take,
        0,
        "Walks for days of simulated time and watches what must not change.\v"
        "Exit status: 0 all well, 1 not, 2 wrong usage.",
        0,
        0,
        0};
    struct options options = {.ticks = 100000000, .seed = 1};
    static struct soak soak;
    option_parse(&parser, argc, argv, &options);
    if (set_up(&soak, &options) != 0) {
        return EXIT_USAGE;
    }
    run(&soak, &options);
    return soak_passed(&soak) ? EXIT_GOOD : EXIT_BAD;
}
