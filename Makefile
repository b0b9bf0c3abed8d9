# palpate: plain make; `make help` lists the targets and variables.
.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.SECONDARY:

VERSION   := $(shell sed -n 's/^.define PALP_VERSION "\(.*\)"/\1/p' include/palpate/version.h)
# What a change of the interface raises: the minor version before 1.0, the major version from then on.
SOVERSION := $(shell sed -n 's/^.define PALP_VERSION "\(0[.][0-9]*\|[1-9][0-9]*\)[.].*/\1/p' include/palpate/version.h)

# ---- what a user may set -------------------------------------------------------------------------
ifeq ($(origin CC),default)
CC := gcc
endif
CFLAGS ?= -O3 -g
BUILD  ?= build
PREFIX ?= /usr/local
BINDIR     ?= $(PREFIX)/bin
LIBDIR     ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
MANDIR     ?= $(PREFIX)/share/man
BASHDIR    ?= $(PREFIX)/share/bash-completion/completions
ZSHDIR     ?= $(PREFIX)/share/zsh/site-functions
DOCDIR     ?= $(PREFIX)/share/doc/palpate
UDEVDIR    ?= $(PREFIX)/lib/udev/rules.d
# Where the command looks for its images: beside the folder that it lies in, whatever LIBDIR is.
IMAGEDIR    = $(BINDIR)/../lib/palpate
OBJCOPY    ?= objcopy
PKG_CONFIG ?= pkg-config
# PETSC=1: palpate simulate --ranks, networks of millions of nodes over processes (PETSc, MPI).
# GPL=1: also CHOLMOD's supernodal module, which makes the result GPL.
# WERROR=1 (implied by CI=true): warnings are errors.  SANITIZE=1: AddressSanitizer and UBSan.  V=1: show commands.

# ---- libraries -----------------------------------------------------------------------------------
# Debian 12 ships no .pc for SuiteSparse. Its headers are system headers: their warnings are not ours.
ifeq ($(shell $(PKG_CONFIG) --exists CHOLMOD AMD COLAMD 2>/dev/null && echo yes),yes)
SUITESPARSE_CFLAGS ?= $(patsubst -I%,-isystem%,$(shell $(PKG_CONFIG) --cflags CHOLMOD AMD COLAMD))
SUITESPARSE_LIBS   ?= $(shell $(PKG_CONFIG) --libs CHOLMOD AMD COLAMD)
endif
SUITESPARSE_CFLAGS ?= -isystem /usr/include/suitesparse
SUITESPARSE_LIBS   ?= -lcholmod -lamd -lcolamd -lsuitesparseconfig
# -lblas, not -lopenblas: CHOLMOD calls libblas.so.3, which the system's alternatives point at one BLAS.
# Naming OpenBLAS itself would put a second copy into the process. tools/install-deps installs OpenBLAS'
# pthread variant behind that name: the serial one has no locks, and two threads that call it spoil each other's results.
BLAS_LIBS ?= $(shell $(PKG_CONFIG) --libs lapack blas 2>/dev/null || echo -llapack -lblas)
DEP_CFLAGS := $(SUITESPARSE_CFLAGS) $(patsubst -I%,-isystem%,$(shell $(PKG_CONFIG) --cflags nlopt jansson 2>/dev/null))
ifeq ($(PETSC),1)
PETSC_CFLAGS := $(patsubst -I%,-isystem%,$(filter -I%,$(shell $(PKG_CONFIG) --cflags PETSc mpi-c)))
PETSC_LIBS := $(shell $(PKG_CONFIG) --libs PETSc mpi-c)
endif
SIM_LIBS := $(SUITESPARSE_LIBS) $(shell $(PKG_CONFIG) --libs jansson 2>/dev/null || echo -ljansson) $(BLAS_LIBS) -lpthread -lm
LIBS := $(shell $(PKG_CONFIG) --libs nlopt 2>/dev/null || echo -lnlopt) $(SIM_LIBS) $(PETSC_LIBS)
SERIAL_CFLAGS := $(patsubst -I%,-isystem%,$(shell $(PKG_CONFIG) --cflags libserialport 2>/dev/null))
SERIAL_LIBS  = $(shell $(PKG_CONFIG) --libs libserialport 2>/dev/null || echo -lserialport)
# Optional: without it palpate panel says what is missing.
HTTP_CFLAGS := $(shell $(PKG_CONFIG) --exists libmicrohttpd 2>/dev/null && echo -DPALPATE_HTTP $$($(PKG_CONFIG) --cflags libmicrohttpd))
HTTP_LIBS   := $(if $(HTTP_CFLAGS),$(shell $(PKG_CONFIG) --libs libmicrohttpd))
# Optional: HDF5 files for palpate import, by a program of its own. Debian's plain hdf5.pc may be that for MPI.
HDF5_PC    := $(firstword $(foreach p,hdf5-serial hdf5,$(shell $(PKG_CONFIG) --exists $(p) 2>/dev/null && echo $(p))))
HDF5_CFLAGS = $(patsubst -I%,-isystem%,$(shell $(PKG_CONFIG) --cflags $(HDF5_PC)))
HDF5_LIBS   = $(shell $(PKG_CONFIG) --libs $(HDF5_PC))
# Optional: without it palpate export writes no FMU.
ZIP_CFLAGS := $(shell $(PKG_CONFIG) --exists minizip 2>/dev/null && echo -DPALPATE_ZIP $$($(PKG_CONFIG) --cflags minizip zlib))
ZIP_LIBS   := $(if $(ZIP_CFLAGS),$(shell $(PKG_CONFIG) --libs minizip zlib))
HAS_POKE    := $(shell $(PKG_CONFIG) --exists glfw3 gl stb 2>/dev/null && echo yes)
POKE_CFLAGS  = $(patsubst -I%,-isystem%,$(shell $(PKG_CONFIG) --cflags glfw3 gl stb 2>/dev/null))
POKE_LIBS    = $(shell $(PKG_CONFIG) --libs glfw3 gl stb 2>/dev/null || echo -lglfw -lGL -lstb)
CHECK_LIBS  = $(shell $(PKG_CONFIG) --libs check 2>/dev/null || echo -lcheck)
CMOCKA_LIBS = $(shell $(PKG_CONFIG) --libs cmocka 2>/dev/null || echo -lcmocka)

