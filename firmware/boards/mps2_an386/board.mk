# MPS2 with the AN386 image, as QEMU emulates it: what runs here is the object code that is flashed.
BOARDS += mps2_an386
CPU_mps2_an386 := cortex_m4f
PORTS_mps2_an386 := port_cortex_m port_mps2
INTERRUPTS_mps2_an386 := timer0_handler
# How the supervisor stops while all else goes on (main.c).
LDFLAGS_mps2_an386 := -Wl,--wrap=supervisor_update_f32

.PHONY: pil
pil: firmware programs ## 200 steps with the flashed object code on an emulated Cortex-M4F, frame by frame like the host's
	$(Q)$(BUILD)/afo-pil --steps 200 --speed 0.8 --image $(call IMAGE,mps2_an386).elf
