/* Recordings: read right, refused with line and column, played back; the SEAs on a recorded ankle. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "sim_host/plant/plant.h"
#include "sim_host/plant/recorded_person.h"
#include "tests/support/assert_close.h"

static char path[64];

static void write_file(const char *text, size_t bytes)
{
    (void)snprintf(path, sizeof path, "/tmp/test_recording_%ld.csv", (long)getpid());
    FILE *file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(text, 1, bytes, file), bytes);
    ck_assert_int_eq(fclose(file), 0);
}

static void forget_file(void)
{
    (void)unlink(path);
}

static enum recording_error load(const char *text, struct recording *recording, char *message)
{
    struct recording_format format;
    recording_format_default(&format);
    write_file(text, strlen(text));
    const enum recording_error error = recording_load(recording, path, &format, message);
    forget_file();
    return error;
}

#define HEADER                                                                                \
    "time_s,thigh_l_deg,shank_l_deg,contact_l,thigh_r_deg,shank_r_deg,contact_r,ankle_l_deg," \
    "ankle_r_deg\n"

START_TEST(values_are_read_and_turned_into_leg_and_ankle)
{
    struct recording recording;
    char message[RECORDING_ERROR_MAX];
    ck_assert_int_eq(load(HEADER "10.0,20,-30,1,5.5,1e1,0,-20,3\r\n"
                                 "10.005, 21 ,-29,1,6,11,1,-19.5,3.5\n\n",
                          &recording, message),
                     RECORDING_OK);
    ck_assert_uint_eq(recording.count, 2);
    ck_assert(recording.has_contact);
    assert_close(recording.start_s, 10.0, 0.0, 0.0);
    const struct recording_sample *s = recording.samples;
    const double deg = 3.14159265358979323846 / 180.0;
    assert_close(s[0].time_s, 0.0, 0.0, 0.0);
    assert_close(s[1].time_s, 0.005, 1e-12, 0.0);
    assert_close(s[0].leg_angle_rad[SIDE_LEFT],
                 atan2(sin(20 * deg) + sin(-30 * deg), cos(20 * deg) + cos(-30 * deg)), 1e-14, 0.0);
    assert_close(s[0].leg_angle_rad[SIDE_RIGHT],
                 atan2(sin(5.5 * deg) + sin(10 * deg), cos(5.5 * deg) + cos(10 * deg)), 1e-14, 0.0);
    assert_close(s[0].ankle_m[SIDE_LEFT], 0.12 * sin(20 * deg), 1e-14, 0.0); /* plantarflexed */
    assert_close(s[0].ankle_m[SIDE_RIGHT], 0.0, 0.0, 0.0);                   /* dorsiflexed */
    ck_assert(s[0].contact[SIDE_LEFT] && !s[0].contact[SIDE_RIGHT] && s[1].contact[SIDE_RIGHT]);
    recording_free(&recording);
    ck_assert_ptr_null(recording.samples);
    recording_free(&recording); /* twice is harmless */
}
END_TEST

START_TEST(other_names_rates_and_order)
{
    struct recording recording;
    struct recording_format format;
    char message[RECORDING_ERROR_MAX];
    static const char TEXT[] = "\xEF\xBB\xBF"
                               "extra,\"RS\",RT,LS,LT\n"
                               "x,1,2,3,4\n"
                               "y,5,6,7,8\n"
                               "z,9,10,11,12";
    recording_format_default(&format);
    strcpy(format.time_column, "");
    strcpy(format.thigh_column[SIDE_LEFT], "LT");
    strcpy(format.thigh_column[SIDE_RIGHT], "RT");
    strcpy(format.shank_column[SIDE_LEFT], "LS");
    strcpy(format.shank_column[SIDE_RIGHT], "RS");
    for (int side = 0; side < SIDE_COUNT; side++) {
        strcpy(format.ankle_column[side], "");
        strcpy(format.contact_column[side], "");
    }
    format.sample_rate_hz = 100.0;
    write_file(TEXT, sizeof TEXT - 1);
    ck_assert_int_eq(recording_load(&recording, path, &format, message), RECORDING_OK);
    forget_file();
    const double deg = 3.14159265358979323846 / 180.0;
    ck_assert_uint_eq(recording.count, 3);
    ck_assert(!recording.has_contact);
    assert_close(recording.samples[2].time_s, 0.02, 1e-15, 0.0);
    assert_close(recording.samples[1].leg_angle_rad[SIDE_RIGHT], 5.5 * deg, 1e-14, 0.0);
    assert_close(recording.samples[1].leg_angle_rad[SIDE_LEFT], 7.5 * deg, 1e-14, 0.0);
    assert_close(recording.samples[1].ankle_m[SIDE_LEFT], 0.0, 0.0, 0.0);
    assert_close(recording_span_rad(&recording), 8.0 * deg, 1e-14, 0.0);
    recording_free(&recording);
}
END_TEST

