/* The ground that a reflex person walks on: a slope, a height of its own for every foothold, and a stair (plant.h). A
 * foothold is laid below a foot in swing, once its leg is ahead of the hip and its sole above it. So no foot is lifted
 * by the ground, and no foot stumbles over one before it. Over a stair's edge it does. */
#include "model/trig.h"
#include "sim_host/plant/plant_internal.h"
#include "sim_host/plant/walk_internal.h"

/* Turns the slope line to the present slope, about the foot that is ahead on the ground. */
static void follow_slope(struct plant *plant)
{
    struct ground_line *line = &plant->slope_line;
    double sine, cosine, pivot_m = 0.0;
    bool stands = false;
    trig_sincos_f64(plant->walk.params.slope_rad, &sine, &cosine);
    const double slope = sine / cosine;
    if (slope == line->slope) {
        return;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        const double ball_m = reflex_person_ball(&plant->reflex, (enum side)side).x;
        if (plant->person.contact[side] && (!stands || ball_m > pivot_m)) {
            pivot_m = ball_m;
            stands = true;
        }
    }
    if (stands) {
        line->height_m += (line->slope - slope) * pivot_m;
        line->slope = slope;
    }
}

/* ---- a stair ----------------------------------------------------------------------------- */

static const double AHEAD_LEGS = 0.3; /* of the ball that is foremost, when it is laid */

void plant_lay_reflex_stair(struct plant *plant, double rise_m)
{
    const double left_m = reflex_person_ball(&plant->reflex, SIDE_LEFT).x,
                 right_m = reflex_person_ball(&plant->reflex, SIDE_RIGHT).x;
    if (plant->stair.rise_m != 0.0) {
        return;
    }
    plant->stair = (struct plant_stair){.rise_m = rise_m,
                                        .edge_m = (left_m > right_m ? left_m : right_m) +
                                                  AHEAD_LEGS * plant->reflex.params.leg_m};
}

/* A heel or a ball at the edge: over it, or stopped by it. */
static bool pass_edge(struct plant *plant, enum side side, enum foot_point point)
{
    const struct plant_stair *stair = &plant->stair;
    struct reflex_person *reflex = &plant->reflex;
    if (stair->passed[side][point]) {
        return true;
    }
    if (reflex->contact[side][point].touches ||
        reflex_person_place(reflex, side, point).x < stair->edge_m) {
        return false;
    }
    struct ground_line behind = reflex->ground[side][point];
    behind.height_m += stair->rise_m;
    if (reflex_person_lay_ground(reflex, side, point, &behind)) {
        return true;
    }
    reflex_person_trip(reflex, side, point);
    return false;
}

/* Once both feet are behind the edge, all ground is as high as that behind it. */
static void climb_stair(struct plant *plant)
{
    struct plant_stair *stair = &plant->stair;
    bool all = true;
    if (stair->rise_m == 0.0) {
        return;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int point = 0; point < FOOT_POINTS; point++) {
            stair->passed[side][point] = pass_edge(plant, (enum side)side, (enum foot_point)point);
            all = all && stair->passed[side][point];
        }
    }
    if (all) {
        plant->slope_line.height_m += stair->rise_m;
        *stair = (struct plant_stair){.rise_m = 0.0};
    }
}

/* ---- footholds --------------------------------------------------------------------------- */

static bool lay_next_foothold(struct plant *plant, enum side side)
{
    struct ground_line foothold[FOOT_POINTS];
    for (int point = 0; point < FOOT_POINTS; point++) {
        foothold[point] = plant->slope_line;
        foothold[point].height_m += plant->next_foothold_height_m;
        if (plant->stair.passed[side][point]) {
            foothold[point].height_m += plant->stair.rise_m;
        }
    }
    return reflex_person_lay_foothold(&plant->reflex, side, foothold);
}

void plant_lay_reflex_ground(struct plant *plant)
{
    follow_slope(plant);
    climb_stair(plant);
    for (int side = 0; side < SIDE_COUNT; side++) {
        const bool in_swing =
            !plant->person.contact[side] && plant->person.leg_angle_rad[side] > 0.0;
        if (!plant->person.contact[side] && plant->person.leg_angle_rad[side] <= 0.0) {
            plant->foothold_laid[side] = false;
        }
        if (in_swing && !plant->foothold_laid[side] && lay_next_foothold(plant, (enum side)side)) {
            plant->foothold_laid[side] = true;
            plant_pass_foothold(plant);
        }
    }
}
