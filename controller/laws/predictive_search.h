/* The predictive law's search: a bounded search over r0 with the return map on board.
 *
 * For each candidate r0 one stride is predicted from the estimated apex (return map in float, large
 * integration steps). gait_branch_distance() gives the cost of the stride's end: to be caught by
 * some steady gait, and to travel from that gait to the wanted one. The stride up to heel strike is
 * the same for all candidates and computed once. Candidates that the motor cannot reach before the
 * predicted heel strike are left out.
 *
 * The work is spread over the ticks after the apex. One call of predictive_search_work() does one
 * unit: the stride to heel strike, or one candidate. A step has at most PREDICTIVE_UNITS units.
 * There is an answer from the start, the caller's; better ones replace it. All work is counted in
 * integration steps, so neither its cost nor its bits depend on the machine.
 *
 * Uneven ground shows in apexes with another energy than predicted. The next foothold may take as
 * much again. So the law then wants a minimum apex speed, up to terrain_speed_rad_s, even where
 * less is asked for. On even ground this ends within tens of steps.
 *
 * The mean difference of measured and predicted apex (from a slope, a wrong mass) is learned and
 * added to the predictions. If they are wrong too often nevertheless (PREDICTIVE_UNRELIABLE), the
 * search gives no answers and eq. (16) walks alone. Predictions are still made, for the push-offs
 * that happen, and the search resumes when they are right again.
 */
#ifndef CONTROLLER_LAWS_PREDICTIVE_SEARCH_H
#define CONTROLLER_LAWS_PREDICTIVE_SEARCH_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/laws/gait_branch.h"

#define predictive_search_init REAL_SYMBOL(predictive_search_init)
#define predictive_search_begin REAL_SYMBOL(predictive_search_begin)
#define predictive_search_work REAL_SYMBOL(predictive_search_work)
#define predictive_search_finish REAL_SYMBOL(predictive_search_finish)
#define predictive_search_is_reliable REAL_SYMBOL(predictive_search_is_reliable)

enum {
    PREDICTIVE_COARSE = 16, /* candidates over the whole range, closer together where r0 is small */
    PREDICTIVE_ROUNDS =
        4, /* of refinement: both sides of the best, then the vertex of the parabola */
    PREDICTIVE_UNITS = 2 + PREDICTIVE_COARSE + 3 * PREDICTIVE_ROUNDS, /* bound of units a step */
    PREDICTIVE_UNRELIABLE = 12
};

enum predictive_stage {
    PREDICTIVE_IDLE = 0,   /* the answer is final */
    PREDICTIVE_STRIKE = 1, /* next unit: the stride up to heel strike */
    PREDICTIVE_FIRST = 2,  /* next: the caller's answer as the first candidate */
    PREDICTIVE_SPREAD = 3, /* next: candidates over the range */
    PREDICTIVE_REFINE = 4  /* next: candidates beside the best */
};

/* What the search may use; r0 in metres of spring. */
struct predictive_request {
    struct apex apex;         /* as estimated */
    real target_speed_rad_s;  /* forward apex speed wanted */
    real terrain_speed_rad_s; /* minimum wanted on uneven ground, at most this */
    real r0_first_m;          /* the answer to begin with; stands if nothing better is found */
    real r0_low_m, r0_high_m; /* where candidates may lie */
    /* The motor, which stands at r0_from_m, must be at r0 before heel strike. It can start when the range
     * has been searched. */
    real r0_from_m, motor_speed_m_s, motor_acceleration_m_s2;
    real report_delay_s, tick_s; /* age of the apex at the first unit of work; time a unit takes */
};

struct predictive_search {
    struct walker walker;
    enum predictive_stage stage;
    struct predictive_request request;
    struct gait_branch_point target; /* the gait at the (clamped) target speed */
    real target_speed_rad_s;
    struct stride_result strike; /* apex to heel strike */
    real r0_m;                   /* the best so far */
    real best_cost;              /* NEGATIVE while no candidate has survived */
    real grid_m;                 /* present width of the refinement */
    real middle_m;               /* about which this round refines */
    real cost_at[3];       /* below, at and above the middle; NEGATIVE = none survives there */
    int16_t index;         /* of the next candidate in its stage */
    bool answered;         /* r0_m came from the search */
    struct apex predicted; /* next apex, without bias; valid if has_prediction */
    bool has_prediction;   /* predicted belongs to the push-off that was given last */
    real bias[3];          /* measured minus predicted apex, filtered */
    real last_error;       /* of the predicted stance rate, rad/s */
    real roughness;        /* v^2 l / g wanted because of the ground; 0 = even */
    uint8_t
        misprediction_count;   /* counts up by 3 on a wrong prediction, down by 1 on a right one */
    uint32_t steps, fallbacks; /* answers given, and of these by the caller's first answer */
};

/* Prepares the law for a walker. Returns 0, or -1 when the walker's parameters are out of range. */
int predictive_search_init(struct predictive_search *search, const struct walker_params *params);

/* A new apex: compares it with the last prediction and sets up the search. */
void predictive_search_begin(struct predictive_search *search, const struct gait_branch *branch,
                             const struct predictive_request *request);

/* One unit of work; nothing when the answer is final. Returns true when search->r0_m is worth following: once
 * the range has been searched, at each improvement after that, and when it has become final
 * (search->stage == PREDICTIVE_IDLE). Cost bound: 21 RK4 steps of single support or 11 of double and
 * 19 of single support, one landing each, and one gait_branch_distance(). */
bool predictive_search_work(struct predictive_search *search, const struct gait_branch *branch);

/* Time is up: the answer that stands becomes final. If it came from a candidate, its prediction stands, too. */
void predictive_search_finish(struct predictive_search *search);

/* False while predictions and measured apexes disagree too often. */
bool predictive_search_is_reliable(const struct predictive_search *search);

#endif