START_TEST(angles_in_radians)
{
    struct recording recording;
    struct recording_format format;
    char message[RECORDING_ERROR_MAX];
    static const char TEXT[] = HEADER "0,0.3,-0.1,1,0,0,1,-0.5,0\n0.005,0.4,-0.2,1,0,0,1,-0.5,0\n";
    recording_format_default(&format);
    format.angle_unit_rad = 1.0;
    write_file(TEXT, sizeof TEXT - 1);
    ck_assert_int_eq(recording_load(&recording, path, &format, message), RECORDING_OK);
    assert_close(recording.samples[0].leg_angle_rad[SIDE_LEFT], 0.1, 1e-15, 0.0);
    assert_close(recording.samples[0].ankle_m[SIDE_LEFT], 0.12 * sin(0.5), 1e-15, 0.0);
    recording_free(&recording);
    static const char TOO_FAR[] = HEADER "0,3.2,0,1,0,0,1,0,0\n0.005,0,0,1,0,0,1,0,0\n";
    write_file(TOO_FAR, sizeof TOO_FAR - 1);
    ck_assert_int_eq(recording_load(&recording, path, &format, message), RECORDING_BAD_VALUE);
    ck_assert_ptr_nonnull(strstr(message, "line 2, column 2: '3.2' is not an angle"));
    format.angle_unit_rad = 0.0;
    ck_assert_int_eq(recording_load(&recording, path, &format, message), RECORDING_BAD_FORMAT);
    forget_file();
}
END_TEST

#define ROW "0.005,1,1,1,1,1,1,1,1\n"

static const struct {
    const char *text;
    enum recording_error error;
    const char *says;
} MALFORMED[] = {
    {"", RECORDING_BAD_HEADER, "empty"},
    {"\n\n", RECORDING_BAD_HEADER, "empty"},
    {"a,b,c\n1,2,3\n", RECORDING_BAD_HEADER, "no column named 'time_s'"},
    {"time_s,time_s\n", RECORDING_BAD_HEADER, "line 1, column 2: column 'time_s' is there twice"},
    {HEADER, RECORDING_TOO_SHORT, "fewer than two rows"},
    {HEADER ROW, RECORDING_TOO_SHORT, "fewer than two rows"},
    {HEADER "0,1,x,1,1,1,1,1,1\n", RECORDING_BAD_VALUE, "line 2, column 3: 'x' is not a number"},
    {HEADER "0,1,,1,1,1,1,1,1\n", RECORDING_BAD_VALUE, "line 2, column 3: '' is not a number"},
    {HEADER "0,1,1,1,nan,1,1,1,1\n", RECORDING_BAD_VALUE, "line 2, column 5: 'nan'"},
    {HEADER "inf,1,1,1,1,1,1,1,1\n", RECORDING_BAD_VALUE, "line 2, column 1: 'inf'"},
    {HEADER "0,1,1e999,1,1,1,1,1,1\n", RECORDING_BAD_VALUE, "line 2, column 3"},
    {HEADER "0,1,1 1,1,1,1,1,1,1\n", RECORDING_BAD_VALUE, "'1 1' is not a number"},
    {HEADER "0,1,1,0.5,1,1,1,1,1\n", RECORDING_BAD_VALUE, "column 4: '0.5' is not a contact"},
    {HEADER "0,1,1,2,1,1,1,1,1\n", RECORDING_BAD_VALUE, "is not a contact"},
    {HEADER "0,181,1,1,1,1,1,1,1\n", RECORDING_BAD_VALUE, "column 2: '181' is not an angle"},
    {HEADER "0,100,-100,1,1,1,1,1,1\n", RECORDING_BAD_VALUE, "opposite directions"},
    {HEADER "0,1,1,1,1,1,1,1\n", RECORDING_BAD_ROW, "line 2: 8 columns where the header has 9"},
    {HEADER "0,1,1,1,1,1,1,1,1,7\n", RECORDING_BAD_ROW, "10 columns"},
    {HEADER ROW ROW, RECORDING_BAD_TIME, "line 3, column 1: time does not ascend"},
    {HEADER "0,1,1,1,1,1,1,1,1\n\n0.2,1,1,1,1,1,1,1,1\n", RECORDING_BAD_TIME, "line 4, column 1"},
    {HEADER
     "0,1,1,1,1,1,1,1,1\n0.000000000000000000000000000000000000000000000000001,1,1,1,1,1,1,1,"
     "1\n",
     RECORDING_BAD_VALUE, "is not a number"},
};

