/* Every key of a device: name, type, unit, range, fallback and when it says anything.
 *
 * The one list that the file's reader and writer, the validator, the object dictionary and the
 * stored settings are made from (device_description.h). A new key goes to the end of its list: its
 * place is its sub-index.
 *   X(field, type, unit, minimum, maximum, fallback, when, meaning)
 * type: FLOAT, INT, WORD, FLAGS or OBJECT (enum device_key_type). Of WORD and FLAGS the unit lists
 * the words. fallback DEVICE_ASKED: there is none, a file has to say it.
 */
#ifndef HAL_DEVICES_DEVICE_KEYS_H
#define HAL_DEVICES_DEVICE_KEYS_H

enum device_protocol {
    DEVICE_NO_DRIVE_PROTOCOL = 0,
    DEVICE_CIA402 = 1,
    DEVICE_CANSIMPLE = 2,
    DEVICE_MIT = 3
};
enum device_latch { DEVICE_LATCH_NONE = 0, DEVICE_LATCH_DRIVE = 1, DEVICE_LATCH_BOARD = 2 };
/* What takes the load off the spring when the link is lost. */
enum device_unload {
    DEVICE_UNLOAD_NONE = 0,    /* nothing that is known of */
    DEVICE_UNLOAD_DRIVE = 1,   /* the drive's own function */
    DEVICE_UNLOAD_LATCH = 2,   /* the latch holds it until somebody unloads it */
    DEVICE_UNLOAD_HARDWARE = 3 /* a brake, a worm or a valve */
};
enum device_mode { DEVICE_MODE_CSP = 0, DEVICE_MODE_INTERPOLATED = 1 };
enum device_ankle { DEVICE_ANKLE_LINEAR = 0, DEVICE_ANKLE_LEVER = 1 };
enum device_ankle_place { DEVICE_AT_ANKLE = 0, DEVICE_AT_MOTOR = 1 };
enum device_switches { DEVICE_SWITCHES_NONE = 0, DEVICE_SWITCHES_LEG_SENSOR = 1 };

/* Objects that a CiA 402 drive may lack, by the bit of `lacks`. */
#define DEVICE_LACK_WORDS                                                                          \
    "supported_modes|rpdo_timer|option_codes|bus_voltage|temperature|rated_torque|torque|scaling|" \
    "abort_option|following_time|following_window|output_mask|outputs|dummy|heartbeat_consumer|"   \
    "max_speed|position_limits|interpolation|follows_bit"
enum device_lack {
    DEVICE_LACKS_SUPPORTED_MODES,    /* 0x6502 */
    DEVICE_LACKS_RPDO_TIMER,         /* 0x1400:05 */
    DEVICE_LACKS_OPTION_CODES,       /* 0x605A to 0x605E */
    DEVICE_LACKS_BUS_VOLTAGE,        /* 0x6079 */
    DEVICE_LACKS_TEMPERATURE,        /* 0x2100 of the virtual drive */
    DEVICE_LACKS_RATED_TORQUE,       /* 0x6076 */
    DEVICE_LACKS_TORQUE,             /* 0x6077 */
    DEVICE_LACKS_SCALING,            /* 0x608F, 0x6091, 0x6092 */
    DEVICE_LACKS_ABORT_OPTION,       /* 0x6007 */
    DEVICE_LACKS_FOLLOWING_TIME,     /* 0x6066 */
    DEVICE_LACKS_FOLLOWING_WINDOW,   /* 0x6065 */
    DEVICE_LACKS_OUTPUT_MASK,        /* 0x60FE:02 */
    DEVICE_LACKS_OUTPUTS,            /* 0x60FE:01 */
    DEVICE_LACKS_DUMMY,              /* dummy entries in an RPDO's mapping */
    DEVICE_LACKS_HEARTBEAT_CONSUMER, /* 0x1016 */
    DEVICE_LACKS_MAX_SPEED,          /* 0x6080 */
    DEVICE_LACKS_POSITION_LIMITS,    /* 0x607D */
    DEVICE_LACKS_INTERPOLATION,      /* 0x60C2 */
    DEVICE_LACKS_FOLLOWS_BIT,        /* bit 12 of the statusword */
    DEVICE_LACKS_COUNT
};

