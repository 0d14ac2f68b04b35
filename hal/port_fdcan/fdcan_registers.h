/* FDCAN1 of the STM32G474: registers and message RAM.
 *
 * Facts from public sources, each number compared by program, all agreeing:
 *   (1) STMicroelectronics, cmsis-device-g4, Include/stm32g474xx.h: bases, offsets,
 *       fields; stm32g4xx-hal-driver, Src/stm32g4xx_hal_fdcan.c: message RAM, elements;
 *   (2) embassy-rs/stm32-data, data/registers/can_fdcan_v1.yaml and fdcanram_v1.yaml:
 *       offsets, fields, message RAM;
 *   (3) libopencm3, stm32/fdcan.h, stm32/g4/fdcan.h, stm32/g4/memorymap.h: all of them.
 * Places in the filter element: (3) and stm32-rs/fdcan, src/message_ram/standard_filter.rs.
 * Where they disagree (RWD.WDV, the RAM of FDCAN2 and 3) nothing is used. Behaviour
 * follows RM0440 and Bosch's M_CAN user manual, whose core this is.
 */
#ifndef HAL_PORT_FDCAN_FDCAN_REGISTERS_H
#define HAL_PORT_FDCAN_FDCAN_REGISTERS_H

#define FDCAN1_BASE 0x40006400u
#define FDCAN1_RAM_BASE 0x4000A400u

/* Register offsets from the base. */
#define FDCAN_CCCR 0x018u
#define FDCAN_NBTP 0x01Cu
#define FDCAN_TSCC 0x020u
#define FDCAN_TSCV 0x024u
#define FDCAN_ECR 0x040u
#define FDCAN_PSR 0x044u
#define FDCAN_IR 0x050u
#define FDCAN_IE 0x054u
#define FDCAN_ILS 0x058u
#define FDCAN_ILE 0x05Cu
#define FDCAN_RXGFC 0x080u
#define FDCAN_RXF0S 0x090u
#define FDCAN_RXF0A 0x094u
#define FDCAN_RXF1S 0x098u
#define FDCAN_RXF1A 0x09Cu
#define FDCAN_TXBC 0x0C0u
#define FDCAN_TXBRP 0x0C8u
#define FDCAN_TXBAR 0x0CCu
#define FDCAN_TXBCR 0x0D0u
#define FDCAN_TXBTO 0x0D4u
#define FDCAN_TXBCF 0x0D8u
#define FDCAN_TXBTIE 0x0DCu
#define FDCAN_TXBCIE 0x0E0u
#define FDCAN_TXEFS 0x0E4u
#define FDCAN_TXEFA 0x0E8u
#define FDCAN_CKDIV 0x100u

#define FDCAN_CCCR_INIT (1u << 0)
#define FDCAN_CCCR_CCE (1u << 1)

#define FDCAN_NBTP_NTSEG2_POS 0u
#define FDCAN_NBTP_NTSEG1_POS 8u
#define FDCAN_NBTP_NBRP_POS 16u
#define FDCAN_NBTP_NBRP_MAX 512u /* divisors: the field holds one less */
#define FDCAN_NBTP_NSJW_POS 25u

#define FDCAN_TSCC_TSS_INTERNAL 1u /* counts TCP + 1 nominal bit times */
#define FDCAN_TSCC_TCP_POS 16u

#define FDCAN_ECR_TEC_POS 0u
#define FDCAN_ECR_TEC_MASK 0xFFu
#define FDCAN_ECR_REC_POS 8u
#define FDCAN_ECR_REC_MASK 0x7Fu
#define FDCAN_ECR_RP (1u << 15)
#define FDCAN_ECR_CEL_POS 16u
#define FDCAN_ECR_CEL_MASK 0xFFu /* reading clears it */

#define FDCAN_PSR_LEC_MASK 7u /* reading sets it to 7: no change */
#define FDCAN_PSR_EP (1u << 5)
#define FDCAN_PSR_EW (1u << 6)
#define FDCAN_PSR_BO (1u << 7)

