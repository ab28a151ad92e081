# make demo, make test: each sets itself up in .venv; needs Python 3.11 or newer and pip.
# Another Python: make demo PYTHON=python3.12 (an existing .venv stays as it is; `make clean` removes it).

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
OUT := out/demo
# what an installation depends on: the FMU shim is compiled by it
SOURCES := pyproject.toml $(wildcard setup.py fmu_wrapper/fmi/* fmu_wrapper/shim/*)

# by uv, which takes a fifth of pip's time; by pip on platforms that uv has no wheel for
install = $(BIN)/pip install --disable-pip-version-check --quiet --only-binary :all: uv 2>/dev/null; \
	if [ -x $(BIN)/uv ]; then $(BIN)/uv pip install --quiet --python $(BIN)/python $(1); \
	else $(BIN)/pip install --disable-pip-version-check --quiet $(1); fi

.PHONY: demo test library lint docs bench three dist clean help
.DEFAULT_GOAL := help

help:
	@echo "make demo     co-simulation of an exported FMU, and a cross-check with exudyn; results in $(OUT)"
	@echo "make test     the tests; before the first ones the solver's machine code"
	@echo "make library  the solver's machine code anew, after the core has changed"
	@echo "make lint     ruff"
	@echo "make docs     the docs as a site, in build/site"
	@echo "make bench    speed and work-precision against exudyn (minutes)"
	@echo "make dist     wheels with machine code for all platforms, and the sources' archive, in dist (tens of minutes)"
	@echo "make three    viewer/page/three.js anew, from viewer/three; needs node and npm"
	@echo "make clean    remove .venv, build products and caches"

demo: $(VENV)/.installed-all
	$(BIN)/tlismni cosim pendulum_stop -o $(OUT)
	$(BIN)/tlismni crosscheck pendulum_stop --set law=hunt_crossley --report $(OUT)
	@echo
	@echo "The demo left in $(OUT):"
	@ls $(OUT) | sed 's/^/  /'

# the solver's machine code is made once, before the first tests: they take half the time with it. Where the core's sources
# have changed since, it is left alone, and the tests compile what they use; `make library` makes it anew.
# A hundred tests start processes: what one compiles to bytecode, the next ones read.
test: $(VENV)/.installed-dev | $(VENV)/.library
	PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest

$(VENV)/.library: | $(VENV)/.installed-dev
	$(MAKE) library

library: $(VENV)/.installed-dev
	$(call install,-e ".[cross]")
	@echo "The solver's machine code, where machine_code has none of these sources, is made: minutes of two cores"
	TLISMNI_LIBRARY=none $(BIN)/python -m tlismni.core.aot --take machine_code
	@touch $(VENV)/.library

lint: $(VENV)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

docs: $(VENV)/.installed-dev
	$(BIN)/mkdocs build --strict

bench: $(VENV)/.installed-dev
	cd benchmarks && ../$(BIN)/python chain_speed.py
	cd benchmarks && ../$(BIN)/python work_precision.py
	cd benchmarks && ../$(BIN)/python rod_cost.py

TARGETS := linux-x86_64 linux-aarch64 musl-x86_64 musl-aarch64 windows-x86_64 windows-aarch64 macos-x86_64 macos-aarch64

# one recording, machine code of it for each platform, a wheel of each
dist: $(VENV)/.installed-dev
	$(call install,-e ".[cross]" "setuptools>=77")
	rm -rf build/dist
	$(BIN)/python -m tlismni.core.aot $(TARGETS:%=--target %) --output build/dist
	for target in $(TARGETS); do \
		rm -rf build/lib* build/bdist.* build/temp.*; \
		TLISMNI_AHEAD=build/dist TLISMNI_TARGET=$$target $(BIN)/pip wheel --disable-pip-version-check --quiet \
			--no-deps --no-build-isolation -w dist . || exit 1; \
	done
	$(BIN)/python -c 'from setuptools.build_meta import build_sdist; build_sdist("dist")'
	@ls -l dist

three:
	cd viewer/three && npm install --no-audit --no-fund && npm run build && rm -rf node_modules package-lock.json

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "Python 3.11 or newer is needed; $(PYTHON) is older or missing. Try: make PYTHON=python3.12"; exit 1; }
	$(PYTHON) -m venv $(VENV)

$(VENV)/.installed-all: $(BIN)/python $(SOURCES)
	@echo "Packages are installed into $(VENV), once: a minute or two without a word"
	$(call install,-e ".[all]")
	@touch $@

# the extra dev holds all
$(VENV)/.installed-dev: $(BIN)/python $(SOURCES)
	@echo "Packages are installed into $(VENV), once: a minute or two without a word"
	$(call install,-e ".[dev]")
	@touch $(VENV)/.installed-all $@

clean:
	rm -rf $(VENV) $(OUT) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
	rm -f $(foreach place,fmu_wrapper core/compiled,$(place)/*.so $(place)/*.dll $(place)/*.dylib)
