/* The muscle section of a person file: what it says comes to the muscles, and what is wrong is refused with its line. */
#include "sim_host/persons/person.h"
#include "tests/support/assert_close.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char body[] = "[person]\ntorso_mass_kg = 65\nleg_mass_kg = 2.5\nleg_length_m = 0.93\n";

static struct person person;
static char message[PERSON_MESSAGE_MAX];

/* Reads the body with this behind it; the first line of text is the file's fifth. */
static int read_with(const char *text)
{
    char path[] = "/tmp/afo-person-XXXXXX";
    const int file = mkstemp(path);
    ck_assert_int_ge(file, 0);
    FILE *stream = fdopen(file, "w");
    fprintf(stream, "%s%s", body, text);
    ck_assert_int_eq(fclose(stream), 0);
    const int result = person_read(&person, path, message);
    unlink(path);
    return result;
}

static struct reflex_person_params made(void)
{
    struct reflex_person_params params;
    reflex_person_default(70.0, 0.93, &params);
    person_muscles_apply(&person.muscles, &params);
    return params;
}

START_TEST(without_the_section_a_person_is_healthy_and_quiet)
{
    struct reflex_gains healthy;
    struct reflex_person_params params, plain;
    reflex_gains_healthy(&healthy);
    ck_assert_msg(read_with("") == 0, "%s", message);
    ck_assert(!person_muscles_given(&person.muscles));
    reflex_person_default(70.0, 0.93, &plain);
    params = made();
    ck_assert_mem_eq(&params, &plain, sizeof params);
    ck_assert_mem_eq(&params.gains, &healthy, sizeof healthy);
    ck_assert(params.noise_share == REFLEX_NOISE_NONE);
}
END_TEST

START_TEST(what_is_said_comes_to_the_muscles)
{
    ck_assert_msg(read_with("[muscles]\nnoise = 2\nreflexes = published\nsol_force = 1.5\n"
                            "start_speed_m_s = 1.1\nstart_lean_rad = 0.08\nta_strength = 0.5\n"
                            "[left.muscles]\nsol_strength = 0.4\nta_strength = 0.25\n") == 0,
                  "%s", message);
    struct reflex_person_params plain, params = made();
    reflex_person_default(70.0, 0.93, &plain);
    assert_close(params.noise_share, 0.02, 0.0, 1e-15);
    assert_close(params.gains.sol_force, 1.5, 0.0, 1e-15);
    assert_close(params.gains.gas_force, 1.1, 0.0, 1e-15); /* Geyer & Herr's */
    assert_close(params.start_speed_m_s, 1.1, 0.0, 1e-15);
    assert_close(params.start_lean_rad, 0.08, 0.0, 1e-15);
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int i = 0; i < MUSCLE_COUNT; i++) {
            double share = 1.0;
            if (i == MUSCLE_TA) {
                share = side == SIDE_LEFT ? 0.25 : 0.5;
            } else if (i == MUSCLE_SOL && side == SIDE_LEFT) {
                share = 0.4;
            }
            assert_close(params.muscle[side][i].force_max_N,
                         share * plain.muscle[side][i].force_max_N, 0.0, 1e-15);
        }
    }
}
END_TEST

START_TEST(every_gain_has_its_key)
{
#define ONE(name, published, unit, meaning)                                                      \
    ck_assert_msg(read_with("[muscles]\nnoise = none\n" #name " = 3.25\n") == 0, "%s", message); \
    ck_assert(made().gains.name == 3.25);
    REFLEX_GAINS(ONE)
#undef ONE
}
END_TEST

START_TEST(what_is_wrong_is_refused_with_its_line)
{
    static const struct {
        const char *text, *words[3];
    } bad[] = {
        {"[muscles]\nsol_force = 1\n", {"lacks key \"noise\"", "none", "%"}},
        {"[left.muscles]\nsol_strength = 1\n", {"lacks key \"noise\"", "none", "%"}},
        {"[muscles]\nnoise = loud\n", {":6:", "\"noise\"", "loud"}},
        {"[muscles]\nnoise = 30\n", {":6:", "\"noise\"", "20"}},
        {"[muscles]\nnoise = 0\n", {":6:", "\"noise\"", "0.01"}},
        {"[muscles]\nnoise = none\nnoise = 2\n", {":7:", "\"noise\"", "twice"}},
        {"[muscles]\nnoise = none\nsol_forse = 1\n", {":7:", "sol_forse", "nearest: sol_force"}},
        {"[muscles]\nnoise = none\nsol_force = nan\n", {":7:", "sol_force", "soleus"}},
        {"[muscles]\nnoise = none\nsol_force = 1000\n", {":7:", "sol_force", "100"}},
        {"[muscles]\nnoise = none\nreflexes = heathy\n", {":7:", "heathy", "nearest: healthy"}},
        {"[muscles]\nnoise = none\nload = 1\nreflexes = healthy\n", {":8:", "before", "load"}},
        {"[muscles]\nnoise = none\nsol_strength = 0\n", {":7:", "sol_strength", "0.05"}},
        {"[muscles]\nnoise = none\ntuned_seed = 1.5\n", {":7:", "tuned_seed", "whole"}},
        {"[muscles]\nnoise = none\n[right.muscles]\nnoise = none\n", {":8:", "noise", "[muscles]"}},
        {"[left.muscles]\nsol_strength = 1\n[muscles]\nsol_strength = 1\n",
         {":8:", "both legs", "[left.muscles]"}},
        {"[right.muscles]\nsol_strength = 1\nsol_strength = 1\n", {":7:", "sol_strength", "twice"}},
        {"[middle.muscles]\nsol_strength = 1\n", {":6:", "[middle.muscles]", "[left.muscles]"}},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        ck_assert_msg(read_with(bad[i].text) == -1, "%s", bad[i].text);
        for (int k = 0; k < 3; k++) {
            ck_assert_msg(strstr(message, bad[i].words[k]) != NULL, "\"%s\" is not in: %s",
                          bad[i].words[k], message);
        }
    }
}
END_TEST

START_TEST(what_is_written_is_read_again)
{
    char path[] = "/tmp/afo-person-XXXXXX";
    static struct person again;
    ck_assert_int_eq(read_with("[muscles]\nnoise = 2.7\nglu_force = 0.1234567890123456\n"
                               "tuned_seed = 7\ntuned_with = exo50, r0 0.03 m\n"
                               "[right.muscles]\ngas_strength = 0.4\n"),
                     0);
    FILE *stream = fdopen(mkstemp(path), "w");
    person_write(stream, &person);
    ck_assert_int_eq(fclose(stream), 0);
    ck_assert_msg(person_read(&again, path, message) == 0, "%s", message);
    unlink(path);
    ck_assert_mem_eq(&again.muscles.gains, &person.muscles.gains, sizeof again.muscles.gains);
    ck_assert_mem_eq(again.muscles.strength, person.muscles.strength,
                     sizeof person.muscles.strength);
    ck_assert(again.muscles.noise_percent == 2.7 && again.muscles.tuned_seed == 7.0);
    ck_assert_str_eq(again.muscles.tuned_with, "exo50, r0 0.03 m");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("person_muscles");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, without_the_section_a_person_is_healthy_and_quiet);
    tcase_add_test(tests, what_is_said_comes_to_the_muscles);
    tcase_add_test(tests, every_gain_has_its_key);
    tcase_add_test(tests, what_is_wrong_is_refused_with_its_line);
    tcase_add_test(tests, what_is_written_is_read_again);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