/* Interrupt flags (written back to clear) and, alike, interrupt enables. */
#define FDCAN_IR_RF0N (1u << 0)
#define FDCAN_IR_RF0L (1u << 2)
#define FDCAN_IR_RF1N (1u << 3)
#define FDCAN_IR_RF1L (1u << 5)
#define FDCAN_IR_TC (1u << 7)
#define FDCAN_IR_TCF (1u << 8)
#define FDCAN_IR_TEFN (1u << 10)
#define FDCAN_IR_TEFL (1u << 12)
#define FDCAN_IR_MRAF (1u << 14)
#define FDCAN_IR_ELO (1u << 16)
#define FDCAN_IR_EP (1u << 17)
#define FDCAN_IR_EW (1u << 18)
#define FDCAN_IR_BO (1u << 19)
#define FDCAN_IR_PEA (1u << 21)
#define FDCAN_IR_ARA (1u << 23)
#define FDCAN_IR_ALL 0x00FFFFFFu

/* Those this driver serves. */
#define FDCAN_INTERRUPTS                                                                          \
    (FDCAN_IR_RF0N | FDCAN_IR_RF0L | FDCAN_IR_RF1N | FDCAN_IR_RF1L | FDCAN_IR_TC | FDCAN_IR_TCF | \
     FDCAN_IR_TEFN | FDCAN_IR_TEFL | FDCAN_IR_MRAF | FDCAN_IR_ELO | FDCAN_IR_EP | FDCAN_IR_EW |   \
     FDCAN_IR_BO | FDCAN_IR_PEA | FDCAN_IR_ARA)

#define FDCAN_ILE_EINT0 (1u << 0)

#define FDCAN_RXGFC_RRFE (1u << 0)        /* reject remote extended */
#define FDCAN_RXGFC_RRFS (1u << 1)        /* reject remote standard */
#define FDCAN_RXGFC_ANFE_REJECT (2u << 2) /* non-matching extended */
#define FDCAN_RXGFC_ANFS_REJECT (2u << 4) /* non-matching standard */
#define FDCAN_RXGFC_LSS_POS 16u           /* number of standard filters */

#define FDCAN_FIFO_FILL_MASK 0xFu /* RXFnS; TXEFS has 3 bits there */
#define FDCAN_FIFO_GET_POS 8u
#define FDCAN_FIFO_GET_MASK 3u

#define FDCAN_TXBC_TFQM (1u << 24) /* queue: the lowest identifier leaves first */

/* Message RAM of one FDCAN: fixed places, in bytes from its base. */
#define FDCAN_RAM_FILTERS 0x000u /* 28 standard filters of 1 word */
#define FDCAN_RAM_RX0 0x0B0u     /* 3 elements of 18 words */
#define FDCAN_RAM_RX1 0x188u
#define FDCAN_RAM_TX_EVENTS 0x260u /* 3 elements of 2 words */
#define FDCAN_RAM_TX 0x278u        /* 3 elements of 18 words */
#define FDCAN_RAM_BYTES 0x350u
#define FDCAN_ELEMENT_BYTES 72u
#define FDCAN_EVENT_BYTES 8u
#define FDCAN_FILTER_MAX 28u
#define FDCAN_FIFO_DEPTH 3u

/* Standard filter element: type, target, two identifiers. */
#define FDCAN_FILTER_TYPE_POS 30u
#define FDCAN_FILTER_RANGE 0u
#define FDCAN_FILTER_DUAL 1u
#define FDCAN_FILTER_TARGET_POS 27u
#define FDCAN_FILTER_TO_FIFO0 1u
#define FDCAN_FILTER_TO_FIFO1 2u
#define FDCAN_FILTER_ID1_POS 16u

/* Words 0 and 1 of receive elements, transmit elements and transmit events. */
#define FDCAN_E0_XTD (1u << 30)
#define FDCAN_E0_RTR (1u << 29)
#define FDCAN_E0_STANDARD_ID_POS 18u
#define FDCAN_E1_EFC (1u << 23) /* transmit: store an event when sent */
#define FDCAN_E1_DLC_POS 16u
#define FDCAN_E1_DLC_MASK 0xFu
#define FDCAN_E1_TIME_MASK 0xFFFFu

#endif
