# Two commands do everything on a fresh machine with Python >= 3.11, make and git: make report, make test.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.installed
# make report SETTINGS="--setting naive --setting tuned --setting best" runs the files' own regimes in each: minutes, not one.
SETTINGS ?= --setting all
# make report EXTENT= takes every step and cell of the benchmark and the stability maps: half an hour.
EXTENT ?= --quick

DOCUMENTED := $(VENV)/.documented
BROWSER    := $(VENV)/.browser
# Engines that are not of all: each has an environment of its own, .venv-NAME. make nightly-engines ENGINES=drake takes one.
ENGINES ?= drake pinocchio mjx mujoco-warp

.PHONY: report pages pictures docs pins browser test nightly nightly-engines lint baseline release-check clean

report: $(READY)  ## every mechanism in every engine and setting, cost and stability; page at build/report/index.html
	rm -rf build/report/bench build/report/stress  # --out alone, without --quick, would only write their pages again
	$(BIN)/linkproof bench $(EXTENT) --out build/report
	$(BIN)/linkproof stress $(EXTENT) --out build/report
	$(BIN)/linkproof compare --regime run-up --regime run-up-quintic --regime own $(SETTINGS) --out build/report

pages: $(READY)  ## pictures of every page of build/report, wide and narrow, light and dark, in build/pages; needs Chromium
	$(BIN)/python -m tests.pages.show build/report build/pages

pictures: $(READY)  ## the documentation's pictures and its notebook, from today's output and build/report; needs Chromium
	$(BIN)/python -m docs.making.pictures

docs: $(DOCUMENTED)  ## the documentation, from docs/ to build/docs/index.html; it opens from the disk and loads nothing
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict --quiet

pins: $(READY)  ## every pinned record made anew and held; python tests/pins/pins.py take renews them
	$(BIN)/python tests/pins/pins.py hold

browser: $(BROWSER)  ## a browser for the tests of pages, where there is none: Debian's Chromium as root, else Playwright's

test: $(READY)  ## the tests of every change, on all cores; without a browser those of pages are skipped
	$(BIN)/python -m pytest --numprocesses auto --dist worksteal

nightly: $(READY)  ## the tests that take minutes: every mutant in every engine, killed campaigns, the wheel, whole literature
	$(BIN)/python -m pytest --numprocesses auto --dist worksteal -m nightly

nightly-engines: $(ENGINES:%=nightly-engine-%)  ## every test of each engine that is not of all, whatever its duration

nightly-engine-%: .venv-%/.installed
	.venv-$*/bin/python -m pytest --numprocesses auto --dist worksteal -m 'nightly or not nightly' -k $*

lint: $(READY)  ## style, types and the direction of imports
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

baseline: $(READY)  ## record today's deviations as those to be held in future, in tests/baseline.csv
	$(BIN)/linkproof compare --regime run-up --regime run-up-quintic --setting tuned --setting best --record tests/baseline.csv

release-check: $(READY)  ## sdist and wheel in build/release, each installed anew, with README's commands and the type checker
	$(BIN)/python -m tests.linkproof.release build/release

clean:
	rm -rf build $(VENV) .venv-*

# Installed once; again only when the dependencies change.
$(READY): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[all,dev]'
	touch $@

$(DOCUMENTED): $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[docs]'
	touch $@

.PRECIOUS: .venv-%/.installed
.venv-%/.installed: pyproject.toml
	$(PYTHON) -m venv .venv-$*
	.venv-$*/bin/python -m pip install --quiet --disable-pip-version-check --editable '.[$*,dev]'
	touch $@

$(BROWSER): $(READY)
	$(BIN)/python -m tests.pages.browser \
	|| { [ "$$(id -u)" = 0 ] && apt-get update -qq \
	     && DEBIAN_FRONTEND=noninteractive apt-get install -qq --yes --no-install-recommends chromium fonts-liberation; } \
	|| $(BIN)/python -m playwright install --with-deps chromium
	$(BIN)/python -m tests.pages.browser
	touch $@
