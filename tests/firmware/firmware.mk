# What the test stalls, it stands in for.
$(BUILD)/tests/firmware/test_watchdog_signs: private LDFLAGS_ALL += \
        -Wl,--wrap=supervisor_update_f32,--wrap=controller_update_f32
