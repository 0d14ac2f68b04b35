#include "sim_host/cli/walker_report.h"

#include <stdio.h>

#include "sim_host/cli/json_writer.h"

void walker_report_json(const struct walker_figures *figures, const struct can_bus_status *status)
{
    struct json_writer json;
    json_begin(&json, stdout);
    json_open_object(&json, NULL);
    json_unsigned(&json, "steps", figures->apexes);
    json_unsigned(&json, "falls", figures->falls);
    json_text(&json, "last_fall", figures->last_fall);
    json_unsigned(&json, "sync_ticks", figures->sync_ticks);
    json_unsigned(&json, "clock_ticks", figures->clock_ticks);
    json_unsigned(&json, "silences", figures->silences);
    json_unsigned(&json, "unanswered", figures->unanswered);
    json_unsigned(&json, "rx_frames", status->rx_frames);
    json_unsigned(&json, "tx_frames", status->tx_frames);
    json_unsigned(&json, "tx_refused", status->tx_refused);
    json_unsigned(&json, "rx_overflow", status->rx_overflow);
    json_unsigned(&json, "error_frames", status->error_frames);
    json_unsigned(&json, "bus_off", status->bus_off_count);
    json_unsigned(&json, "kernel_full", figures->kernel_full);
    json_unsigned(&json, "went_down", figures->went_down);
    json_open_list(&json, "apex_speed_rad_s");
    for (unsigned i = 0; i < figures->apexes; i++) {
        json_number(&json, NULL, figures->apex_speed_rad_s[i], 9);
    }
    json_close_list(&json);
    json_close_object(&json);
    json_end(&json);
}

void walker_report_text(const struct walker_figures *figures, const struct can_bus_status *status)
{
    printf("%u steps, %u falls%s%s\n", figures->apexes, figures->falls,
           figures->falls > 0 ? ", last: " : "", figures->last_fall);
    if (figures->apexes > 0) {
        printf("last apex speed %.4f rad/s\n", figures->apex_speed_rad_s[figures->apexes - 1]);
    }
    printf("%llu ticks by SYNC (%llu heard too late to be answered), %llu by the clock in %llu "
           "silences\n",
           (unsigned long long)figures->sync_ticks, (unsigned long long)figures->unanswered,
           (unsigned long long)figures->clock_ticks, (unsigned long long)figures->silences);
    printf("%s: %u frames received, %u sent, %u refused, %u lost in the queue, %u error frames, "
           "%u times bus-off, %u times down\n",
           figures->interface, status->rx_frames, status->tx_frames, status->tx_refused,
           status->rx_overflow, status->error_frames, status->bus_off_count, figures->went_down);
}
