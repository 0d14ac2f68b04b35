# The Python package afo: the objects of this build in one shared library, beside it the program with what it needs.
# It is assembled in BUILD/python/afo, where `import afo` finds it with PYTHONPATH=BUILD/python.
PYTHON_ROOM := sim_host/python
PYTHON_SITE := $(BUILD)/python
AFO_PACKAGE := $(PYTHON_SITE)/afo
AFO_LIBRARY := $(AFO_PACKAGE)/libafo.so
AFO_MODULES := $(wildcard $(PYTHON_ROOM)/afo/*.py) $(PYTHON_ROOM)/afo/py.typed
AFO_STAMP := $(PYTHON_SITE)/complete
OBJ_LIBRARY := $(call OBJ_F64,$(PYTHON_ROOM)/strides.c $(PYTHON_ROOM)/gaits.c) \
        $(call OBJ_F32,$(PYTHON_ROOM)/walks.c $(PYTHON_ROOM)/own_law.c)
-include $(wildcard $(OBJ_LIBRARY:.o=.d))

# own_law.o stands before the archives, and so in the place of law_table.o.
$(AFO_LIBRARY): $(OBJ_LIBRARY) $(LIBS)
	@mkdir -p $(@D)
	$(call SAY,LD     $@)
	$(Q)$(CC) -shared $(LDFLAGS_ALL) -Wl,--no-undefined -Wl,-Bsymbolic $(filter %.o,$^) $(LIBS) $(LDLIBS_SIM) -o $@.new
	$(Q)mv $@.new $@

# `make install` puts the program, persons, devices and the view into the package, as on a system.
$(AFO_STAMP): $(AFO_LIBRARY) $(BUILD)/afo $(AFO_MODULES) $(PYTHON_ROOM)/library.h $(PERSONS) $(DEVICES) $(VIEW_FILES)
	$(Q)$(INSTALL) -m 644 $(AFO_MODULES) $(PYTHON_ROOM)/library.h $(AFO_PACKAGE)
	$(Q)rm -rf $(AFO_PACKAGE)/system
	$(Q)$(MAKE) --no-print-directory --silent install DESTDIR= PREFIX='$(abspath $(AFO_PACKAGE))/system'
	$(Q)strip $(AFO_PACKAGE)/system/bin/afo
	$(Q)touch $@

.PHONY: python python-package
python-package: $(AFO_STAMP)
TEST_NEEDS += python-package

python: ## the Python package afo as a wheel, installed into build/venv (some seconds after make)
	$(Q)scripts/setup python
	$(Q)$(MAKE) --no-print-directory python-package
	$(Q)rm -rf $(BUILD)/wheel
	$(Q)build/venv/bin/python -m pip wheel --quiet --no-deps --no-build-isolation --disable-pip-version-check \
	    --wheel-dir $(BUILD)/wheel $(PYTHON_ROOM)
	$(Q)build/venv/bin/python -m pip install --quiet --no-deps --no-index --force-reinstall --disable-pip-version-check \
	    $(BUILD)/wheel/*.whl
	@echo '  installed into build/venv: $(BUILD)/wheel; try: build/venv/bin/python -c "import afo; help(afo)"'
