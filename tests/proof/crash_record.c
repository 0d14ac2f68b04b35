/* The crash record in memory that holds anything after power-up. */
#include "hal/storage/crash_record.h"
#include "tests/proof/arbitrary.h"

void proof_crash_record(void)
{
    static struct crash_record record;
    static struct crash_streak streak;
    for (;;) {
        any_bytes((uint8_t *)&record, sizeof record);
        any_bytes((uint8_t *)&streak, sizeof streak);
        (void)crash_record_is_valid(&record);
        (void)crash_record_count(&record);
        if (any_bool()) {
            crash_record_acknowledge(&record);
        }
        crash_record_begin(&record);
        crash_record_seal(&record);
        crash_streak_add(&streak);
        (void)crash_streak_length(&streak);
        crash_streak_end(&streak);
    }
}
