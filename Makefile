# make demo   the four sample papers at their matched settings and two packs, into out/
# make test   the tests (make test-all: with the slow ones)
# make lint   ruff, mypy, shader compilers
# make coverage   branch coverage of `make test`, with a page in out/coverage
# make observers  the table of docs/experiment.md on simulated observers, into out/ (hours; OBSERVERS="--studies 5")
# make interruptions   1,000 signals at random moments of every command (an hour; INTERRUPTIONS="--count 100")
# make mutants    300 seeded faults in the heart: which of them does a test notice? (an hour)
# make lock   renews requirements/ (LOCK=--upgrade: in the newest versions)
# make dependencies   licences and known advisories of everything that is installed

VENV ?= .venv
PYTHON ?= python3
BIN := $(VENV)/bin
# What is installed is what the tests ran with, file by file. On this platform there is a wheel of
# each package; elsewhere some have to be built, by tools that no hash covers.
ifeq ($(shell uname -sm),Linux x86_64)
LOCKED ?= --require-hashes --only-binary :all:
else
LOCKED ?= --require-hashes
endif
# Worker processes of the tests; each has its own OpenGL context. A file's tests share a process, so
# that a window or a browser that they look at is opened once.
WORKERS ?= 2

.PHONY: demo test test-all coverage observers interruptions mutants lint format lock dependencies clean

demo: $(VENV)/.runtime
	$(BIN)/python scripts/demo.py out

test: $(VENV)/.development
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile -m "not slow"

test-all: $(VENV)/.development
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile

coverage: $(VENV)/.development
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile -m "not slow" --cov --cov-report=term --cov-report=html

OBSERVERS ?= --studies 34
observers: $(VENV)/.runtime
	mkdir -p out
	$(BIN)/relgloss experiment simulate paper --kind all --truth cells --json $(OBSERVERS) > out/observers.json
	$(BIN)/python scripts/observer_table.py out/observers.json | tee out/observers.md

INTERRUPTIONS ?= --count 1000
interruptions: $(VENV)/.development
	$(BIN)/python scripts/interrupt.py --workers $(WORKERS) $(INTERRUPTIONS)

# MUTANTS="--module tone --seed 2", for one part and other faults
mutants: $(VENV)/.development
	$(BIN)/python scripts/mutants.py --jobs $(WORKERS) $(MUTANTS)

lint: $(VENV)/.development
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy

format: $(VENV)/.development
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

lock: $(VENV)/.development
	PATH="$(abspath $(BIN)):$$PATH" $(BIN)/python scripts/lock.py $(LOCK)

# DEPENDENCIES="--advisories FOLDER --index", for more sources of advisories
dependencies: $(VENV)/.development
	$(BIN)/python scripts/dependencies.py $(DEPENDENCIES)

# The runtime environment is enough to draw; the development one adds what tests and lint need.
$(VENV)/.runtime: pyproject.toml requirements/runtime.txt
	PYTHON="$(PYTHON)" scripts/system-packages demo
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install -q $(LOCKED) -r requirements/runtime.txt
	$(BIN)/python -m pip install -q --no-deps --no-build-isolation -e .
	touch $@

$(VENV)/.development: $(VENV)/.runtime requirements/development.txt requirements/gltf-validator/package-lock.json
	PYTHON="$(PYTHON)" scripts/system-packages test
	$(BIN)/python -m pip install -q $(LOCKED) -r requirements/development.txt
	npm ci --prefix requirements/gltf-validator --ignore-scripts --no-audit --no-fund --loglevel=error
	touch $@

clean:
	rm -rf $(VENV) requirements/gltf-validator/node_modules out build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
