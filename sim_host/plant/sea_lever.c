/* The lever that a spring's end has at the ankle: constant, or a table over the angle. */
#include "model/trig.h"
#include "sim_host/plant/sea_config.h"

double sea_lever_at_m(const struct sea_table *table, double lever_m, double angle_rad)
{
    if (table->count == 0) {
        return lever_m * trig_cos_f64(angle_rad);
    }
    int i = 0;
    while (i < table->count && table->x[i] <= angle_rad) {
        i++;
    }
    if (i == 0 || i == table->count) {
        return table->y[i == 0 ? 0 : i - 1];
    }
    const double u = (angle_rad - table->x[i - 1]) / (table->x[i] - table->x[i - 1]);
    return table->y[i - 1] + u * (table->y[i] - table->y[i - 1]);
}

double sea_lever_way_m(const struct sea_table *table, double lever_m, double angle_rad)
{
    if (table->count == 0) {
        return lever_m * trig_sin_f64(angle_rad);
    }
    /* The lever is a broken line, so between its corners the trapezium is exact. */
    const double low = angle_rad < 0.0 ? angle_rad : 0.0, high = angle_rad < 0.0 ? 0.0 : angle_rad;
    double way_m = 0.0, from = low;
    for (int i = 0; i <= table->count && from < high; i++) {
        double to = high;
        if (i < table->count && table->x[i] < high) {
            to = table->x[i];
        }
        if (to > from) {
            way_m += 0.5 * (to - from) *
                     (sea_lever_at_m(table, lever_m, from) + sea_lever_at_m(table, lever_m, to));
            from = to;
        }
    }
    return angle_rad < 0.0 ? -way_m : way_m;
}

double sea_lever_angle_rad(const struct sea_table *table, double lever_m, double way_m)
{
    double low_rad = -1.5, high_rad = 1.5;
    for (int i = 0; i < 60; i++) {
        const double middle_rad = 0.5 * (low_rad + high_rad);
        if (sea_lever_way_m(table, lever_m, middle_rad) < way_m) {
            low_rad = middle_rad;
        } else {
            high_rad = middle_rad;
        }
    }
    return 0.5 * (low_rad + high_rad);
}

double sea_lever_at_way_m(const struct sea_table *table, double lever_m, double way_m)
{
    return sea_lever_at_m(table, lever_m, sea_lever_angle_rad(table, lever_m, way_m));
}

double sea_config_lever_at_m(const struct sea_config *config, double angle_rad)
{
    return sea_lever_at_m(&config->lever_table, config->lever_m, angle_rad);
}

double sea_config_way_at_m(const struct sea_config *config, double angle_rad)
{
    return sea_lever_way_m(&config->lever_table, config->lever_m, angle_rad);
}
