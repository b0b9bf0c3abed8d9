# firmware.mk: the indenter's firmware, included by the root Makefile, whose variables it uses.
#   build/firmware/indenter.elf, .bin  for the STM32F405
#   build/firmware/stepper_hx711.elf, stepper_ads1220.elf, .bin  for the cheap machine, by its amplifier
#   build/firmware/rig.elf             the same for QEMU, with the plant in the place of sensors and motor
#   build/firmware/indenter_host       the same as a process of this machine

ARM ?= arm-none-eabi-
ARM_CFLAGS ?= -O2 -g
FW := $(BUILD)/firmware

FW_SHARED := firmware/main.c lib/wire/wire.c $(wildcard firmware/core/*.c)
FW_SIMULATED := firmware/board/simulated.c firmware/board/plant_link.c
FW_CHIP := $(wildcard firmware/board/stm32f405/*.c)
# What QEMU does not model: the plant is there instead.
FW_DEVICES := $(patsubst %,firmware/board/stm32f405/%.c,board sensor_ad7606 encoder flash motor supply thermistor switches trigger)
FW_ELF_SRC := $(FW_SHARED) $(FW_CHIP)
# The cheap machine's: the same chip, with other devices.
FW_STEPPER := $(FW_SHARED) $(filter-out $(patsubst %,firmware/board/stm32f405/%.c,encoder motor sensor_ad7606),$(FW_CHIP)) \
    firmware/board/stepper/steps.c firmware/board/stepper/sensor_cell.c
FW_HX711_SRC := $(FW_STEPPER) firmware/board/stepper/sensor_hx711.c
FW_ADS1220_SRC := $(FW_STEPPER) firmware/board/stepper/sensor_ads1220.c
FW_RIG_SRC := $(FW_SHARED) $(FW_SIMULATED) $(filter-out $(FW_DEVICES),$(FW_CHIP)) \
    $(wildcard firmware/board/rig/*.c)
FW_HOST_SRC := $(FW_SHARED) $(FW_SIMULATED) $(wildcard firmware/board/host/*.c)
fw_arm = $(patsubst %.c,$(FW)/arm/%.o,$(1))

FW_FLAGS := -mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard -std=c99 -ffreestanding -fno-common \
    -fno-tree-loop-distribute-patterns -ffunction-sections -fdata-sections $(FLOAT) $(ARM_CFLAGS) \
    $(WARNINGS) -Wdouble-promotion -Wfloat-conversion -Iinclude $(FIRMWARE_FLAGS) -Ifirmware/board/stm32f405
FW_LD := firmware/board/stm32f405/stm32f405.ld

.PHONY: firmware firmware-host flash
# Without the compiler nothing of the rest would say anything useful. The headers are newlib's, a package of its own.
HAS_ARM := $(shell printf '\043include <string.h>\n' | $(ARM)gcc -E - >/dev/null 2>&1 && echo yes)
FW_IMAGE_NAMES := indenter.elf indenter.bin stepper_hx711.bin stepper_ads1220.bin rig.elf
FW_IMAGES := $(if $(HAS_ARM),$(addprefix $(FW)/,$(FW_IMAGE_NAMES)))
ifeq ($(HAS_ARM),)
firmware:
	@echo "there is no $(ARM)gcc with newlib: tools/install-deps all installs it, or set ARM=prefix-" >&2; exit 1
else
firmware: $(FW_IMAGES) ## the board's firmware and the image for QEMU, under build/firmware/
	@firmware/budget.sh $(ARM) $(FW)/indenter.elf $(patsubst %.o,%.ci,$(call fw_arm,$(FW_ELF_SRC)))
	@firmware/budget.sh $(ARM) $(FW)/stepper_hx711.elf $(patsubst %.o,%.ci,$(call fw_arm,$(FW_HX711_SRC)))
	@firmware/budget.sh $(ARM) $(FW)/stepper_ads1220.elf $(patsubst %.o,%.ci,$(call fw_arm,$(FW_ADS1220_SRC)))
	@firmware/budget.sh $(ARM) $(FW)/rig.elf $(patsubst %.o,%.ci,$(call fw_arm,$(FW_RIG_SRC)))
endif
firmware-host: $(FW)/indenter_host

# Rewritten when the compiler or its flags change, so that everything is rebuilt then.
$(FW)/flags: FORCE
	@mkdir -p $(@D)
	@echo '$(ARM)gcc $(FW_FLAGS)' | cmp -s - $@ || echo '$(ARM)gcc $(FW_FLAGS)' >$@

$(FW)/arm/%.o: %.c $(FW)/flags
	@mkdir -p $(@D)
	$(call note,ARM  $@)
	$(Q)$(ARM)gcc $(FW_FLAGS) -fcallgraph-info=su -MMD -MP -c -o $@ $<

$(FW)/indenter.elf: $(call fw_arm,$(FW_ELF_SRC))
$(FW)/rig.elf: $(call fw_arm,$(FW_RIG_SRC))
$(FW)/stepper_hx711.elf: $(call fw_arm,$(FW_HX711_SRC))
$(FW)/stepper_ads1220.elf: $(call fw_arm,$(FW_ADS1220_SRC))
$(FW)/%.elf: $(FW_LD)
	$(call note,LD   $@)
	$(Q)$(ARM)gcc $(FW_FLAGS) -nostdlib -T $(FW_LD) -Wl,--gc-sections -Wl,-Map=$(@:.elf=.map) \
	    -o $@ $(filter %.o,$^) -lgcc
$(FW)/%.bin: $(FW)/%.elf
	$(Q)$(ARM)objcopy -O binary $< $@

# The process has a main of its own, which calls the firmware's.
$(BUILD)/obj/firmware/main.o: EXTRA = $(FIRMWARE_FLAGS) -Dmain=firmware_main
$(FW)/indenter_host: $(call obj,$(FW_HOST_SRC))
	$(call note,LD   $@)
	@mkdir -p $(@D)
	$(Q)$(CC) $(ALL_CFLAGS) $(ALL_LDFLAGS) -o $@ $^ -lm

flash: ## writes the firmware to a board at an ST-Link, by openocd or st-flash
	@$(MAKE) --no-print-directory firmware
	@if command -v openocd >/dev/null; then \
	    openocd -f interface/stlink.cfg -f target/stm32f4x.cfg -c 'program $(FW)/indenter.elf verify reset exit'; \
	elif command -v st-flash >/dev/null; then \
	    st-flash --reset write $(FW)/indenter.bin 0x08000000; \
	else \
	    echo "there is neither openocd nor st-flash: install openocd or stlink-tools" >&2; exit 1; \
	fi

-include $(patsubst %.o,%.d,$(sort $(call fw_arm,$(FW_ELF_SRC) $(FW_RIG_SRC) $(FW_HX711_SRC) $(FW_ADS1220_SRC)) $(call obj,$(FW_HOST_SRC))))
