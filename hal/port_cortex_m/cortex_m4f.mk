# The core: which compiler, and for which instructions. A board names it (CPU_board); boards
# with the same core share their object files.
TOOLS_cortex_m4f := arm-none-eabi-
FLAGS_cortex_m4f := -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16
