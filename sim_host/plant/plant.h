/* The plant: what the orthosis moves and what its sensors measure.
 *
 * It is the 3-DOF walker with two SEAs, held until it may walk (start_hold.h). Or it is a recorded
 * person, whose motion the SEAs do not change. Or it is a person who walks by reflexes
 * (sim_host/reflex), whom they do move. In every case each leg has a sensor.
 * One plant_advance() is one tick, from SYNC k to SYNC k+1. A process that owns a plant calls, at
 * SYNC k:
 *     plant_set_command() for each side whose command takes effect now
 *     plant_sample(), plant_sea_output()   (what the nodes answer)
 *     plant_advance()
 * The plant has parameters of its own, never the controller's. All are doubles and plain types, so
 * that float-compiled code may include this header.
 *
 * Nothing is ideal by default: plant_config_default() gives the real SEA and 17-bit sensors.
 * Only a recording uses the heap: plant_init() loads it, plant_free() releases it. Without one,
 * struct plant is plain data: a copy is a snapshot, and the same future follows from it bit for
 * bit. With one, copies share the recording, and only one of them may be freed.
 * Same config and commands: same bits with gcc and clang at any -O.
 */
#ifndef SIM_HOST_PLANT_PLANT_H
#define SIM_HOST_PLANT_PLANT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "model/side.h"
#include "sim_host/plant/contact_wire.h"
#include "sim_host/plant/foot_switch.h"
#include "sim_host/plant/person_motion.h"
#include "sim_host/plant/recorded_person.h"
#include "sim_host/plant/sea.h"
#include "sim_host/plant/sensors.h"
#include "sim_host/plant/start_hold.h"
#include "sim_host/plant/walk.h"
#include "sim_host/reflex/reflex_person.h"

/* Faults of a recorded person's latch, effective at once. */
enum plant_latch_fault {
    PLANT_LATCH_WELL = 0,
    PLANT_LATCH_OPENS = 1,      /* by itself, under load */
    PLANT_LATCH_STAYS_OPEN = 2, /* it does not close again */
    PLANT_LATCH_STAYS_CLOSED = 3,
    PLANT_LATCH_FAULT_COUNT = 4
};

enum plant_kind {
    PLANT_WALKER = 0,
    PLANT_RECORDED_PERSON = 1, /* whose motion the device does not change */
    PLANT_REFLEX_PERSON = 2    /* whose muscles answer to the device */
};

enum { PLANT_PATH_MAX = 512, PLANT_ERROR_MAX = 512 };

struct plant_config {
    enum plant_kind kind;
    double tick_s;           /* SYNC period; default 0.001 */
    uint64_t seed;           /* sensors, release jitter, rough ground */
    struct walk_params walk; /* body, slope, ...; body also of a recorded person */
    struct walk_pose start;  /* just after lift-off of the start gait */
    struct start_hold_params start_hold;
    struct sea_params sea[SIDE_COUNT];
    struct sensor_params sensors[SIDE_COUNT];
    double
        roughness_m; /* standard deviation of foothold heights; default 0; no recording has any */
    const double *heights_m; /* heights of footholds 1.. above the slope line, or NULL; */
    size_t heights_count;    /* caller's, must outlive the plant; after the last: 0 */
    char recording_path[PLANT_PATH_MAX]; /* PLANT_RECORDED_PERSON: the recording */
    const struct recording *recording;   /* the caller's, in the file's place; NULL: read the file.
                                        * It must outlive the plant */
    struct recording_format recording_format; /* its ankles are a reflex person's, too */
    struct reflex_person_params reflex;       /* PLANT_REFLEX_PERSON; its step is a drive period */
    bool unworn; /* a reflex person feels nothing of the SEAs: the pair of the walk with them */
    struct foot_switch_params foot_switch[SIDE_COUNT]; /* of a recorded person; default: none */
    enum plant_latch_fault latch_fault;                /* of both latches of a recorded person, */
    double latch_fault_s;                              /* from this time on */
    uint64_t recording_start_tick; /* the recording runs from this tick on (its first sample
                                            is held before); default 1000 */
};

