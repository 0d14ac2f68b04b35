/* Heights of the footholds, one after the other: a walker's and a reflex person's. */
#include "sim_host/plant/plant_internal.h"

/* Height of foothold n (from 1 on) above the slope line. */
static double height_of_foothold(struct plant *plant, uint64_t n)
{
    const struct plant_config *config = &plant->config;
    double height_m = 0.0;
    if (n >= 1 && n <= config->heights_count) {
        height_m = config->heights_m[n - 1];
    }
    if (config->roughness_m > 0.0) {
        height_m += config->roughness_m * rng_normal(&plant->ground_rng);
    }
    return height_m;
}

void plant_lay_foothold(struct plant *plant)
{
    const double height_m = height_of_foothold(plant, plant->footholds + 1);
    walk_set_next_height(&plant->walk, height_m - plant->foothold_height_m);
    plant->next_foothold_height_m = height_m;
}

void plant_pass_foothold(struct plant *plant)
{
    plant->footholds++;
    plant->foothold_height_m = plant->next_foothold_height_m;
    plant_lay_foothold(plant);
}
