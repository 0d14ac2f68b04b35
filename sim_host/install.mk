# afo on a system: the program, its manual page, made of its --help, the persons and devices that come with it, the
# page of afo view with its server, and what afo import reads files with.
PREFIX ?= /usr/local
DESTDIR ?=
INSTALL ?= install
PERSONS := $(wildcard sim_host/persons/*.ini)
DEVICES := $(wildcard sim_host/devices/*.ini)
VIEW_FILES := $(wildcard $(addprefix sim_host/view/,*.py page/*.* page/uplot/*))
FORMATS_FILES := $(wildcard sim_host/formats/*.py)
PAGE_FILES := $(wildcard sim_host/study/page/*.py)
VIEW_SHEETS := $(wildcard hal/canopen/eds/controller.eds hal/canopen/eds/afo.dbc)

.PHONY: man install compile-commands
man: $(BUILD)/afo.1
$(BUILD)/afo.1: $(BUILD)/afo scripts/man-page
	$(call SAY,MAN    $@)
	$(Q)scripts/man-page $< >$@.new && mv $@.new $@

install: $(BUILD)/afo $(BUILD)/afo.1 ## the program, its manual page, page of afo view, persons and devices into PREFIX (/usr/local), below DESTDIR
	$(Q)$(INSTALL) -d '$(DESTDIR)$(PREFIX)/bin' '$(DESTDIR)$(PREFIX)/share/man/man1' '$(DESTDIR)$(PREFIX)/share/afo/persons' \
	    '$(DESTDIR)$(PREFIX)/share/afo/devices'
	$(Q)$(INSTALL) -m 755 $(BUILD)/afo '$(DESTDIR)$(PREFIX)/bin/afo'
	$(Q)$(INSTALL) -m 644 $(BUILD)/afo.1 '$(DESTDIR)$(PREFIX)/share/man/man1/afo.1'
	$(Q)$(INSTALL) -m 644 $(PERSONS) '$(DESTDIR)$(PREFIX)/share/afo/persons'
	$(Q)$(INSTALL) -m 644 $(DEVICES) '$(DESTDIR)$(PREFIX)/share/afo/devices'
	$(Q)for file in $(VIEW_FILES:sim_host/view/%=%); do \
	    $(INSTALL) -D -m 644 "sim_host/view/$$file" '$(DESTDIR)$(PREFIX)/share/afo/view/'"$$file" || exit 1; done
	$(Q)for file in $(FORMATS_FILES); do \
	    $(INSTALL) -D -m 644 "$$file" '$(DESTDIR)$(PREFIX)/share/afo/formats/'"$${file##*/}" || exit 1; done
	$(Q)for file in $(PAGE_FILES); do \
	    $(INSTALL) -D -m 644 "$$file" '$(DESTDIR)$(PREFIX)/share/afo/study/page/'"$${file##*/}" || exit 1; done
	$(Q)for file in $(VIEW_SHEETS); do \
	    $(INSTALL) -D -m 644 "$$file" '$(DESTDIR)$(PREFIX)/share/afo/view/eds/'"$${file##*/}" || exit 1; done
	@echo '  installed below $(DESTDIR)$(PREFIX): bin/afo, share/man/man1/afo.1, share/afo'

compile-commands: ## build/compile_commands.json for editors (clangd, VS Code); nothing is compiled
	@mkdir -p $(BUILD)
	$(Q)CCACHE_DISABLE=1 $(MAKE) --no-print-directory -Bn V=1 JOBS=1 CC=gcc programs tests firmware 2>/dev/null | \
	    scripts/compile-commands >$(BUILD)/compile_commands.json.new
	$(Q)mv $(BUILD)/compile_commands.json.new $(BUILD)/compile_commands.json