/* A stair's edge ahead of a reflex person, and how much higher the ground is behind it. Heel and ball of either foot pass
 * it over the stair's height; below that it stops them, as often as they come to it. */
struct plant_stair {
    double rise_m; /* 0: there is none */
    double edge_m; /* the person's x, forward */
    bool passed[SIDE_COUNT][FOOT_POINTS];
};

enum plant_error {
    PLANT_OK = 0,
    PLANT_BAD_BODY = -1,
    PLANT_BAD_WALK = -2,
    PLANT_BAD_START = -3,
    PLANT_BAD_START_HOLD = -4,
    PLANT_BAD_SEA = -5,
    PLANT_BAD_SENSOR = -6,
    PLANT_BAD_GROUND = -7,
    PLANT_BAD_RECORDING = -8,
    PLANT_BAD_TICK = -9, /* tick not 0.1 .. 10 ms, or not a whole number of drive periods */
    PLANT_BAD_FOOT_SWITCH = -10,
    PLANT_BAD_PERSON = -11
};

/* Cumulative energies (J) since init. */
struct plant_energy {
    double walker_J;  /* kinetic + potential, now */
    double springs_J; /* in both springs, now */
    double collision_loss_J;
    double device_work_J[SIDE_COUNT]; /* on the walker or person, at the ankle */
    double own_work_J;
    double motor_work_J[SIDE_COUNT];
    double motor_positive_work_J[SIDE_COUNT];
};

struct plant {
    struct plant_config config;
    uint64_t tick;
    struct sea sea[SIDE_COUNT];
    struct sensor sensor[SIDE_COUNT];
    struct start_hold start_hold;
    struct walk walk;
    struct rng ground_rng;
    uint64_t footholds;
    double foothold_height_m, next_foothold_height_m; /* above the slope line */
    double person_work_J[SIDE_COUNT];
    struct recording recording;
    struct recorded_person_state person; /* of either kind, as the sensors and the SEAs meet it */
    struct reflex_person reflex;
    struct ground_line slope_line; /* below a reflex person */
    struct plant_stair stair;
    double strut_m
        [SIDE_COUNT]; /* of a reflex person's spring: the ankle's way at which it is locked, at most 0 */
    bool foothold_laid[SIDE_COUNT]; /* below a reflex person's foot in swing */
    struct person_motion motion;
    size_t recording_cursor;
    enum plant_latch_fault latch_broken[SIDE_COUNT]; /* beside the config's; set at any time */
    struct foot_switch foot_switch[SIDE_COUNT];
    enum foot_contact foot[SIDE_COUNT];         /* what the switches say at this SYNC */
    struct contact_wire other_foot[SIDE_COUNT]; /* at each latch's node */
};

/* The paper's walker (M = 1, m = 0.01, l = 1, k = 100, g = 9.80665) with real SEAs and 17-bit sensors on
 * level ground. It starts in the pose of the gait at r0 = 0.05, with the left leg in stance. */
void plant_config_default(struct plant_config *config);

/* The same for another body and spring. SEAs, sensors, start hold and limits are scaled to it. The
 * start pose is that of the body's own gait at r0 = 0.05 l. A body without one gets the paper's
 * angles, with rates scaled by sqrt(g/l). */
void plant_config_for(const struct walker3_params *body, double spring_N_per_m,
                      enum sea_preset_kind sea, enum sensor_preset_kind sensors,
                      struct plant_config *config);

/* Checks everything, loads the recording, starts at tick 0. On failure nothing is
 * held, *plant must not be used, and message (PLANT_ERROR_MAX bytes, never NULL)
 * names the field or the file's line. */
enum plant_error plant_init(struct plant *plant, const struct plant_config *config, char *message);
void plant_free(struct plant *plant);

