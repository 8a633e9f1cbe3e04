# Everything a person does with a checkout.  Each target sets up what it needs.

RUN_FOLDER := $(or $(RUN_FOLDER),runs/$(shell date +%Y%m%d-%H%M%S))

# The Python that makes .venv: the first of these that is new enough, or the one given as PYTHON=...
PYTHONS = $(or $(PYTHON),python3.11 python3 python3.13 python3.12)

BIN := .venv/bin
STAMP := .venv/installed
PACKAGES := ctlblocks rigkit vibractl stagectl calibration firmware_sim vibrostage
STUDIES = $(basename $(notdir $(wildcard studies/*.toml)))
TABLES := identification measured_pairs planning force_control
KEY = $(shell cat pyproject.toml | sha256sum | cut -c1-16) $(CURDIR)

.PHONY: run test check soak bench studies peers thesis mutants setup packages docs site dist clean help

help:            ## this list
	@grep -hE '^[a-z]+: .*##' $(MAKEFILE_LIST) | sed 's/:.*##/\t/' | expand -t 10

setup:           ## .venv with everything installed; quick when it is there
	@test "$$(cat $(STAMP) 2>/dev/null)" = "$(KEY)" || $(MAKE) --no-print-directory install

run: setup       ## the main job: identify and learn on the simulated vibrator, then a report
	@mkdir -p $(RUN_FOLDER)
	$(BIN)/calibrate vibrator --out $(RUN_FOLDER)/model.h5
	$(BIN)/vibractl run --model $(RUN_FOLDER)/model.h5 --reference chirp:40:90:5 --shots 30 --out $(RUN_FOLDER)/run

# Where a machine forbids it, each of a thousand commands compiles all sources anew: half a second of 2 s.
unexport PYTHONDONTWRITEBYTECODE

# As the services run: more threads of linear algebra than cores take three times as long.
test soak: export OPENBLAS_NUM_THREADS := 1

test: setup packages  ## the tests, without the slow ones and those that need a rig
	$(BIN)/pytest -q -n 3 --dist loadfile --no-loadscope-reorder -m "not rig and not slow and not deadline"
	$(BIN)/pytest -q -m "deadline and not rig and not slow" $$(grep -rlF --include='*.py' mark.deadline tests)

check: setup     ## ruff, mypy, import contracts
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

soak: setup packages  ## the slow tests: about an hour, or SHARD=2/4 of them
	$(BIN)/pytest -q -m slow --timeout=1800 --splits $(or $(word 2,$(subst /, ,$(SHARD))),1) --group $(or $(word 1,$(subst /, ,$(SHARD))),1)

bench: setup packages ## speed beside peers, then the tables of docs/ that no study makes: an hour
	$(BIN)/pytest -q benchmarks --benchmark-only
	for table in $(TABLES) home; do $(BIN)/python -m benchmarks.$$table --write || exit 1; done

studies: setup   ## the studies of studies/ at full size, up to hours each, then their tables in docs/; goes on after a stop; STUDIES=stages, SCHEDULER=tcp://...
	@mkdir -p runs/studies
	for study in $(STUDIES); do \
	  $(BIN)/vibrostage study run studies/$$study.toml --out runs/studies/$$study $(if $(SCHEDULER),--scheduler $(SCHEDULER)) || exit 1; \
	done
	$(BIN)/python -m benchmarks.study_tables $(STUDIES:%=runs/studies/%)

peers: setup     ## docs/peers.md, docs/identification-peers.md: beside other packages, which it installs: a quarter of an hour
	@$(BIN)/pip install --quiet --disable-pip-version-check -e '.[peers]'
	$(BIN)/python -m benchmarks.identification_peers > docs/identification-peers.new
	mv docs/identification-peers.new docs/identification-peers.md
	$(BIN)/python -m benchmarks.response_peers --write
	$(BIN)/python -m benchmarks.peers --write

thesis: setup    ## docs/thesis.md: every figure and table of the thesis beside ours, twenty minutes; goes on after a stop
	$(BIN)/python -m benchmarks.thesis --write

mutants: setup   ## faults put into the code on purpose, which tests should catch: MUTANTS=30 of the sample of 300, an hour
	@$(BIN)/pip install --quiet --disable-pip-version-check -e '.[mutants]'
	$(BIN)/python -m benchmarks.mutants --count $(or $(MUTANTS),300)

docs: setup      ## regenerate what is generated: docs/*.toml, docs/config-reference/, stagectl/stage.dbc, rigkit/relay/relay.dbc
	$(BIN)/vibractl example-config > docs/rig.toml
	$(BIN)/stagectl example-config > docs/stage.toml
	$(BIN)/stagectl example-cell > docs/cell.toml
	$(BIN)/python -m rigkit.config_reference vibractl.config:RigConfig rig.toml > docs/config-reference/rig.md
	$(BIN)/python -m rigkit.config_reference stagectl.config:StageConfig stage.toml > docs/config-reference/stage.md
	$(BIN)/python -m rigkit.config_reference stagectl.robot.config:CellConfig cell.toml > docs/config-reference/cell.md
	$(BIN)/python -m rigkit.config_reference rigkit.study.file:StudyFile STUDY.toml > docs/config-reference/study.md
	$(BIN)/python -m rigkit.config_reference rigkit.study.file:Figure "[figures.NAME]" > docs/config-reference/figure.md
	$(BIN)/python -m tests.commands.experiments_page > docs/experiments.md
	$(BIN)/python -c 'import sys; from stagectl.wire.dbc import dbc_text; sys.stdout.write(dbc_text())' > stagectl/stage.dbc
	$(BIN)/python -c 'import sys; from rigkit.relay.frame import dbc_text; sys.stdout.write(dbc_text())' > rigkit/relay/relay.dbc

dist: setup      ## dist/: source distribution and wheel, checked by twine
	@$(BIN)/pip install --quiet --disable-pip-version-check build twine
	rm -rf dist && $(BIN)/python -m build --outdir dist .
	$(BIN)/twine check --strict dist/*

site: setup      ## build/site/: the pages of docs/, tutorials, a gallery that is run, references; a warning fails it
	@$(BIN)/pip install --quiet --disable-pip-version-check -e '.[site]'
	$(BIN)/sphinx-build -W --keep-going -q -b html site build/site

clean:           ## remove .venv, caches and builds
	rm -rf .venv build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis .benchmarks .schemathesis
	find $(PACKAGES) tests benchmarks examples -name __pycache__ -type d -prune -exec rm -rf {} +

# --- what the targets above are made of ---------------------------------------------------------

.PHONY: install
install:
	@if ! $(BIN)/pip --version >/dev/null 2>&1; then \
	  for python in $(PYTHONS) ""; do \
	    if [ -z "$$python" ]; then echo "of $(PYTHONS) none is Python >= 3.11; say make PYTHON=/path/to/python3"; exit 1; fi; \
	    if $$python -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then break; fi; \
	  done; \
	  if ! $$python -c 'import ensurepip, venv' 2>/dev/null; then \
	    echo "$$python cannot make a virtual environment: it has no ensurepip.  On Debian and Ubuntu:"; \
	    $$python -c 'import sys; print("  apt-get install python%d.%d-venv" % sys.version_info[:2])'; \
	    echo "or say make PYTHON=/path/to/python3"; exit 1; \
	  fi; \
	  echo "making .venv with $$python"; $$python -m venv --clear .venv; \
	fi
	@echo "installing into .venv"
	@$(BIN)/pip install --quiet --disable-pip-version-check -e '.[dev]'
	@echo "$(KEY)" > $(STAMP)

# PortAudio and JACK for the tests that go through a real audio server, Chromium for those of the daemon's page (300 MB);
# they say why they skip where one is missing.
packages:
	@missing=""; \
	ldconfig -p 2>/dev/null | grep -q libportaudio || missing="$$missing libportaudio2"; \
	command -v jackd >/dev/null || missing="$$missing jackd2"; \
	command -v chromedriver >/dev/null || missing="$$missing chromium-driver"; \
	if [ -z "$$missing" ]; then exit 0; fi; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	  echo "installing$$missing"; \
	  export DEBIAN_FRONTEND=noninteractive; \
	  apt-get update -qq; \
	  for package in $$missing; do \
	    apt-get install -y -qq --no-install-recommends $$package >/dev/null \
	      || echo "apt-get could not install $$package: the tests that need it will be skipped"; \
	  done; \
	else \
	  echo "not installed:$$missing (apt-get install$$missing): the tests that need them will be skipped"; \
	fi
