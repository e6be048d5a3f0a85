# `make demo` and `make test` each work first thing in a fresh clone: all they need is
# Python 3.11 or newer, and make.

PYTHON ?= python3
# Another Python has an environment of its own: make test PYTHON=python3.13
VENV := .venv$(if $(filter-out python3,$(PYTHON)),-$(notdir $(PYTHON)))
BIN := $(VENV)/bin
CONSTRAINTS := .ci/constraints.txt
DEMO := demo_output
TRIES := 40
SEED := $(shell date +%s)
MUTANTS := 60
PAGE := dogbot_logtool/report/page
PLOTTING := plotly.js-basic-dist-min@4.1.1
SAMPLE := sample_logs/dogbot_trot.bag

export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PIP_NO_PYTHON_VERSION_WARNING := 1

.PHONY: help demo test test-slow lint format samples golden fuzz torture mutants bench guard docs pictures validate vendor clean

help:
	@echo "make demo     convert a sample log and look at it"
	@echo "make test     run the tests; ARGS: words for pytest"
	@echo "make test-slow run the tests that take many seconds each"
	@echo "make lint     style and types"
	@echo "make format   format the code"
	@echo "make samples  write the sample logs anew"
	@echo "make fuzz     harm 20,000 logs of each kind at random; some ten minutes"
	@echo "make torture  interrupt the program at random moments, TRIES=40 of each kind"
	@echo "make mutants  change the core at random, MUTANTS=60 times, and see whether tests notice"
	@echo "make golden   agree anew on what is made of the sample logs"
	@echo "make docs     write the pages that are made of the program's tables"
	@echo "make vendor   fetch the library that draws the report's page anew"
	@echo "make pictures take the documentation's pictures anew, in Chromium (CHROMIUM=/usr/bin/chromium)"
	@echo "make validate measure logs of known truth, and write docs/validation.md"
	@echo "make bench    measure against what one would use instead; some ten minutes"
	@echo "make guard    measure a minute's worth of that: ratios must not be far from what they were"
	@echo "make clean    remove what the others made"

$(VENV)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "Python 3.11 or newer is needed; name one: make PYTHON=python3.12 ..."; exit 1; }
	@$(PYTHON) -m venv $(VENV)
	@touch $@

$(VENV)/runtime: $(VENV)/python pyproject.toml $(CONSTRAINTS)
	@echo "installing dogbot-logtool in $(VENV) ..."
	@$(BIN)/python -m pip install --quiet --editable . --constraint $(CONSTRAINTS)
	@touch $@

$(VENV)/dev: $(VENV)/python pyproject.toml $(CONSTRAINTS)
	@echo "installing dogbot-logtool and its tools in $(VENV) ..."
	@$(BIN)/python -m pip install --quiet --editable '.[dev]' --constraint $(CONSTRAINTS)
	@touch $(VENV)/runtime $@

demo: $(VENV)/runtime
	@mkdir -p $(DEMO)
	@echo '$$ dogbot-logtool convert $(SAMPLE) -o $(DEMO) --overwrite'
	@$(BIN)/dogbot-logtool convert $(SAMPLE) -o $(DEMO) --overwrite --verbose
	@echo
	@echo '$$ dogbot-logtool layout -o $(DEMO)/dogbot.layout.json --overwrite'
	@$(BIN)/dogbot-logtool layout -o $(DEMO)/dogbot.layout.json --overwrite
	@echo
	@echo 'To see it: open $(DEMO)/dogbot_trot.annotated.mcap in Foxglove or Lichtblick,'
	@echo 'then import $(DEMO)/dogbot.layout.json from its layout menu.'
	@echo
	@echo '$$ dogbot-logtool info $(DEMO)/dogbot_trot.annotated.mcap'
	@$(BIN)/dogbot-logtool info $(DEMO)/dogbot_trot.annotated.mcap

# Tests start many processes, which need not compile all modules each time.
test test-slow: export PYTHONDONTWRITEBYTECODE :=
test: $(VENV)/dev
	$(BIN)/python -m pytest --numprocesses=auto --dist=worksteal -m "not slow" $(ARGS)

test-slow: $(VENV)/dev
	$(BIN)/python -m pytest --numprocesses=auto --dist=worksteal -m slow $(ARGS)

lint: $(VENV)/dev
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

format: $(VENV)/dev
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

fuzz: $(VENV)/dev
	$(BIN)/python -m pytest -q --numprocesses=auto --hypothesis-profile=fuzz tests/reader/test_fuzz.py -k random_harm

torture: $(VENV)/dev
	TRIES=$(TRIES) SEED=$(SEED) $(BIN)/python -m pytest -m slow tests/torture

mutants: $(VENV)/dev
	@$(BIN)/python -m pip install --quiet --editable '.[dev,mutants]' --constraint $(CONSTRAINTS)
	$(BIN)/python -m tests.mutants.sample --count $(MUTANTS)

docs: $(VENV)/dev
	$(BIN)/python docs/pages.py
	$(BIN)/python docs/notebook.py

pictures: $(VENV)/dev
	@$(BIN)/python -m pip install --quiet --editable '.[dev,report]' --constraint $(CONSTRAINTS)
	$(BIN)/python docs/pictures.py

# npm compares the package with the registry's checksum.
vendor:
	rm -rf build/vendor && mkdir -p build/vendor
	cd build/vendor && npm pack --silent $(PLOTTING) && tar xzf *.tgz
	cp build/vendor/package/plotly-basic.min.js $(PAGE)/vendor/plotly-basic.min.js
	cp build/vendor/package/LICENSE $(PAGE)/vendor/plotly.LICENSE
	cd $(PAGE)/vendor && sha256sum plotly-basic.min.js

# LOGTOOL_LABELLED=FOLDER adds real logs with labelled events: NAME.mcap, NAME.events.json.
validate: $(VENV)/dev
	$(BIN)/python -m tests.truth.validate

golden: $(VENV)/dev
	$(BIN)/python sample_logs/golden.py

bench: $(VENV)/dev
	@$(BIN)/python -m pip install --quiet --editable '.[dev,bench]' --constraint $(CONSTRAINTS)
	$(BIN)/python benchmarks/run.py $(ARGS)

guard: $(VENV)/dev
	$(BIN)/python benchmarks/run.py --guard

samples: $(VENV)/dev
	$(BIN)/python sample_logs/generate.py

clean:
	rm -rf .venv .venv-* $(DEMO) build *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis
