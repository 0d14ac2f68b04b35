/* The ground that a reflex person walks on: a slope, and a height of its own for every foothold (plant.h). A foothold is
 * laid below a foot in swing, once its leg is ahead of the hip and its sole above it. So no foot is lifted by the
 * ground, and no foot stumbles over one before it. */
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

void plant_lay_reflex_ground(struct plant *plant)
{
    follow_slope(plant);
    for (int side = 0; side < SIDE_COUNT; side++) {
        const bool in_swing =
            !plant->person.contact[side] && plant->person.leg_angle_rad[side] > 0.0;
        struct ground_line foothold = plant->slope_line;
        foothold.height_m += plant->next_foothold_height_m;
        if (!plant->person.contact[side] && plant->person.leg_angle_rad[side] <= 0.0) {
            plant->foothold_laid[side] = false;
        }
        if (in_swing && !plant->foothold_laid[side] &&
            reflex_person_lay_ground(&plant->reflex, (enum side)side, &foothold)) {
            plant->foothold_laid[side] = true;
            plant_pass_foothold(plant);
        }
    }
}
