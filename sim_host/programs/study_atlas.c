/* afo study atlas: where a walker walks, point by point: the basin of attraction as a volume, the plane of
 * push-off and stiffness. scripts/bench-atlas draws what it writes. Under mpirun: build/afo-mpi. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/batch/atlas.h"
#include "sim_host/batch/batch.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/programs/commands.h"
#include "sim_host/study/plot.h"

enum { KEY_POINTS = 0x100, KEY_R0, KEY_STRIDES, KEY_MASS_RATIO, KEY_THREADS, KEY_LANES };
enum { MAP_BASIN = 0, MAP_PLANE = 1 };

struct options {
    int map; /* -1 = not told */
    const char *path;
    int points, strides, threads, lanes; /* points 0 = the map's default */
    double push_m, mass_ratio;
};

static const struct argp_option option_list[] = {
    {"points", KEY_POINTS, "N", 0, "points a side (basin 128, plane 200)", 0},
    {"r0", KEY_R0, "M", 0, "basin: precompression, metres (0.05)", 0},
    {"strides", KEY_STRIDES, "N", 0, "basin: steps that count as walking on, to 254 (60)", 0},
    {"mass-ratio", KEY_MASS_RATIO, "X", 0,
     "plane: m/M of the walker (0.01, the paper's; 0.0385 a 70 kg adult's)", 0},
    {"threads", KEY_THREADS, "N", 0, "use so many threads (0: all processors)", 0},
    {"lanes", KEY_LANES, "N", 0,
     "vectors of 2, 4 or 8 numbers (0: the widest); no result depends on it", 0},
    {0}};

