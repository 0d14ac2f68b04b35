/* What a walk was: one row a step, from the plant's truth and the controller's records. */
#ifndef SIM_HOST_LOOP_WALK_RECORD_H
#define SIM_HOST_LOOP_WALK_RECORD_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/loop/gait_record.h"
#include "sim_host/loop/loop.h"
#include "sim_host/loop/push_record.h"
#include "sim_host/plant/walking_units.h"

struct walk_row {
    uint32_t number;         /* 1 is the first apex */
    enum side side;          /* stance leg */
    double time_s;           /* of the apex */
    double apex_speed_rad_s; /* the plant's truth */
    double
        step_length_m; /* toe to toe at the heel strike that ends this stance, of a person as a compass; 0 = not reached */
    double heel_strike_s; /* that ends this stance's single support; NaN: not reached, as below */
    double toe_off_s;     /* of the stance leg, behind it */
    double push_off_J; /* of the device on the walker behind this apex; NaN of a recorded person */
    double margin_m;   /* of stability just before the heel strike; NaN of a recorded person */
    bool measured;     /* the controller saw this apex: the fields below are valid */
    double measured_speed_rad_s;
    double command_rad_s;
    double r0_m;        /* what the law asked for at this apex */
    bool used_fallback; /* by eq. (16) in place of the predictive law */
};

struct walk_record {
    struct walk_row *rows; /* owned; capacity rows */
    uint32_t capacity;
    uint32_t count;
    uint32_t apexes[SIDE_COUNT]; /* seen by the controller */
    uint32_t unmatched;          /* controller's apexes without one of the plant: false ones */
    double first_apex_s;
    struct push_record push; /* what the device did at each ankle; begins with the first tick */
    bool push_begun;
    struct walking_pose pose; /* of the walker in single support, one tick ago, at pose_s */
    double pose_s;
    struct gait_record gait; /* events as the controller saw them, beside the truth */
};

/* Room for `capacity` steps; gait event times count from origin_s of the plant.
 * Returns false without memory. */
bool walk_record_init(struct walk_record *record, uint32_t capacity, double origin_s);
void walk_record_free(struct walk_record *record);

/* Takes what the last tick brought: the plant's events, the controller's step.
 * Further steps than `capacity` are dropped. Returns the plant's event of this
 * tick for the tick log (enum walk_event_kind), -1 if none. */
int walk_record_take(struct walk_record *record, struct loop *loop);

struct walk_summary {
    uint32_t over; /* the last so many steps */
    double mean_rad_s, least_rad_s, greatest_rad_s;
};
/* Over the last `over` steps (fewer when there are fewer). */
struct walk_summary walk_record_summary(const struct walk_record *record, uint32_t over);

#endif