START_TEST(malformed_files_are_refused_with_their_place)
{
    struct recording recording;
    char message[RECORDING_ERROR_MAX];
    ck_assert_int_eq(load(MALFORMED[_i].text, &recording, message), MALFORMED[_i].error);
    ck_assert_msg(strstr(message, MALFORMED[_i].says) != NULL, "said: %s", message);
    ck_assert_ptr_null(recording.samples);
    ck_assert_uint_eq(recording.count, 0);
}
END_TEST

START_TEST(files_that_cannot_be_read)
{
    struct recording recording;
    struct recording_format format;
    char message[RECORDING_ERROR_MAX];
    static const char ZERO[] = HEADER "0,1,1,1,1,1,1,1,1\n" ROW "\0 binary";
    recording_format_default(&format);
    ck_assert_int_eq(recording_load(&recording, "/nonexistent/file.csv", &format, message),
                     RECORDING_CANNOT_READ);
    ck_assert_ptr_nonnull(strstr(message, "/nonexistent/file.csv"));
    ck_assert_int_eq(recording_load(&recording, "/tmp", &format, message), RECORDING_CANNOT_READ);
    write_file(ZERO, sizeof ZERO - 1);
    ck_assert_int_eq(recording_load(&recording, path, &format, message), RECORDING_BAD_VALUE);
    forget_file();
    ck_assert_ptr_nonnull(strstr(message, "zero byte"));
    format.ankle[SIDE_RIGHT].lever_m = 0.0;
    ck_assert_int_eq(recording_load(&recording, "/tmp", &format, message), RECORDING_BAD_FORMAT);
    ck_assert_ptr_nonnull(strstr(message, "right ankle's lever_m"));
}
END_TEST

START_TEST(torn_and_random_files_never_crash)
{
    static const char GOOD[] = HEADER "0,1,1,1,1,1,1,1,1\n" ROW;
    struct recording recording;
    struct recording_format format;
    char message[RECORDING_ERROR_MAX], text[400];
    uint64_t state = 12345;
    recording_format_default(&format);
    for (int i = 0; i < 3000; i++) {
        size_t length = sizeof GOOD - 1;
        memcpy(text, GOOD, length);
        for (int k = 0; k < 1 + i % 4; k++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            text[(state >> 33) % length] = (char)(state >> 56);
        }
        length -= (state >> 20) % 40;
        write_file(text, length);
        if (recording_load(&recording, path, &format, message) == RECORDING_OK) {
            ck_assert_uint_ge(recording.count, 2);
        } else {
            ck_assert(message[0] != '\0');
        }
        recording_free(&recording);
        forget_file();
    }
}
END_TEST

/* A person made of sines: 1 Hz strides at 200 Hz, feet on the ground 60 % of the stride, the ankle
 * plantarflexing to 20 degrees towards the end of stance. */
static double person_angle(double t, int side)
{
    return 0.35 * cos(6.283185307179586 * (t - (side == SIDE_LEFT ? 0.0 : 0.5)));
}

static bool person_contact(double t, int side)
{
    const double phase = t - (side == SIDE_LEFT ? 0.0 : 0.5) + 1.0;
    return phase - floor(phase) < 0.6;
}

