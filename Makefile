# make run and make test are all that a newcomer needs; both install what they need, and are quick when it is there.
#   make run PORT=8001     HOST= and PORT= are passed on
#   make test ARGS="-k observer"
#   make PYTHON=python3.12 run

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check

.DELETE_ON_ERROR:
.PHONY: help run test tests-in-a-browser-and-batches other-tests tests-in-real-time lint lock bench clean environment test-environment chromium compiler FORCE

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-6s %s\n", $$1, $$2}' $(firstword $(MAKEFILE_LIST))

# Only from the command line: shells export a HOST of their own.
ADDRESS := $(if $(filter command,$(firstword $(origin HOST))),--host $(HOST)) \
           $(if $(filter command,$(firstword $(origin PORT))),--port $(PORT))

run: environment ## start the dashboard
	@exec $(BIN)/vssea serve $(strip $(ADDRESS))

# Beside each other: the browser leaves the processor idle while it waits, and the other tests do not; batches follow the browser,
# so that both halves take about as long. What failed there is
# run again, alone: only then does it say something of the program, and not of a machine with too much to do.
test: test-environment chromium compiler ## run the tests
	@$(MAKE) --no-print-directory --jobs 2 --output-sync=target tests-in-a-browser-and-batches other-tests
	@$(call again,browser,$(BROWSER))
	@$(call again,batches,$(BATCHES))
	@$(call again,other,$(OTHER))
	@$(MAKE) --no-print-directory tests-in-real-time

# The others need not be read to know that they are none of the browser's.
BROWSER_ONLY := $(addprefix --ignore=tests/,core reference backend hardware)
BROWSER := "browser and not real_time" $(BROWSER_ONLY)
BATCHES := "batches and not browser and not real_time"
OTHER := "not batches and not browser and not real_time"
again = ! grep -qs true .pytest_cache/$(1)/v/cache/lastfailed || \
        $(call tests,$(1),$(2),--last-failed --last-failed-no-failures none,[ $$? = 5 ])
# $(4) says which ends are no failures. 1: tests failed; 5: there was none to run, since ARGS chose none of these.
tests = $(BIN)/python -m pytest -o cache_dir=.pytest_cache/$(1) -m $(2) $(3) $(ARGS) || $(4)

tests-in-a-browser-and-batches:
	@$(call tests,browser,$(BROWSER),,[ $$? = 1 -o $$? = 5 ])
	@$(call tests,batches,$(BATCHES),,[ $$? = 1 -o $$? = 5 ])

other-tests:
	@$(call tests,other,$(OTHER),,[ $$? = 1 -o $$? = 5 ])

# Alone on the machine: watchdogs stop a rig whose computer is too busy for it, as they should.
tests-in-real-time:
	@$(call tests,real_time,"real_time and not browser",,[ $$? = 5 ])
	@$(call tests,real_time_browser,"real_time and browser" $(BROWSER_ONLY),,[ $$? = 5 ])

lint: test-environment ## check style, types and layers
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: environment ## measure the figures that the README gives
	@$(BIN)/python -m benchmarks $(ARGS)

# --no-emit-index-url: a lock says what to install, never from where.
COMPILE = "$$folder/bin/uv" pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
          --custom-compile-command "make lock" $(if $(UPGRADE),--upgrade) pyproject.toml

lock: ## write the lock files anew (UPGRADE=1: with the newest versions)
	@folder=$$(mktemp -d) && trap 'rm -rf "$$folder"' EXIT && \
	$(PYTHON) -m venv "$$folder" && "$$folder/bin/python" -m pip install --quiet uv && \
	$(COMPILE) --output-file requirements.lock && \
	$(COMPILE) --output-file requirements-test.lock --extra test --constraint requirements.lock

clean: ## remove all that was installed, built or cached here
	rm -rf $(VENV) frontend_static/vendor build dist .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# Stamps stand for what was installed, so that a second run starts at once.
RUN_LOCK := $(VENV)/.run-lock
TEST_LOCK := $(VENV)/.test-lock
INSTALLED := $(VENV)/.installed
VENDORED := frontend_static/vendor/SOURCE.sha256

environment: $(INSTALLED)

test-environment: $(INSTALLED) $(TEST_LOCK)

$(BIN)/python:
	@echo "Making the environment $(VENV)"
	@$(PYTHON) -c 'import sys; sys.version_info >= (3, 11) or sys.exit("Python 3.11 or newer is needed, this is " + sys.version.split()[0] + ": say make PYTHON=... with a newer one.")'
	@$(PYTHON) -m venv $(VENV)

$(RUN_LOCK): requirements.lock | $(BIN)/python
	@echo "Installing the packages of requirements.lock (about a minute)"
	@$(PIP) install --quiet --require-hashes --requirement $<
	@touch $@

$(TEST_LOCK): requirements-test.lock | $(RUN_LOCK)
	@echo "Installing the packages of requirements-test.lock"
	@$(PIP) install --quiet --require-hashes --requirement $<
	@touch $@

$(INSTALLED): pyproject.toml hatch_build.py package.json package-lock.json .npmrc $(if $(wildcard $(VENDORED)),,FORCE) | $(RUN_LOCK)
	@echo "Installing vssea and the page's libraries"
	@$(PIP) install --quiet --no-deps --editable .
	@touch $@

chromium:
	@$(PYTHON) tests/chromium.py >/dev/null && exit 0; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	    echo "Installing Chromium for the browser tests"; \
	    apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium >/dev/null; \
	fi; \
	$(PYTHON) tests/chromium.py >/dev/null || { \
	    echo "The browser tests need Chromium or Chrome: install one, or name it with CHROMIUM=/path/to/chromium." >&2; exit 1; }

compiler:
	@$(PYTHON) tests/compiler.py >/dev/null && exit 0; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	    echo "Installing a C compiler for the tests of the exported controller"; \
	    apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends gcc libc6-dev >/dev/null; \
	fi; \
	$(PYTHON) tests/compiler.py >/dev/null || { \
	    echo "The tests of the exported controller need a C compiler: install gcc or clang, or name one with CC=/path/to/cc." >&2; exit 1; }