/* When a key says anything of a leg. */
enum device_key_when {
    DEVICE_ALWAYS,
    DEVICE_WHEN_DRIVEN,
    DEVICE_WHEN_CIA402,
    DEVICE_WHEN_CANSIMPLE,
    DEVICE_WHEN_MIT,
    DEVICE_WHEN_LATCH_DRIVE,
    DEVICE_WHEN_LATCH_BOARD,
    DEVICE_WHEN_LINEAR,
    DEVICE_WHEN_LEVER
};

/* Below every range: has to be said. */
#define DEVICE_ASKED (-3.0e38f)

#define DEVICE_COMMON_KEYS(X)                                        \
    X(tick_us, INT, "us", 500.0f, 100000.0f, 1000.0f, ALWAYS,        \
      "the controller's cycle: the bus must carry all frames in it") \
    X(bitrate_bit_s, INT, "bit/s", 10000.0f, 1000000.0f, 1000000.0f, ALWAYS, "of the bus")

/* Zero and stroke together stay in half of 32 bits, so that no target overflows. */
#define DEVICE_LEG_KEYS(X)                                                                                  \
    X(protocol, WORD, "none|cia402|cansimple|mit", 0.0f, 3.0f, DEVICE_ASKED, ALWAYS,                        \
      "of the drive; none: this leg has sensors only")                                                      \
    X(drive_node, INT, "", 1.0f, 127.0f, DEVICE_ASKED, WHEN_DRIVEN,                                         \
      "node number of a CiA 402 drive, axis of CANSimple, motor number of MIT mode")                        \
    X(answer_id, INT, "", 1.0f, 127.0f, DEVICE_ASKED, WHEN_MIT,                                             \
      "identifier of the motor's answer")                                                                   \
    X(direction, INT, "", -1.0f, 1.0f, 1.0f, WHEN_DRIVEN,                                                   \
      "1 when the drive's position rises with compression, else -1")                                        \
    X(counts_per_m, FLOAT, "counts/m", 30000.0f, 1.0e8f, DEVICE_ASKED, WHEN_DRIVEN,                         \
      "counts of the motor's encoder per metre of spring; of CiA 402: of 0x6064")                           \
    X(zero_counts, INT, "counts", -1.0e9f, 1.0e9f, 0.0f, WHEN_CIA402,                                       \
      "position of the drive at the unloaded spring")                                                       \
    X(turns_per_m, FLOAT, "turns/m", 0.1f, 100000.0f, DEVICE_ASKED, WHEN_CANSIMPLE,                         \
      "motor turns per metre of spring")                                                                    \
    X(zero_turns, FLOAT, "turns", -100000.0f, 100000.0f, 0.0f, WHEN_CANSIMPLE,                              \
      "position of the drive at the unloaded spring")                                                       \
    X(rad_per_m, FLOAT, "rad/m", 0.1f, 100000.0f, DEVICE_ASKED, WHEN_MIT,                                   \
      "motor angle per metre of spring")                                                                    \
    X(zero_rad, FLOAT, "rad", -100.0f, 100.0f, 0.0f, WHEN_MIT,                                              \
      "motor angle at the unloaded spring")                                                                 \
    X(position_range_rad, FLOAT, "rad", 0.1f, 1000.0f, DEVICE_ASKED, WHEN_MIT,                              \
      "half width of the position field")                                                                   \
    X(velocity_range_rad_s, FLOAT, "rad/s", 0.1f, 1000.0f, DEVICE_ASKED, WHEN_MIT,                          \
      "half width of the velocity field")                                                                   \
    X(torque_range_Nm, FLOAT, "Nm", 0.1f, 1000.0f, DEVICE_ASKED, WHEN_MIT,                                  \
      "half width of the torque field")                                                                     \
    X(kp_Nm_rad, FLOAT, "Nm/rad", 0.0f, 500.0f, DEVICE_ASKED, WHEN_MIT,                                     \
      "the drive's position gain")                                                                          \
    X(kd_Nms_rad, FLOAT, "Nm s/rad", 0.0f, 5.0f, DEVICE_ASKED, WHEN_MIT, "its velocity gain")               \
    X(counts_per_turn, FLOAT, "counts", 0.0f, 1.0e9f, 0.0f, WHEN_DRIVEN,                                    \
      "of the encoder per motor turn; 0: not told")                                                         \
    X(mode, WORD, "csp|interpolated", 0.0f, 1.0f, 0.0f, WHEN_CIA402,                                        \
      "cyclic synchronous position (mode 8) or interpolated position (mode 7)")                             \
    X(gear, FLOAT, "", 0.001f, 10000.0f, 1.0f, WHEN_DRIVEN,                                                 \
      "motor turns per turn of the screw or drum")                                                          \
    X(travel_per_turn_m, FLOAT, "m", 0.0f, 10.0f, 0.0f, WHEN_DRIVEN,                                        \
      "spring travel per turn of the screw or drum; 0: not told")                                           \
    X(rated_force_N, FLOAT, "N", 0.0f, 50000.0f, 0.0f, WHEN_DRIVEN,                                         \
      "on the spring at the motor's rated torque; 0: not known, the force is not judged")                   \
    X(rated_torque_Nm, FLOAT, "Nm", 0.0f, 1000.0f, 0.0f, WHEN_CIA402,                                       \
      "of the motor, where the drive does not tell it; 0: the drive does")                                  \
    X(spring_N_per_m, FLOAT, "N/m", 1.0f, 100000.0f, DEVICE_ASKED, WHEN_DRIVEN,                             \
      "stiffness of the ankle spring")                                                                      \
    X(stroke_max_m, FLOAT, "m", 0.001f, 0.6f, DEVICE_ASKED, WHEN_DRIVEN, "longest compression")             \
    X(speed_max_m_s, FLOAT, "m/s", 0.001f, 10.0f, DEVICE_ASKED, WHEN_DRIVEN,                                \
      "limit of the motor's speed, in metres of spring")                                                    \
    X(force_max_N, FLOAT, "N", 0.1f, 50000.0f, DEVICE_ASKED, WHEN_DRIVEN,                                   \
      "limit of the motor's force on the spring")                                                           \
    X(current_max_A, FLOAT, "A", 0.0f, 1000.0f, 0.0f, WHEN_DRIVEN,                                          \
      "limit of the motor's current, as set in the drive; 0: not told")                                     \
    X(following_error_m, FLOAT, "m", 0.0f, 0.6f, 0.0f, WHEN_CIA402,                                         \
      "a larger error of position is the drive's fault; 0: a tenth of the leg length")                      \
    X(latch, WORD, "none|drive|board", 0.0f, 2.0f, DEVICE_ASKED, WHEN_DRIVEN,                               \
      "what holds the loaded spring: an output of the drive, a board of its own, or nothing")               \
    X(latch_bit, INT, "", 0.0f, 15.0f, 14.0f, WHEN_LATCH_DRIVE,                                             \
      "bit of the statusword that is 1 while the latch holds")                                              \
    X(latch_node, INT, "", 1.0f, 127.0f, DEVICE_ASKED, WHEN_LATCH_BOARD,                                    \
      "node number of the board")                                                                           \
    X(latch_object, OBJECT, "", 0.0f, 16777215.0f, 0.0f, WHEN_LATCH_BOARD,                                  \
      "byte of the board that is 1 while the latch holds; 0: it does not tell")                             \
    X(unload, WORD, "none|drive|latch|hardware", 0.0f, 3.0f, 0.0f, WHEN_DRIVEN,                             \
      "what makes a loaded spring safe when the link is lost")                                              \
    X(leg_sensor_node, INT, "", 1.0f, 127.0f, DEVICE_ASKED, ALWAYS,                                         \
      "node number of the leg angle's sensor")                                                              \
    X(leg_sensor_object, OBJECT, "", 0.0f, 16777215.0f, 0x202001, ALWAYS, "its position")                   \
    X(leg_sensor_bits, INT, "bits", 16.0f, 32.0f, 24.0f, ALWAYS, "of that position")                        \
    X(leg_counts_per_turn, FLOAT, "counts", 256.0f, 16777216.0f, 16777216.0f, ALWAYS,                       \
      "of that position")                                                                                   \
    X(leg_direction, INT, "", -1.0f, 1.0f, 1.0f, ALWAYS,                                                    \
      "1 when the count rises with the foot going ahead, else -1")                                          \
    X(leg_zero_rad, FLOAT, "rad", -3.15f, 3.15f, 0.0f, ALWAYS,                                              \
      "what it reads when the leg is vertical")                                                             \
    X(leg_latency_s, FLOAT, "s", 0.0f, 0.02f, 0.0001f, ALWAYS, "age of a sample at its SYNC")               \
    X(ankle, WORD, "linear|lever", 0.0f, 1.0f, 0.0f, ALWAYS,                                                \
      "what the ankle's sensor measures: the extension, or an angle with a lever")                          \
    X(ankle_sensor_node, INT, "", 0.0f, 127.0f, 0.0f, ALWAYS,                                               \
      "node number of the ankle's sensor; 0: that of the leg angle's")                                      \
    X(ankle_sensor_object, OBJECT, "", 0.0f, 16777215.0f, 0x202002, ALWAYS, "its position")                 \
    X(ankle_sensor_bits, INT, "bits", 16.0f, 32.0f, 16.0f, ALWAYS, "of that position")                      \
    X(ankle_counts_per_m, FLOAT, "counts/m", 100.0f, 1.0e7f, 100000.0f, WHEN_LINEAR,                        \
      "of that position")                                                                                   \
    X(ankle_counts_per_turn, FLOAT, "counts", 256.0f, 65536.0f, 65536.0f, WHEN_LEVER,                       \
      "of that position")                                                                                   \
    X(ankle_direction, INT, "", -1.0f, 1.0f, 1.0f, ALWAYS,                                                  \
      "1 when the count rises with plantarflexion, else -1")                                                \
    X(ankle_zero_m, FLOAT, "m", -0.6f, 0.6f, 0.0f, WHEN_LINEAR, "what it reads at extension 0")             \
    X(ankle_lever_m, FLOAT, "m", 0.01f, 0.5f, 0.12f, WHEN_LEVER, "lever of the ankle joint")                \
    X(ankle_neutral_rad, FLOAT, "rad", -1.0f, 1.0f, 0.0f, WHEN_LEVER,                                       \
      "plantarflexion at extension 0")                                                                      \
    X(ankle_latency_s, FLOAT, "s", 0.0f, 0.02f, 0.0001f, ALWAYS, "age of a sample at its SYNC")             \
    X(ankle_side, WORD, "ankle|motor", 0.0f, 1.0f, 0.0f, ALWAYS,                                            \
      "where the ankle's sensor sits: at the joint, or at the motor's end of the spring")                   \
    X(foot_switches, WORD, "none|leg_sensor", 0.0f, 1.0f, 0.0f, ALWAYS, "where they are read")              \
    X(lacks, FLAGS, DEVICE_LACK_WORDS, 0.0f, 524287.0f, 0.0f, WHEN_CIA402,                                  \
      "what the drive does not have")                                                                       \
    X(temperature_warn_degC, FLOAT, "degC", 0.0f, 300.0f, 0.0f, WHEN_DRIVEN,                                \
      "as the drive tells it: from here on the push becomes smaller; 0: not told")                          \
    X(temperature_stop_degC, FLOAT, "degC", 0.0f, 300.0f, 0.0f, WHEN_DRIVEN,                                \
      "here there is none, and the assistance ends; 0: not told")                                           \
    X(supply_min_V, FLOAT, "V", 0.0f, 1000.0f, 0.0f, WHEN_DRIVEN,                                           \
      "of the drive's supply: likewise, the push becomes smaller from 1.05 times of it on; 0: not told")    \
    X(supply_max_V, FLOAT, "V", 0.0f, 1000.0f, 0.0f, WHEN_DRIVEN,                                           \
      "likewise from 0.95 times of it on; 0: not told")                                                     \
    X(ankle_table_rad, FLOAT, "rad", 0.0f, 1.0f, 0.0f, WHEN_LEVER,                                          \
      "step of the lever's table over plantarflexion beyond neutral; 0: a lever that turns with the joint") \
    X(ankle_table_1_m, FLOAT, "m", 0.0f, 0.5f, 0.0f, WHEN_LEVER,                                            \
      "the lever, that is torque over force, at one step; at none it is ankle_lever_m")                     \
    X(ankle_table_2_m, FLOAT, "m", 0.0f, 0.5f, 0.0f, WHEN_LEVER, "at two")                                  \
    X(ankle_table_3_m, FLOAT, "m", 0.0f, 0.5f, 0.0f, WHEN_LEVER, "at three")                                \
    X(ankle_table_4_m, FLOAT, "m", 0.0f, 0.5f, 0.0f, WHEN_LEVER, "at four, and beyond")                     \
    X(latch_delay_s, FLOAT, "s", 0.0f, 0.025f, 0.0f, WHEN_DRIVEN,                                           \
      "mean time from the other foot's contact until the latch is open; the laws allow for it")             \
    X(contact_bit, INT, "", 0.0f, 15.0f, 0.0f, WHEN_LATCH_DRIVE,                                            \
      "bit of the statusword that is 1 while the contact at the latch is closed; 0: it does not tell")

#endif