static double person_ankle_deg(double t, int side)
{
    double phase = t - (side == SIDE_LEFT ? 0.0 : 0.5) + 1.0;
    phase -= floor(phase);
    return phase > 0.45 && phase < 0.75 ? -20.0 * pow(sin((phase - 0.45) / 0.3 * 3.14159265), 2.0)
                                        : 5.0;
}

static void write_person(double seconds)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    ck_assert_ptr_nonnull(stream);
    fputs(HEADER, stream);
    for (int i = 0; i <= (int)(seconds * 200.0); i++) {
        const double t = i / 200.0, deg = 180.0 / 3.14159265358979323846;
        /* Knee bent by 20 degrees: thigh forward, shank back, same leg. */
        const double l = person_angle(t, 0) * deg, r = person_angle(t, 1) * deg;
        fprintf(stream, "%.4f,%.6f,%.6f,%d,%.6f,%.6f,%d,%.6f,%.6f\n", t, l + 10, l - 10,
                person_contact(t, 0), r + 10, r - 10, person_contact(t, 1), person_ankle_deg(t, 0),
                person_ankle_deg(t, 1));
    }
    ck_assert_int_eq(fclose(stream), 0);
    write_file(text, size);
    free(text);
}

START_TEST(between_samples_the_motion_is_smooth)
{
    struct recording recording;
    struct recording_format format;
    struct recorded_person_state state;
    char message[RECORDING_ERROR_MAX];
    size_t cursor = 0;
    recording_format_default(&format);
    write_person(3.0);
    ck_assert_int_eq(recording_load(&recording, path, &format, message), RECORDING_OK);
    forget_file();
    for (int tick = 10; tick < 2980; tick++) {
        const double t = tick * 1e-3;
        recorded_person_at(&recording, t, &cursor, &state);
        for (int side = 0; side < SIDE_COUNT; side++) {
            assert_close(state.leg_angle_rad[side], person_angle(t, side), 2e-6, 0.0);
            const double rate =
                (person_angle(t + 1e-6, side) - person_angle(t - 1e-6, side)) / 2e-6;
            assert_close(state.leg_rate_rad_s[side], rate, 2e-3, 0.0);
            ck_assert(state.ankle_m[side] >= 0.0);
        }
        ck_assert(!state.finished);
    }
    /* Backwards too, and beyond both ends. */
    recorded_person_at(&recording, 1.0, &cursor, &state);
    assert_close(state.leg_angle_rad[0], person_angle(1.0, 0), 1e-7, 0.0);
    recorded_person_at(&recording, -5.0, &cursor, &state);
    assert_close(state.leg_angle_rad[0], person_angle(0.0, 0), 1e-7, 0.0);
    assert_close(state.leg_rate_rad_s[0], 0.0, 0.0, 0.0);
    recorded_person_at(&recording, 99.0, &cursor, &state);
    ck_assert(state.finished);
    assert_close(state.leg_angle_rad[0], person_angle(3.0, 0), 1e-7, 0.0);
    recording_free(&recording);
}
END_TEST

