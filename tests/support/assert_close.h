/* Comparisons of floating-point numbers that a NaN or an infinity cannot pass. */
#ifndef TESTS_SUPPORT_ASSERT_CLOSE_H
#define TESTS_SUPPORT_ASSERT_CLOSE_H

#include <check.h>

/* 1 when both are finite and |got - want| <= absolute + relative * |want|. */
int is_close(double got, double want, double absolute, double relative);

#define assert_close(got, want, absolute, relative)                                   \
    do {                                                                              \
        double got_ = (double)(got), want_ = (double)(want);                          \
        ck_assert_msg(is_close(got_, want_, (absolute), (relative)),                  \
                      "%s is %.17g, expected %.17g (off by %.3g)", #got, got_, want_, \
                      got_ - want_);                                                  \
    } while (0)

/* Runs the suite, prints check's closing line, returns the process exit status. */
int run_suite(Suite *suite);

#endif