/* Commands a drive from now (a SYNC) on. Drives start in SEA_TORQUE_OFF. */
void plant_set_command(struct plant *plant, enum side side, const struct sea_command *command);

/* Measures at this SYNC. Call plant_sample() once per tick and side, before plant_advance(): the
 * sensor's noise and delay line advance here. */
void plant_sample(struct plant *plant, enum side side, struct sensor_sample *sample);
void plant_sea_output(const struct plant *plant, enum side side, struct sea_output *output);

/* One tick. Cost: below 8 us on average on a 2 GHz x86-64 core. */
void plant_advance(struct plant *plant);

/* The true state, for records and for the oracle. Nodes see the sensors only. */
struct plant_truth {
    uint64_t tick;
    double time_s;
    double leg_angle_rad[SIDE_COUNT], leg_rate_rad_s[SIDE_COUNT];
    double ankle_m[SIDE_COUNT], ankle_rate_m_s[SIDE_COUNT]; /* the extension: never below 0 */
    double way_m[SIDE_COUNT],
        way_rate_m_s[SIDE_COUNT]; /* the same, but a reflex person's is below 0 when flexed */
    bool contact[SIDE_COUNT];
    double ground_force_N[SIDE_COUNT][2]; /* walker and reflex person only */
    double hip_m[2];             /* the same, world; a reflex person walks towards -x, too */
    double toe_m[SIDE_COUNT][2]; /* the same, world */
    enum side stance;            /* the leg on the ground; in double support the one behind */
    enum walk_phase phase; /* of a person by the contacts; WALK_HELD: no foot is on the ground */
    enum walk_fault fault;
    bool is_person; /* a person stands in the walker's place */
    bool has_place; /* hip, toes and forces are known */
    bool finished;  /* the recording is over */
};
void plant_truth(const struct plant *plant, struct plant_truth *truth);
void plant_energy(const struct plant *plant, struct plant_energy *energy);

/* How many steps have been taken: a walker's, or a reflex person's footholds; 0 of a recording. */
uint64_t plant_steps(const struct plant *plant);

/* Seconds since the walk began: of a walker since power-on, of a person since their first sample. Negative before. */
double plant_walked_s(const struct plant *plant);

/* Next unread event or finished step (walk.h). A recorded person's heel strikes, toe-offs and
 * releases are events, too. False if there is none. */
bool plant_next_event(struct plant *plant, struct walk_event *event);
bool plant_next_step(struct plant *plant, struct walk_step *step);

/* Where the end of an open latch's spring stands at the ankle, m: its compression is the motor's position less this. It
 * is the ankle's extension, but a reflex person's (plant_reflex_person.c) may be beyond it, or below 0. */
double plant_spring_end_m(const struct plant *plant, enum side side);

/* Lever of the spring at a recorded person's ankle that is extended by ankle_m, m: torque per force. 0 of a
 * walker, whose spring works along the leg. */
double plant_ankle_lever_m(const struct plant *plant, enum side side, double ankle_m);

enum walk_fault plant_fault(const struct plant *plant);

/* Disturbances, effective at once. */
/* On the torso; of a reflex person at the hip. Nothing moves a recorded person. */
void plant_push(struct plant *plant, double impulse_x_Ns, double impulse_y_Ns);
/* scale 1: as configured; 0: broken; > 1: stiffer. Clamped to 0 .. 100. */
void plant_set_spring_scale(struct plant *plant, enum side side, double scale);
/* Gives the walker a push-off of its own: a spring of this stiffness and rest extension at the
 * trailing ankle, from the next heel strike on. Stiffness 0 ends it at once. */
void plant_set_own_push(struct plant *plant, double stiffness_N_per_m, double rest_m);
/* One stair, and level (or sloping) ground behind it: from the next foothold on the ground is rise_m higher, below 0 lower.
 * A reflex person meets its edge, plant_stair; while one is ahead of them no other is laid. Nothing is below a
 * recorded person. */
void plant_lay_stair(struct plant *plant, double rise_m);

#endif
