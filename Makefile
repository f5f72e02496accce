# One environment in .venv, made from constraints.txt, and the commands that use it.
# Python 3.11 to 3.14 with venv and make have to be installed before.

VENV := .venv
BIN := $(VENV)/bin
PIP := PIP_DISABLE_PIP_VERSION_CHECK=1 $(BIN)/python -m pip
INSTALL := $(PIP) install --constraint constraints.txt --editable
ARGS ?=
SANITISED ?= tests/unit/slam_core tests/property tests/integration tests/real
# Files of tests are shared out among processes. One processor each; more than 4 would crowd the browser tests.
PROCESSES ?= auto

.DEFAULT_GOAL := help
.PHONY: help demo test sanitise check wheel-check bench screenshots docs constraints clean chromium

help:  ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: $(VENV)/ready-run  ## a robot maps a rescue arena in the browser; ARGS=littoral or handheld for another place
	$(BIN)/hectorscope demo $(ARGS)

test: $(VENV)/ready-dev chromium  ## every test; ARGS="-k matcher", ARGS="-m 'not browser'" choose
	$(BIN)/python -m pytest --numprocesses $(PROCESSES) --maxprocesses 4 --dist loadfile $(ARGS)

sanitise: $(VENV)/ready-dev  ## tests of the core, demos and recordings with checked kernels; ARGS chooses
	NUMBA_BOUNDSCHECK=1 $(BIN)/python -m pytest $(SANITISED) $(ARGS)

check: $(VENV)/ready-dev  ## style, types and import rules
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

wheel-check: $(VENV)/ready-dev  ## build the wheel, install it in an empty environment and use it there
	$(BIN)/python tests/packaging/check_wheel.py

bench: $(VENV)/ready-bench  ## measure and write docs/performance.md and docs/benchmark.md
	$(BIN)/python -m benchmarks.performance $(ARGS)
	$(BIN)/python -m benchmarks.sweeps.published

screenshots: $(VENV)/ready-dev chromium  ## take pictures of every tab, theme and size into build/; ARGS=--docs those of docs/images
	$(BIN)/python -m benchmarks.screenshots $(ARGS)

docs: $(VENV)/ready-run  ## write docs/configuration.md from the configuration tree
	$(BIN)/python docs/configuration.py

constraints:  ## freeze the newest versions that pyproject.toml allows, in a throw-away environment
	rm -rf build/freeze && $(call python) && "$$python" -m venv build/freeze
	build/freeze/bin/python -m pip install '.[test,check,bench,cluster,parquet]'
	{ echo "# Exact versions of every extra. Written by: make constraints"; \
	  build/freeze/bin/python -m pip freeze --exclude hectorscope; } > build/constraints.txt
	mv build/constraints.txt constraints.txt && rm -rf build/freeze

clean:  ## remove the environment and every cache
	rm -rf $(VENV) build dist .numba_cache .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis .benchmarks
	find app slam_core tests benchmarks docs -name __pycache__ -type d -prune -exec rm -rf {} +

chromium:
	@command -v chromium chromium-browser google-chrome >/dev/null || \
	  echo "No Chromium: the browser tests are skipped. Install it with: sudo apt-get install chromium"

# ------------------------------------------------------------------------------------------------ environment

# The first Python that the pinned numba runs on and that can make environments (Debian keeps venv apart).
python = python=; for candidate in $(PYTHON) python3 python3.13 python3.12 python3.11 python3.14; do \
	  if "$$candidate" -c 'import ensurepip, sys; sys.exit(not (3, 11) <= sys.version_info < (3, 15))' 2>/dev/null; \
	  then python=$$candidate; break; fi; done; \
	if [ -z "$$python" ]; then echo "Python 3.11 to 3.14 with venv is missing. Install it with:" \
	  "sudo apt-get install python3 python3-venv (or name one: make PYTHON=/path/to/python3.12 ...)" >&2; exit 1; fi

# The stamp is touched last, so that an interrupted installation is repeated.
$(VENV)/made:
	@$(call python); echo "Making $(VENV) with $$($$python --version)"; "$$python" -m venv --clear $(VENV)
	@touch $@

$(VENV)/ready-run: $(VENV)/made pyproject.toml constraints.txt
	$(INSTALL) .
	@touch $@

$(VENV)/ready-dev: $(VENV)/made pyproject.toml constraints.txt
	$(INSTALL) '.[test,check]'
	@touch $@ $(VENV)/ready-run

$(VENV)/ready-bench: $(VENV)/made pyproject.toml constraints.txt
	$(INSTALL) '.[test,bench]'
	@touch $@ $(VENV)/ready-run
