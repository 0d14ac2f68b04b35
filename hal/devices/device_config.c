#include "hal/devices/device_config.h"

#include "hal/bus/frame_table.h"

#define FOLLOWING_ERROR_SHARE 0.1f /* of the leg length */
#define MNM_PER_NM 1000.0f

void device_leg_sensors(const struct device_description *device,
                        struct leg_sensor_config config[SIDE_COUNT])
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &device->leg[leg];
        const bool lever = own->ankle == DEVICE_ANKLE_LEVER;
        config[leg] = (struct leg_sensor_config){
            .angle_zero_rad = own->leg_zero_rad,
            .angle_direction = (int8_t)own->leg_direction,
            .ankle_is_lever = lever,
            .ankle_lever_m = own->ankle_lever_m,
            .ankle_table_rad = own->ankle_table_rad,
            .ankle_table_m = {own->ankle_table_1_m, own->ankle_table_2_m, own->ankle_table_3_m,
                              own->ankle_table_4_m},
            .ankle_neutral_rad = own->ankle_neutral_rad,
            .leg_counts_per_turn = own->leg_counts_per_turn,
            .ankle_counts_per_unit = lever ? own->ankle_counts_per_turn : own->ankle_counts_per_m,
            .ankle_zero_m = lever ? 0.0f : own->ankle_zero_m,
            .leg_bytes = (uint8_t)(own->leg_sensor_bits / 8),
            .ankle_bytes = (uint8_t)(own->ankle_sensor_bits / 8),
            .ankle_reversed = own->ankle_direction < 0,
            .ankle_is_apart = device_leg_ankle_is_apart(own),
        };
    }
}

static void number_nodes(const struct device_description *device, struct node_setup_config *config)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &device->leg[leg];
        const bool board = device_leg_is_driven(own) && own->latch == DEVICE_LATCH_BOARD;
        config->node[NETWORK_DRIVE_LEFT + leg] =
            own->protocol == DEVICE_CIA402 ? (uint8_t)own->drive_node : 0;
        config->node[NETWORK_SENSOR_LEFT + leg] = (uint8_t)own->leg_sensor_node;
        config->node[NETWORK_LATCH_LEFT + leg] = board ? (uint8_t)own->latch_node : 0;
        config->node[NETWORK_ANKLE_LEFT + leg] =
            device_leg_ankle_is_apart(own) ? (uint8_t)own->ankle_sensor_node : 0;
    }
}

static void set_drive(const struct device_description *device, int leg, float leg_length_m,
                      float speed_needed_m_s, struct node_setup_config *config)
{
    const struct device_leg *own = &device->leg[leg];
    const struct device_leg *other = &device->leg[SIDE_COUNT - 1 - leg];
    const int32_t zero = own->zero_counts;
    const int32_t travel = (int32_t)(own->stroke_max_m * own->counts_per_m);
    const float following_m = own->following_error_m > 0.0f ? own->following_error_m
                                                            : FOLLOWING_ERROR_SHARE * leg_length_m;
    config->counts_per_m[leg] = (uint32_t)own->counts_per_m;
    config->limit_min_counts[leg] = own->direction < 0 ? zero - travel : zero;
    config->limit_max_counts[leg] = own->direction < 0 ? zero : zero + travel;
    config->rated_force_N[leg] = own->rated_force_N;
    config->rated_torque_mNm[leg] = (uint32_t)(own->rated_torque_Nm * MNM_PER_NM + 0.5f);
    config->following_error_counts[leg] = (uint32_t)(following_m * own->counts_per_m);
    config->speed_needed_counts_s[leg] = (uint32_t)(speed_needed_m_s * own->counts_per_m);
    config->lacks[leg] = (uint32_t)own->lacks;
    config->interpolated[leg] = own->mode == DEVICE_MODE_INTERPOLATED;
    config->own_target[leg] = other->protocol != DEVICE_CIA402 ||
                              device_leg_lacks(own, DEVICE_LACKS_DUMMY) ||
                              device_leg_lacks(other, DEVICE_LACKS_DUMMY);
    config->has_others_pdos[leg] = own->lacks != 0 || own->drive_node != NODE_DRIVE_LEFT + leg;
}

void device_node_setup(const struct device_description *device, float leg_length_m,
                       float speed_needed_m_s, struct node_setup_config *config)
{
    *config = (struct node_setup_config){0};
    number_nodes(device, config);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &device->leg[leg];
        if (own->protocol == DEVICE_CIA402) {
            set_drive(device, leg, leg_length_m, speed_needed_m_s, config);
        }
        config->ankle_is_lever[leg] = own->ankle == DEVICE_ANKLE_LEVER;
        config->leg_object[leg] = (uint32_t)own->leg_sensor_object;
        config->ankle_object[leg] = (uint32_t)own->ankle_sensor_object;
        config->leg_bits[leg] = (uint8_t)own->leg_sensor_bits;
        config->ankle_bits[leg] = (uint8_t)own->ankle_sensor_bits;
        config->leg_counts_per_turn[leg] = (uint32_t)own->leg_counts_per_turn;
        config->latch_object[leg] = (uint32_t)own->latch_object;
        config->foot_switch[leg] = own->foot_switches == DEVICE_SWITCHES_LEG_SENSOR;
        config->sensor_has_others_pdos[leg] = own->leg_sensor_node != NODE_SENSOR_LEFT + leg;
    }
}

bool device_is_canopen(const struct device_description *device)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const int32_t protocol = device->leg[leg].protocol;
        if (protocol != DEVICE_CIA402 && protocol != DEVICE_NO_DRIVE_PROTOCOL) {
            return false;
        }
    }
    return true;
}