static void take_word(struct options *options, const char *text, struct argp_state *state)
{
    static const char *const maps[] = {"basin", "plane"};
    if (options->map < 0) {
        options->map = option_choice(state, "MAP", text, maps, 2, sizeof maps[0]);
    } else if (options->path == NULL) {
        options->path = text;
    } else {
        option_refuse_argument(state, text);
    }
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    switch (key) {
    case KEY_POINTS:
        options->points = (int)option_whole(state, "--points", text, 2, 20000);
        return 0;
    case KEY_R0:
        options->push_m = option_number(state, "--r0", text, 0.0, 10.0);
        return 0;
    case KEY_STRIDES:
        options->strides = (int)option_whole(state, "--strides", text, 1, 254);
        return 0;
    case KEY_MASS_RATIO:
        options->mass_ratio = option_number(state, "--mass-ratio", text, 0.0, 1.0);
        return 0;
    case KEY_THREADS:
        options->threads = (int)option_whole(state, "--threads", text, 0, 256);
        return 0;
    case KEY_LANES:
        options->lanes = (int)option_whole(state, "--lanes", text, 0, 8);
        return 0;
    case ARGP_KEY_ARG:
        take_word(options, text, state);
        return 0;
    case ARGP_KEY_END:
        if (options->path == NULL) {
            argp_error(state, "which map, into which file? %s basin FILE, or plane FILE",
                       program_name());
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* The table of the picture has so many points a side, or all where there are fewer. */
enum { SHOWN = 100, SECTIONS = 3 };

static int every_of(int points)
{
    return (points + SHOWN - 1) / SHOWN;
}

/* Reads every chunk of the finished file, and gives it to `put`. 0, or -1 behind a complaint. */
static int tell_chunks(const struct chunks_job *job, FILE *table,
                       void (*put)(const struct chunks_job *job, size_t chunk,
                                   const unsigned char *byte, FILE *table))
{
    unsigned char *byte = malloc(job->bytes);
    int done = byte != NULL;
    for (size_t i = 0; i < job->count && done; i++) {
        done = chunks_read(job, i, byte);
        if (done) {
            put(job, i, byte, table);
        }
    }
    free(byte);
    return done ? 0 : program_complain("%s: no picture: it cannot be read", job->path);
}

/* A chunk is a speed; sections at a quarter, half and three quarters of the swing rates. */
static void put_basin(const struct chunks_job *job, size_t chunk, const unsigned char *byte,
                      FILE *table)
{
    const struct atlas_basin *basin = job->context;
    const int every = every_of(basin->speed.count);
    for (int k = 1; k <= SECTIONS && (int)chunk % every == 0; k++) {
        const int rate = k * basin->rate.count / (SECTIONS + 1);
        for (int i = 0; i < basin->swing.count; i += every) {
            const int steps = byte[i * basin->rate.count + rate];
            fprintf(table, "%.6g,%.6g,%.6g,%d\n", atlas_at(&basin->speed, (int)chunk),
                    atlas_at(&basin->swing, i), atlas_at(&basin->rate, rate),
                    steps == ATLAS_WALKS ? basin->strides : steps);
        }
    }
}

/* 0: falls; 1 to 4: period 1, 2, 4 or 8; 5: another, or none. */
static int class_of(int period)
{
    return period == ATLAS_NO_GAIT ? 0
           : period == 1           ? 1
           : period == 2           ? 2
           : period == 4           ? 3
           : period == 8           ? 4
                                   : 5;
}

static void put_plane(const struct chunks_job *job, size_t chunk, const unsigned char *byte,
                      FILE *table)
{
    const struct atlas_plane *plane = job->context;
    const int every = every_of(plane->push.count), columns = plane->push.count;
    for (int row = 0; row < ATLAS_PLANE_ROWS; row++) {
        const int at = (int)chunk * ATLAS_PLANE_ROWS + row;
        for (int i = 0; i < columns && at < plane->stiffness.count && at % every == 0; i += every) {
            fprintf(table, "%.6g,%.6g,%d\n", atlas_at(&plane->push, i),
                    atlas_at(&plane->stiffness, at), class_of(byte[row * columns + i]));
        }
    }
}

static int tell_basin(const struct chunks_job *job)
{
    FILE *table = plot_table("atlas-basin");
    if (table == NULL) {
        return -1;
    }
    fputs("speed_rad_s,swing_angle_rad,swing_rate_rad_s,steps\n", table);
    return tell_chunks(job, table, put_basin);
}

static int tell_plane(const struct chunks_job *job)
{
    FILE *table = plot_table("atlas-plane");
    if (table == NULL) {
        return -1;
    }
    plot_name("push_off", "push-off r0 / l");
    plot_name("stiffness", "stiffness k l / (M g)");
    fputs("push_off,stiffness,class\n", table);
    return tell_chunks(job, table, put_plane);
}

static int run(struct chunks_job job, const struct options *options,
               int (*tell)(const struct chunks_job *job))
{
    job.threads = options->threads;
    job.is_progress_shown = 1;
    const enum chunks_status status = chunks_run(&job);
    if (status == CHUNKS_DONE && plot_is_asked() && tell(&job) != 0) {
        return EXIT_BAD;
    }
    if (status == CHUNKS_DONE || status == CHUNKS_HELPED) {
        return EXIT_GOOD;
    }
    program_complain("%s: %s%s%s", job.path, chunks_status_name(status),
                     status == CHUNKS_NO_FILE ? ": " : "",
                     status == CHUNKS_NO_FILE ? strerror(errno) : "");
    return EXIT_BAD;
}

static int run_basin(const struct options *options)
{
    const int points = options->points > 0 ? options->points : 128;
    struct atlas_basin basin = {1.0,
                                0.01,
                                1.0,
                                100.0,
                                9.80665,
                                options->push_m,
                                1e-6,
                                {0.05, 2.0, points},
                                {-0.8, 1.2, points},
                                {-1.0, 4.0, points},
                                options->strides};
    return run(atlas_basin_job(&basin, options->path), options, tell_basin);
}

static int run_plane(const struct options *options)
{
    const int points = options->points > 0 ? options->points : 200;
    struct atlas_plane plane = {options->mass_ratio, {0.005, 0.3, points}, {3.0, 30.0, points}};
    return run(atlas_plane_job(&plane, options->path), options, tell_plane);
}

int afo_study_atlas(int argc, char **argv)
{
    static const struct argp parser = {
        option_list,
        take,
        "basin FILE\nplane FILE",
        "Computes one byte a point into FILE, which is resumed when it is there: interrupt at will.\v"
        "basin: N^3 apexes of the paper's walker, forward speed 0.05 to 2 rad/s, swing angle -0.8 to "
        "1.2 rad, swing rate -1 to 4 rad/s: whole steps before the fall, or 255. plane: N x N of r0/l "
        "0.005 to 0.3 and k l/(M g) 3 to 30: 0 falls, 1 to 64 the period, 255 none.\n"
        "Exit status: 0 done, 1 not (the file holds other work, or it was stopped), 2 usage.",
        0,
        0,
        0};
    struct options options = {.map = -1, .strides = 60, .push_m = 0.05, .mass_ratio = 0.01};

    plot_option_parse(&parser, argc, argv, &options);
    if (batch_use_lanes(options.lanes) != BATCH_OK) {
        program_complain(
            "--lanes must be 2, 4 or 8, and this processor must have them; 0: the widest");
        return EXIT_USAGE;
    }
    return options.map == MAP_BASIN ? run_basin(&options) : run_plane(&options);
}