# ---- flags ---------------------------------------------------------------------------------------
WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wconversion
ifneq ($(SANITIZE),)
SAN := -O1 -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
# clang alone objects to parts of a block that are named before its pointer is compared with NULL.
SAN += $(if $(filter clang,$(CC)),-fno-sanitize=pointer-overflow)
endif
# With sanitizers gcc warns falsely.
ifneq ($(if $(SANITIZE),$(filter clang,$(CC)),$(WERROR)$(filter true,$(CI))),)
WARNINGS += -Werror
endif
# No contraction, no -ffast-math, no -march=native: the same numbers on every machine. The other two
# change no number either; they let square roots and selections be vectorized.
FLOAT := -ffp-contract=off -fno-math-errno -fno-trapping-math
ALL_CPPFLAGS := -Iinclude $(DEP_CFLAGS) $(if $(filter 1,$(GPL)),-DPALP_GPL) $(CPPFLAGS)
ALL_CFLAGS   := -std=c99 -fPIC -fvisibility=hidden $(FLOAT) $(WARNINGS) $(CFLAGS) $(SAN)
ALL_LDFLAGS  := -Wl,--as-needed $(SAN) $(LDFLAGS)

# ---- files ---------------------------------------------------------------------------------------
# Networks over processes: with PETSc, or the calls that say that it is missing.
LIB_SRC    := $(filter-out $(if $(filter 1,$(PETSC)),lib/ranks/ranks_none.c,lib/ranks/petsc_%.c),$(wildcard lib/*.c lib/*/*.c))
TOOL_SRC   := $(wildcard tools/*.c tools/*/*.c)
LIB_TESTS  := $(wildcard tests/lib/test_*.c tests/lib/*/test_*.c)
TOOL_TESTS := $(wildcard tests/tools/test_*.c)
CORE_SRC   := $(wildcard firmware/core/*.c) firmware/board/plant_link.c
CORE_TESTS := $(wildcard tests/firmware/test_*.c)
BENCHES    := $(wildcard bench/bench_*.c)
EXAMPLES   := $(wildcard examples/*.c)
POKE_SRC   := $(wildcard examples/poke/*.c)
# Other .c files beside tests and benches are helpers, linked into each of them.
LIB_TEST_HELP  := $(filter-out $(LIB_TESTS),$(wildcard tests/lib/*.c))
TOOL_TEST_HELP := $(filter-out $(TOOL_TESTS) tests/tools/serial_shim.c,$(wildcard tests/tools/*.c))
CORE_TEST_HELP := $(filter-out $(CORE_TESTS),$(wildcard tests/firmware/*.c))
BENCH_HELP     := $(filter-out $(BENCHES),$(wildcard bench/*.c))
FMU_SRC        := $(wildcard tools/export/fmu/*.c)
HDF5_SRC       := $(wildcard tools/import/hdf5/*.c)
HEADERS := $(wildcard include/palpate/*.h)
DOCUMENTS := README.md LICENSE $(wildcard doc/*.md doc/pictures/* doc/schema/*.json doc/schema/page.py) $(EXAMPLES) $(wildcard examples/poke/* examples/cmake/*)
MAN_SRC := $(wildcard doc/*.scd)

obj  = $(patsubst %.c,$(BUILD)/obj/%.o,$(1))
prog = $(patsubst %.c,$(BUILD)/%,$(1))
STATIC := $(BUILD)/libpalpate.a
INTERNAL := $(BUILD)/obj/libpalpate.a
# What a simulator needs that only steps: networks, tools, cuts. It has no NLopt.
SIM_SRC := $(filter-out lib/solve/least_squares.c,$(foreach f,base material mesh solve effect model network contact cut realtime reduce,$(wildcard lib/$(f)/*.c)))
SIM_STATIC := $(BUILD)/libpalpate-sim.a
CORE   := $(BUILD)/libindenter.a
SONAME := libpalpate.so.$(SOVERSION)
SHARED := $(BUILD)/libpalpate.so.$(VERSION)
SIM_SONAME := libpalpate-sim.so.$(SOVERSION)
SIM_SHARED := $(BUILD)/libpalpate-sim.so.$(VERSION)
TOOL   := $(BUILD)/palpate
HDF5   := $(if $(HDF5_PC),$(BUILD)/palpate-hdf5)
# The library inside of the FMUs that palpate export packs.
FMU    := $(if $(ZIP_CFLAGS),$(BUILD)/palpate-fmu.so)
POKE   := $(BUILD)/examples/poke/poke
TEST_PROGRAMS := $(call prog,$(LIB_TESTS) $(TOOL_TESTS) $(CORE_TESTS))
ifneq ($(V),1)
Q := @
note = @echo "  $(1)"
endif

# ---- building ------------------------------------------------------------------------------------
.PHONY: all static shared programs tests examples poke poke-build FORCE
all: static shared $(TOOL) $(HDF5) $(FMU) firmware-host ## the static and shared library and the palpate command, under build/
static: $(STATIC) $(SIM_STATIC)
shared: $(SHARED) $(SIM_SHARED)
tests: $(TEST_PROGRAMS) $(TOOL) $(HDF5) $(FMU) firmware-host
examples: $(call prog,$(EXAMPLES)) ## build/examples/*: what a simulator author starts from (doc/simulator.md)
programs: $(STATIC) $(TOOL) $(HDF5) $(FMU) $(TEST_PROGRAMS) $(call prog,$(BENCHES) $(EXAMPLES)) $(if $(HAS_POKE),$(POKE))

# Rewritten when compiler, flags or libraries change, so that everything is rebuilt then.
FLAGS_LINE := $(CC) $(ALL_CPPFLAGS) $(ALL_CFLAGS) $(ALL_LDFLAGS) $(LIBS) $(HTTP_CFLAGS) $(ZIP_CFLAGS)
$(BUILD)/flags: FORCE
	@tools/install-deps --check $(if $(filter 1,$(PETSC)),petsc,$(if $(filter install-lib static shared,$(MAKECMDGOALS)),library,build))
	@mkdir -p $(@D)
	@echo '$(FLAGS_LINE)' | cmp -s - $@ || echo '$(FLAGS_LINE)' >$@

# Tools and examples see the public headers only; tests and benches also the internal ones.
$(BUILD)/obj/lib/%.o: EXTRA := -Ilib
$(BUILD)/obj/lib/ranks/%.o: EXTRA := -Ilib $(PETSC_CFLAGS)
FIRMWARE_FLAGS := -Ifirmware/core -Ifirmware/board
$(BUILD)/obj/tools/%.o $(BUILD)/obj/tests/tools/%.o $(BUILD)/obj/tests/firmware/%.o: EXTRA := -Itools $(FIRMWARE_FLAGS) $(SERIAL_CFLAGS) $(HTTP_CFLAGS) $(ZIP_CFLAGS)
$(BUILD)/obj/tools/import/hdf5/%.o: EXTRA := $(if $(HDF5_PC),$(HDF5_CFLAGS))
# The pages of palpate panel and of results, as bytes.
$(BUILD)/obj/tools/panel/panel_page.o: EXTRA += -I$(BUILD)/page/panel
$(BUILD)/obj/tools/panel/panel_page.o: $(BUILD)/page/panel/page_bytes.h
$(BUILD)/obj/tools/shared/page.o: EXTRA += -I$(BUILD)/page/page
$(BUILD)/obj/tools/shared/page.o: $(BUILD)/page/page/page_bytes.h
$(BUILD)/page/%/page_bytes.h: tools/%/page.html tools/%/page.css tools/%/page.js
	@mkdir -p $(@D)
	$(Q)for f in $^; do echo "static const unsigned char page_$${f##*.}[] = {"; \
	    od -An -v -tu1 $$f | sed 's/ *\([0-9][0-9]*\)/\1,/g'; echo "};"; done >$@
# The firmware's own code as this machine runs it; the images for the board are firmware.mk's.
$(BUILD)/obj/firmware/%.o: EXTRA := $(FIRMWARE_FLAGS)
$(BUILD)/obj/tests/lib/%.o: EXTRA := -Ilib -Itests/lib
$(BUILD)/obj/bench/%.o: EXTRA := -Ilib
$(BUILD)/obj/examples/poke/%.o: EXTRA := $(POKE_CFLAGS)
$(BUILD)/obj/%.o: %.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call note,CC   $@)
	$(Q)$(CC) $(ALL_CPPFLAGS) $(EXTRA) $(ALL_CFLAGS) -MMD -MP -c -o $@ $<

# What a user links: one object whose global names are those of lib/palpate.map. Tests and benches see the others too.
$(INTERNAL): $(call obj,$(LIB_SRC))
$(BUILD)/palpate.o: $(call obj,$(LIB_SRC)) lib/palpate.map
	@mkdir -p $(@D) && sed -n 's/^ *\(palp_[a-z0-9_]*\);$$/\1/p' lib/palpate.map >$@.names
	$(Q)$(LD) -r -o $@ $(filter %.o,$^) && $(OBJCOPY) --keep-global-symbols=$@.names $@
$(STATIC): $(BUILD)/palpate.o
$(BUILD)/palpate-sim.o: $(call obj,$(SIM_SRC)) $(BUILD)/palpate.o
	$(Q)$(LD) -r -o $@ $(filter-out $(BUILD)/palpate.o,$^) && $(OBJCOPY) --keep-global-symbols=$(BUILD)/palpate.o.names $@
$(SIM_STATIC): $(BUILD)/palpate-sim.o
# The part of the firmware that knows no registers: the plant shares its sensor, the tests run it.
$(CORE): $(call obj,$(CORE_SRC))
%.a:
	$(call note,AR   $@)
	@mkdir -p $(@D) && rm -f $@
	$(Q)$(AR) qcs $@ $^

$(SHARED): $(call obj,$(LIB_SRC))
$(SHARED): NEEDED = $(LIBS)
$(SIM_SHARED): $(call obj,$(SIM_SRC))
$(SIM_SHARED): NEEDED = $(SIM_LIBS)
$(SHARED) $(SIM_SHARED): lib/palpate.map
	$(call note,LD   $@)
	$(Q)$(CC) $(ALL_CFLAGS) $(ALL_LDFLAGS) -shared -Wl,-soname,$(notdir $(@:$(VERSION)=$(SOVERSION))) \
	    -Wl,--version-script=lib/palpate.map -Wl,-z,defs -o $@ $(filter %.o,$^) $(NEEDED)
	@ln -sf $(notdir $@) $(@:$(VERSION)=$(SOVERSION))
	@ln -sf $(notdir $@) $(@:.$(VERSION)=)

# The Python package, to be imported from build/python; the library lies in its folder.
PYTHON_PACKAGE := $(BUILD)/python/palpate/c.py
$(PYTHON_PACKAGE): $(wildcard python/*.py python/src/palpate/*.py) $(HEADERS) lib/palpate.abi | $(SHARED)
	$(Q)python3 python/backend.py $(@D)
	@ln -sf ../../$(notdir $(SHARED)) $(@D)/$(SONAME)

# Programs. A line "/* link: FLAGS */" in a program's source adds linker flags, e.g. -Wl,--wrap=malloc.
own_flags = $(shell sed -n 's,^/\* link: \(.*\) \*/$$,\1,p' $*.c 2>/dev/null)
link = $(Q)mkdir -p $(@D) && $(CC) $(ALL_CFLAGS) $(ALL_LDFLAGS) $(own_flags) -o $@ $(filter %.o %.a,$^) $(1) $(LIBS)

$(TOOL): $(call obj,$(TOOL_SRC)) $(CORE) $(STATIC)
	$(call note,LD   $@)
	$(call link,$(SERIAL_LIBS) $(HTTP_LIBS) $(ZIP_LIBS))
$(BUILD)/palpate-hdf5: $(call obj,$(HDF5_SRC)) $(STATIC)
	$(call note,LD   $@)
	$(call link,$(HDF5_LIBS))
$(BUILD)/palpate-fmu.so: $(call obj,$(FMU_SRC)) $(SIM_STATIC)
	$(call note,LD   $@)
	$(Q)$(CC) $(ALL_CFLAGS) $(ALL_LDFLAGS) -s -shared -Wl,--exclude-libs,ALL -o $@ $^ $(SIM_LIBS)
# A test is linked with what its folder shares, the main function too, where it has none of its own.
$(BUILD)/tests/lib.a: $(call obj,$(LIB_TEST_HELP) tests/main_check.c)
$(BUILD)/tests/tools.a: $(call obj,$(TOOL_TEST_HELP) tests/main_cmocka.c $(filter-out tools/palpate.c,$(TOOL_SRC)))
$(BUILD)/tests/firmware.a: $(call obj,$(CORE_TEST_HELP))
$(filter $(BUILD)/tests/lib/%,$(TEST_PROGRAMS)): $(BUILD)/%: $(BUILD)/obj/%.o $(BUILD)/tests/lib.a $(INTERNAL)
	$(call note,LD   $@)
	$(call link,$(CHECK_LIBS))
$(filter $(BUILD)/tests/tools/%,$(TEST_PROGRAMS)): $(BUILD)/%: $(BUILD)/obj/%.o $(BUILD)/tests/tools.a $(CORE) $(STATIC)
	$(call note,LD   $@)
	$(call link,$(CMOCKA_LIBS) $(SERIAL_LIBS) $(HTTP_LIBS) $(ZIP_LIBS))
$(filter $(BUILD)/tests/firmware/%,$(TEST_PROGRAMS)): $(BUILD)/%: $(BUILD)/obj/%.o $(BUILD)/tests/firmware.a $(BUILD)/tests/tools.a $(CORE) $(STATIC)
	$(call note,LD   $@)
	$(call link,$(CMOCKA_LIBS) $(SERIAL_LIBS) $(HTTP_LIBS) $(ZIP_LIBS))
# Lets libserialport, which opens no PTY, open one.
$(BUILD)/tests/tools/serial_shim.so: tests/tools/serial_shim.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(Q)$(CC) -std=c99 $(WARNINGS) -O2 -fPIC -shared -o $@ $< -ldl
$(BUILD)/tests/tools/test_serial: | $(BUILD)/tests/tools/serial_shim.so
$(call prog,$(BENCHES)): $(BUILD)/%: $(BUILD)/obj/%.o $(call obj,$(BENCH_HELP)) $(INTERNAL)
	$(call note,LD   $@)
	$(call link)
$(call prog,$(EXAMPLES)): $(BUILD)/%: $(BUILD)/obj/%.o $(STATIC)
	$(call note,LD   $@)
	$(call link)

$(POKE): $(call obj,$(POKE_SRC)) $(STATIC)
	$(call note,LD   $@)
	$(call link,$(POKE_LIBS))

ALL_SRC := $(LIB_SRC) $(TOOL_SRC) $(HDF5_SRC) $(FMU_SRC) $(CORE_SRC) $(wildcard tests/*.c tests/lib/*.c tests/lib/*/*.c tests/tools/*.c tests/firmware/*.c bench/*.c) $(EXAMPLES) $(POKE_SRC)
-include $(patsubst %.o,%.d,$(call obj,$(ALL_SRC)))

-include firmware/firmware.mk

# ---- running -------------------------------------------------------------------------------------
# These install what is missing first; make then starts anew, since pkg-config may only now be there.
.PHONY: demo demo-run python python-build check check-all asan bench bench-run pictures pictures-run
JOBS = $(if $(findstring -j,$(MAKEFLAGS)),,-j$(shell nproc))
again = +@$(MAKE) --no-print-directory $(JOBS)

demo: ## the virtual indenter presses a phantom; models, what they miss, and a report
	@tools/install-deps demo
	$(again) demo-run
demo-run: $(TOOL) firmware-host $(if $(HAS_ARM),firmware)
	@PALPATE=$(TOOL) tools/demo.sh
poke: ## build/examples/poke/poke: a window that presses, drags and cuts the phantom
	@tools/install-deps poke
	$(again) poke-build
poke-build: $(POKE)
python: ## build/python/palpate, the Python package, to be imported from there (or: pip install ./python)
	@tools/install-deps python
	$(again) python-build
python-build: $(PYTHON_PACKAGE)
check: ## the tests, built with gcc, in minutes; ends with "N passed, N failed"
	@tools/install-deps check
	+@BUILD='$(BUILD)' MAKE='$(MAKE)' tests/run.sh check
check-all: check ## make check, and the sanitizers by clang, valgrind, a fuzzer and the long tests
	@tools/install-deps check-all
	+@BUILD='$(BUILD)' MAKE='$(MAKE)' tests/run.sh rest
asan: ## the tests under AddressSanitizer and UBSan only
	@tools/install-deps check-all
	+@BUILD='$(BUILD)' MAKE='$(MAKE)' tests/run.sh asan
pictures: ## every picture of doc/pictures/ from the product itself (installs a browser)
	@tools/install-deps pictures
	$(again) pictures-run
pictures-run: $(TOOL) $(POKE) firmware-host
	@PALPATE=$(TOOL) tools/pictures.sh
bench: ## builds and runs every bench/bench_*.c, and bench_python.py
	@tools/install-deps build
	$(again) bench-run
# One thread: Debian's CHOLMOD starts OpenMP threads whatever OMP_NUM_THREADS says.
bench-run: $(call prog,$(BENCHES)) $(TOOL) $(PYTHON_PACKAGE)
	@set -e; for b in $(call prog,$(BENCHES)); do \
	    echo "== $$(basename $$b)"; PALPATE=$(TOOL) OMP_THREAD_LIMIT=1 OPENBLAS_NUM_THREADS=1 $$b; done
	@if python3 -c 'import numpy' 2>/dev/null; then echo "== bench_python"; python3 bench/bench_python.py; fi

.PHONY: hidden
SEED ?= 1
hidden: $(TOOL) ## the cases with a hidden effect: generated, explained and scored (SEED=1, about half an hour)
	@PALPATE=$(TOOL) CC='$(CC)' tests/hidden/run.sh --seed $(SEED) --set all --oracle --out $(BUILD)/hidden

.PHONY: worlds
worlds: $(TOOL) ## laboratories that are not ours, from recordings to the missing effect, judged (SEED=1, about half an hour)
	@PALPATE=$(TOOL) CC='$(CC)' tests/hidden/worlds/run.sh --seed $(SEED) --set all --oracle --out $(BUILD)/worlds

# ---- installing ----------------------------------------------------------------------------------
.PHONY: install install-lib uninstall man
D = $(DESTDIR)
MAN_PAGES := $(patsubst doc/%.scd,$(BUILD)/man/%,$(MAN_SRC))
# A command's page takes its options and example from the command's own --help.
$(BUILD)/man/palpate-%.1: doc/palpate-%.1.scd doc/options.awk $(TOOL)
	@mkdir -p $(@D)
	$(Q)$(TOOL) $* --help >$@.help && awk -f doc/options.awk $@.help $< | scdoc >$@
	@rm $@.help
$(BUILD)/man/%: doc/%.scd
	@mkdir -p $(@D)
	$(Q)scdoc <$< >$@
man: $(MAN_PAGES) ## the manual pages (needs scdoc)

install: all install-lib $(FW_IMAGES) ## into PREFIX (default /usr/local), under DESTDIR if given
	install -d '$(D)$(BINDIR)' '$(D)$(IMAGEDIR)'
	install -m 755 $(TOOL) '$(D)$(BINDIR)'
	install -D -m 644 tools/completion/palpate.bash '$(D)$(BASHDIR)/palpate'
	install -D -m 644 tools/completion/_palpate '$(D)$(ZSHDIR)/_palpate'
	install -D -m 644 tools/indenter/70-palpate.rules '$(D)$(UDEVDIR)/70-palpate.rules'
	install -m 755 $(FW)/indenter_host $(HDF5) $(FMU) '$(D)$(IMAGEDIR)'
	for f in $(DOCUMENTS); do install -D -m 644 $$f "$(D)$(DOCDIR)/$$f" || exit 1; done
	$(if $(FW_IMAGES),install -m 644 $(FW_IMAGES) '$(D)$(IMAGEDIR)')
	+@if command -v scdoc >/dev/null; then $(MAKE) -s --no-print-directory man && for p in $(MAN_PAGES); do \
	    install -D -m 644 $$p "$(D)$(MANDIR)/man$${p##*.}/$${p##*/}" || exit 1; done; \
	  else echo "scdoc is not installed: no manual pages"; fi
	@if [ -z '$(D)' ]; then ldconfig 2>/dev/null || echo "run ldconfig as root if $(LIBDIR) is a system folder"; fi
install-lib: static shared # the libraries alone, which need neither libserialport nor what else the command calls
	install -d '$(D)$(LIBDIR)/pkgconfig' '$(D)$(LIBDIR)/cmake/palpate' '$(D)$(INCLUDEDIR)/palpate'
	install -m 644 $(HEADERS) '$(D)$(INCLUDEDIR)/palpate'
	install -m 644 $(STATIC) $(SHARED) $(SIM_STATIC) $(SIM_SHARED) '$(D)$(LIBDIR)'
	ln -sf $(notdir $(SHARED)) '$(D)$(LIBDIR)/$(SONAME)'
	ln -sf $(notdir $(SHARED)) '$(D)$(LIBDIR)/libpalpate.so'
	ln -sf $(notdir $(SIM_SHARED)) '$(D)$(LIBDIR)/$(SIM_SONAME)'
	ln -sf $(notdir $(SIM_SHARED)) '$(D)$(LIBDIR)/libpalpate-sim.so'
	@sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@LIBDIR@|$(LIBDIR:$(PREFIX)/%=$${prefix}/%)|' -e 's|@VERSION@|$(VERSION)|' \
	    -e 's|@INCLUDEDIR@|$(INCLUDEDIR:$(PREFIX)/%=$${prefix}/%)|' -e 's|@LIBS@|$(strip $(LIBS))|' \
	    lib/palpate.pc.in >'$(D)$(LIBDIR)/pkgconfig/palpate.pc'
	@sed -e 's|-lpalpate|-lpalpate-sim|' -e 's|^Name: palpate|&-sim|' -e 's|^Libs.private:.*|Libs.private: $(strip $(SIM_LIBS))|' \
	    -e 's|^Description:.*|Description: the part of palpate that a simulator steps tissue with|' \
	    '$(D)$(LIBDIR)/pkgconfig/palpate.pc' >'$(D)$(LIBDIR)/pkgconfig/palpate-sim.pc'
	@sed -e 's|@UP@|$(shell echo '$(LIBDIR:$(PREFIX)/%=%)/cmake/palpate' | sed 's|[^/][^/]*|..|g')|' -e 's|@LIBDIR@|$(LIBDIR:$(PREFIX)/%=%)|' \
	    -e 's|@INCLUDEDIR@|$(INCLUDEDIR:$(PREFIX)/%=%)|' -e 's|@LIBS@|$(strip $(LIBS))|' -e 's|@SIM_LIBS@|$(strip $(SIM_LIBS))|' \
	    lib/palpate-config.cmake.in >'$(D)$(LIBDIR)/cmake/palpate/palpate-config.cmake'
	@sed 's|@VERSION@|$(VERSION)|' lib/palpate-config-version.cmake.in >'$(D)$(LIBDIR)/cmake/palpate/palpate-config-version.cmake'

uninstall: ## removes what install put there
	rm -f '$(D)$(BASHDIR)/palpate' '$(D)$(ZSHDIR)/_palpate' '$(D)$(BINDIR)/palpate' '$(D)$(LIBDIR)/pkgconfig/palpate.pc'
	rm -f $(foreach f,$(notdir $(STATIC) $(SHARED) $(SIM_STATIC) $(SIM_SHARED)) $(SONAME) $(SIM_SONAME) libpalpate.so libpalpate-sim.so \
	    pkgconfig/palpate-sim.pc cmake/palpate/palpate-config.cmake cmake/palpate/palpate-config-version.cmake,'$(D)$(LIBDIR)/$(f)')
	rm -f $(foreach f,$(notdir $(MAN_SRC:.scd=)),'$(D)$(MANDIR)/man$(lastword $(subst ., ,$(f)))/$(f)')
	rm -f $(foreach f,$(HEADERS),'$(D)$(INCLUDEDIR)/$(f:include/%=%)')
	rm -f '$(D)$(UDEVDIR)/70-palpate.rules' $(foreach f,indenter_host palpate-hdf5 palpate-fmu.so $(FW_IMAGE_NAMES),'$(D)$(IMAGEDIR)/$(f)')
	rm -f $(foreach f,$(DOCUMENTS),'$(D)$(DOCDIR)/$(f)')
	-rmdir '$(D)$(LIBDIR)/cmake/palpate' '$(D)$(INCLUDEDIR)/palpate' '$(D)$(IMAGEDIR)' $(foreach f,/doc/pictures /doc/schema /doc /examples/poke /examples/cmake /examples /,'$(D)$(DOCDIR)$(f)')

# ---- the rest ------------------------------------------------------------------------------------
.PHONY: dist symbols libs clean help
libs: # what a program of the command's parts is linked with
	@echo "$(LIBS) $(SERIAL_LIBS) $(HTTP_LIBS) $(ZIP_LIBS)"
DISTDIR ?= .
dist: ## palpate-VERSION.tar.gz of the last commit
	git archive --format=tar.gz --prefix=palpate-$(VERSION)/ -o '$(DISTDIR)/palpate-$(VERSION).tar.gz' HEAD
symbols: ## rewrites lib/palpate.map and lib/palpate.abi, exported functions and declarations, from the public headers
	@for kind in map abi; do tests/install/symbols.sh --$$kind >lib/palpate.$$kind.part && \
	    mv lib/palpate.$$kind.part lib/palpate.$$kind || { rm -f lib/palpate.$$kind.part; exit 1; }; done
clean: ## removes build/
	rm -rf '$(BUILD)'
help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 12
	@echo "Variables: CC CFLAGS LDFLAGS PREFIX DESTDIR BUILD GPL=1 PETSC=1 WERROR=1 SANITIZE=1 V=1"
