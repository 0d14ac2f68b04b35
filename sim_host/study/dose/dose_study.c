#include "sim_host/study/dose/dose_study.h"

uint32_t dose_study_walks(const struct dose_study *study)
{
    return study->persons * study->seeds * (1u + study->lates * study->r0s);
}

uint32_t dose_study_number(const struct dose_study *study, uint32_t person, uint32_t seed)
{
    return (person * study->seeds + seed) * (1u + study->lates * study->r0s);
}

const struct dose_result *dose_study_alone(const struct dose_study *study, uint32_t person,
                                           uint32_t seed)
{
    return &study->result[dose_study_number(study, person, seed)];
}

const struct dose_result *dose_study_with(const struct dose_study *study, uint32_t person,
                                          uint32_t seed, uint32_t late, uint32_t r0)
{
    return &study->result[dose_study_number(study, person, seed) + 1u + late * study->r0s + r0];
}

void dose_study_trial(const struct dose_study *study, uint32_t index, struct dose_trial *trial)
{
    const uint32_t a_block = 1u + study->lates * study->r0s;
    const uint32_t block = index / a_block, cell = index % a_block;
    *trial = (struct dose_trial){.person_path = study->person[block / study->seeds],
                                 .device_path = study->device,
                                 .without_device = cell == 0,
                                 .r0_m = study->r0_m[cell == 0 ? 0 : (cell - 1) % study->r0s],
                                 .late_s = cell == 0 ? 0.0 : study->late_s[(cell - 1) / study->r0s],
                                 .seed = 1u + block % study->seeds,
                                 .steps = study->steps,
                                 .push_step_N = study->push_step_N};
}
