# Two commands do everything on a fresh machine with Python >= 3.11, make and git: make report, make test.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.installed

.PHONY: report test lint baseline clean

report: $(READY)  ## both needle mechanisms in every engine and setting; page at build/report/index.html
	$(BIN)/linkproof compare --regime run-up --regime run-up-quintic --setting all --out build/report

test: $(READY)  ## the whole test suite
	$(BIN)/python -m pytest

lint: $(READY)  ## style, types and the direction of imports
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

baseline: $(READY)  ## record today's deviations as those to be held in future
	$(BIN)/linkproof compare --regime run-up --regime run-up-quintic --setting tuned --setting best --record-baseline

clean:
	rm -rf build $(VENV)

# Installed once; again only when the dependencies change.
$(READY): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[all,dev]'
	touch $@
