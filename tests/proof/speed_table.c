/* The speed table and its inverse: any table that the check has passed, any r0 and any speed, NaN included. */
#include "controller/laws/speed_table.h"
#include "tests/proof/arbitrary.h"

static struct speed_table table;

void proof_speed_table(void)
{
    for (;;) {
        table.count = any_u32;
        table.r0_min_m = any_float;
        table.r0_step_m = any_float;
        for (int i = 0; i < SPEED_TABLE_MAX; i++) {
            table.speed_rad_s[i] = any_float;
        }
        if (speed_table_check(&table) == SPEED_TABLE_OK) {
            (void)speed_table_inverse(&table, any_float);
            (void)speed_table_speed(&table, any_float);
        }
    }
}
