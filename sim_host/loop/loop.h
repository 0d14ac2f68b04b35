/* The whole loop in one process: control task, CAN bus, nodes, plant.
 *
 * The control task is the flashed object code. It meets the plant only through frames on the
 * in-process bus. One loop_tick() is one SYNC period in lock-step, as fast as the machine can.
 * Everything is in one struct, without pointers to the outside but the log. So runs from the same
 * config give the same frames bit for bit on every machine.
 */
#ifndef SIM_HOST_LOOP_LOOP_H
#define SIM_HOST_LOOP_LOOP_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "sim_host/bus/sim_bus.h"
#include "sim_host/devices/eds_file.h"
#include "sim_host/nodes/power_relay.h"
#include "sim_host/nodes/walker_nodes.h"
#include "sim_host/plant/own_push.h"
#include "sim_host/plant/plant.h"
#include "sim_host/subjects/host_task.h"
#include "sim_host/subjects/subject.h"

enum { LOOP_MESSAGE_MAX = 1024, LOOP_PORT_CONTROLLER = 0, LOOP_PORT_FIRST_NODE = 1 };

/* Faults that show that real frames matter. Values appear in reports. */
enum loop_fault {
    LOOP_FAULT_NONE = 0,
    LOOP_FAULT_CUT_DRIVES = 1,  /* the frames from and to the drives are lost */
    LOOP_FAULT_NEVER_ARMED = 2, /* the latch bit is cleared in every command */
    LOOP_FAULT_SWAPPED = 3,     /* left and right sensor exchanged */
    LOOP_FAULT_CROSSED = 4,     /* left and right drive exchanged, with their latches */
    LOOP_FAULT_COUNT = 5
};

/* Lets the CiA 402 drives obey data sheets strictly; NULL: that one does not. They must outlive the nodes. */
void loop_obey_sheets(struct walker_nodes *nodes, const struct eds_file *const eds[SIDE_COUNT]);

/* Its name on the command line and in reports. */
const char *loop_fault_name(enum loop_fault fault);

struct loop_config {
    struct subject subject;
    struct control_params params;
    struct plant_config plant;
    struct own_push_params own_push; /* the person's; not present by default */
    double desired_speed_rad_s;
    bool standby;                                 /* no walk is asked for at the start */
    const struct eds_file *drive_eds[SIDE_COUNT]; /* the drives obey these strictly; or NULL */
    enum loop_fault fault;
    uint32_t fault_step;        /* the fault begins when this many apexes have passed, */
    uint32_t fault_delay_ticks; /* and so much later */
    /* Puts something between control task and bus; NULL = nothing. */
    struct can_bus (*wrap_bus)(void *context, struct can_bus bus);
    void *wrap_context;
};

struct loop;

/* What the bus needs to wake one node. */
struct loop_wake {
    struct loop *loop;
    enum walker_node node;
};

struct loop {
    struct loop_config config;
    struct sim_bus bus;
    struct walker_nodes nodes; /* plant, drives and sensors */
    struct own_push own_push;
    struct loop_wake wake[WALKER_NODES];
    struct host_task rig;     /* the control task and its drives' protocol */
    struct power_relay relay; /* between its power lines and the drives */
    uint64_t tick;            /* SYNCs so far */
    bool fault_active;
    uint32_t fault_waited_ticks; /* since config.fault_step */
    FILE *log;                   /* candump -L, or NULL */
    uint64_t logged_frames;
};

/* Subject, its parameters and the sensors to a full config: plant by the subject's
 * scale, start pose = the model's gait at start_r0_m. Returns 0, or -1 with the
 * reason in message (LOOP_MESSAGE_MAX bytes). */
int loop_configure(struct loop_config *config, const struct subject *subject,
                   const struct control_params *params, double desired_speed_rad_s,
                   enum sensor_preset_kind sensors, uint64_t seed, char *message);

/* Makes a person of the walker: with a push-off of their own at the desired speed, and not held until the
 * springs are loaded. The controller assists after engage_steps steady steps. */
void loop_configure_person(struct loop_config *config, unsigned engage_steps);

/* Builds everything and boots the nodes. The loop is large (about 200 kB): static
 * or on the heap. log may be NULL, else it stays the caller's. Returns 0, or -1
 * with the reason in message; then nothing is held. */
int loop_init(struct loop *loop, const struct loop_config *config, FILE *log, char *message);

/* One SYNC period. Cost: about 10 us. */
void loop_tick(struct loop *loop);

/* The end of a SYNC period, for who runs the bus and starts the cycles: the nodes take
 * what has come, the plant goes on by one period. */
void loop_end_period(struct loop *loop, uint64_t now_ns);

/* Puts the controller's power lines at the relay, low: after a restart of the controller. */
void loop_wire_power(struct loop *loop);

/* Gives back what the plant holds (a recording). */
void loop_free(struct loop *loop);

#endif