START_TEST(the_actuators_work_against_the_recorded_ankle)
{
    struct plant_config config;
    static struct plant plant;
    char message[PLANT_ERROR_MAX];
    const struct walker3_params adult = {65.0, 2.5, 0.93, 9.80665};
    plant_config_for(&adult, 7000.0, SEA_REAL, SENSORS_IDEAL, &config);
    config.kind = PLANT_RECORDED_PERSON;
    config.recording_start_tick = 500;
    for (int side = 0; side < SIDE_COUNT; side++) {
        foot_switch_preset(FOOT_SWITCH_EXACT, 1, (uint64_t)side, &config.foot_switch[side]);
    }
    write_person(6.2);
    strcpy(config.recording_path, path);
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
    forget_file();
    int count[9] = {0};
    double work_at_release = 0.0, most_N = 0.0, most_compressed_m = 0.0;
    for (int tick = 0; tick < 6700; tick++) {
        struct sensor_sample sample;
        struct sea_output out;
        struct walk_event event;
        struct plant_truth truth;
        plant_truth(&plant, &truth);
        for (int i = 0; i < SIDE_COUNT; i++) {
            const enum side side = (enum side)i;
            /* Load in stance behind the vertical, else back. */
            const bool late = truth.contact[side] && truth.leg_angle_rad[side] < 0.0;
            const bool pushes = plant.sea[side].latch == SEA_LATCH_RELEASED;
            const struct sea_command command = {SEA_POSITION, late || pushes ? 0.03 : 0.0, late};
            plant_set_command(&plant, side, &command);
            plant_sample(&plant, side, &sample);
            plant_sea_output(&plant, side, &out);
            assert_close(sample.leg_angle_rad, truth.leg_angle_rad[side], 1e-6, 0.0);
            most_N = fmax(most_N, out.ankle_force_N);
            if (!truth.contact[side] && out.latch == SEA_LATCH_CLOSED) {
                assert_close(out.ankle_force_N, 0.0, 0.0, 0.0);
            }
        }
        plant_advance(&plant);
        while (plant_next_event(&plant, &event)) {
            count[event.kind]++;
            if (event.kind == WALK_EVENT_HEEL_STRIKE) {
                /* Recorded at whole strides and halves, plus the start. */
                const double strides = (event.time_s - 0.5) * 2.0;
                assert_close(strides, round(strides), 1e-9, 0.0);
            }
            if (event.kind == WALK_EVENT_APEX) {
                const double t = event.time_s - 0.5;
                assert_close(person_angle(t, (int)event.side), 0.0, 1e-5, 0.0);
                assert_close(event.value, 0.35 * 6.2831853, 1e-3, 0.0);
                ck_assert(person_contact(t, (int)event.side));
            }
            if (event.kind == WALK_EVENT_RELEASE) {
                const double compressed_m = fmax(event.value - truth.ankle_m[event.side], 0.0);
                work_at_release += 0.5 * 7000.0 * compressed_m * compressed_m;
                most_compressed_m = fmax(most_compressed_m, compressed_m);
            }
        }
    }
    ck_assert_int_eq(count[WALK_EVENT_APEX], 12);
    ck_assert_int_eq(count[WALK_EVENT_HEEL_STRIKE], 12);
    ck_assert_int_eq(count[WALK_EVENT_TOE_OFF], 13); /* one foot leaves at 0.1 s already */
    ck_assert_int_ge(count[WALK_EVENT_RELEASE], 11);
    ck_assert_int_ge(count[WALK_EVENT_RECLOSED], 10);
    struct plant_energy energy;
    plant_energy(&plant, &energy);
    const double work = energy.device_work_J[0] + energy.device_work_J[1];
    /* The recorded ankle extends to 4.1 cm, past the motors' 3 cm: the springs give all they have,
     * and what little the motors, still on their way, add meanwhile. */
    ck_assert_msg(work > 0.9 * work_at_release && work < 1.1 * work_at_release, "%g of %g J", work,
                  work_at_release);
    /* The other foot's contact releases it: the ankle has begun to extend by then. */
    assert_close(most_N, 7000.0 * most_compressed_m, 10.0, 0.0);
    ck_assert(most_N > 100.0 && most_N <= 215.0);
    plant_free(&plant);
}
END_TEST

START_TEST(a_plant_without_its_recording_is_refused)
{
    struct plant_config config;
    static struct plant plant;
    char message[PLANT_ERROR_MAX];
    plant_config_default(&config);
    config.kind = PLANT_RECORDED_PERSON;
    strcpy(config.recording_path, "/nonexistent.csv");
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_RECORDING);
    ck_assert_ptr_nonnull(strstr(message, "/nonexistent.csv"));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("recorded_person");
    TCase *reading = tcase_create("reading"), *playing = tcase_create("playing");
    tcase_add_test(reading, values_are_read_and_turned_into_leg_and_ankle);
    tcase_add_test(reading, other_names_rates_and_order);
    tcase_add_test(reading, angles_in_radians);
    tcase_add_loop_test(reading, malformed_files_are_refused_with_their_place, 0,
                        sizeof MALFORMED / sizeof MALFORMED[0]);
    tcase_add_test(reading, files_that_cannot_be_read);
    tcase_add_test(reading, torn_and_random_files_never_crash);
    tcase_add_test(playing, between_samples_the_motion_is_smooth);
    tcase_add_test(playing, the_actuators_work_against_the_recorded_ankle);
    tcase_add_test(playing, a_plant_without_its_recording_is_refused);
    suite_add_tcase(suite, reading);
    suite_add_tcase(suite, playing);
    return run_suite(suite);
}
