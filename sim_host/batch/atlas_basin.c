#include <stdlib.h>

#include "sim_host/batch/atlas.h"
#include "sim_host/batch/batch.h"

double atlas_at(const struct atlas_axis *axis, int i)
{
    return axis->count < 2 ? axis->from
                           : axis->from + (axis->to - axis->from) * i / (axis->count - 1);
}

int atlas_basin_compute(void *context, size_t chunk, void *result)
{
    const struct atlas_basin *basin = context;
    const struct batch_walker walker = {basin->hip_mass_kg, basin->leg_mass_kg, basin->leg_length_m,
                                        basin->ankle_stiffness_N_m, basin->gravity_m_s2};
    const struct batch_settings settings = {.accuracy = basin->accuracy};
    const size_t rates = (size_t)basin->rate.count, count = (size_t)basin->swing.count * rates;
    unsigned char *byte = result;
    struct batch_item *items = calloc(count, sizeof *items);
    const struct batch_job job = {.walkers = &walker,
                                  .walker_count = 1,
                                  .items = items,
                                  .count = count,
                                  .strides = basin->strides};
    if (items == NULL) {
        return 1;
    }
    for (size_t i = 0; i < count; i++) {
        items[i].apex[0] = -atlas_at(&basin->speed, (int)chunk);
        items[i].apex[1] = atlas_at(&basin->swing, (int)(i / rates));
        items[i].apex[2] = atlas_at(&basin->rate, (int)(i % rates));
        items[i].push_m = basin->push_m;
    }
    const enum batch_error error = batch_run(&settings, &job);
    for (size_t i = 0; i < count; i++) {
        byte[i] = (unsigned char)(items[i].fault == 0 ? ATLAS_WALKS : items[i].strides);
    }
    free(items);
    return error != BATCH_OK;
}

struct chunks_job atlas_basin_job(struct atlas_basin *basin, const char *path)
{
    const double numbers[] = {1.0, /* of this way to compute it */
                              basin->hip_mass_kg,
                              basin->leg_mass_kg,
                              basin->leg_length_m,
                              basin->ankle_stiffness_N_m,
                              basin->gravity_m_s2,
                              basin->push_m,
                              basin->accuracy,
                              basin->speed.from,
                              basin->speed.to,
                              basin->swing.from,
                              basin->swing.to,
                              basin->rate.from,
                              basin->rate.to,
                              basin->strides};
    const struct chunks_job job = {.path = path,
                                   .key = chunks_key(CHUNKS_KEY_START, numbers, sizeof numbers),
                                   .count = (size_t)basin->speed.count,
                                   .bytes = (size_t)basin->swing.count * (size_t)basin->rate.count,
                                   .compute = atlas_basin_compute,
                                   .context = basin};
    return job;
}
