# The commands of the visual speech workbench. `make run` and `make test` are all a newcomer needs.
#   make run [CORPUS=folder] [PORT=n]   serve the workbench and open the browser
#   make test [SYSTEM=1]                lint and every test (SYSTEM=1 installs the Debian packages that tests need)
# Also: setup check-run test-fast lint bench lab. PYTHON=... chooses the interpreter of .venv.
SHELL := /bin/bash
.DEFAULT_GOAL := help
.PHONY: help setup run check-run test test-fast lint bench lab system

BIN := .venv/bin
# BLAS and OpenMP would fight over the cores and sum in another order: one thread each in tests
ONE_THREAD := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1

help:
	@sed -n '1,/^SHELL/{/^#/s/^# \?//p}' Makefile

setup:
	@PYTHON="$(PYTHON)" .ci/setup

run: setup
	@$(BIN)/workbench $(if $(PORT),--port $(PORT)) $(if $(CORPUS),"$(CORPUS)")

check-run: setup
	@$(BIN)/workbench --check $(if $(CORPUS),"$(CORPUS)")

system:
	@.ci/system-packages $(if $(SYSTEM),--install)

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# one worker for each processor, at most four; the tests of a file stay together, for what they share
WORKERS := --numprocesses=auto --maxprocesses=4 --dist=loadfile

test: system lint
	$(ONE_THREAD) $(BIN)/python -m pytest $(WORKERS)

test-fast: setup
	$(ONE_THREAD) $(BIN)/python -m pytest $(WORKERS) -m "not slow and not browser and not render and not real"

# stages against named peers, stages over time, and a drag of the g(u) slider until the head's pixels have changed
RESULTS := tests/benchmarks/results
bench: setup
	@mkdir -p $(RESULTS)
	$(ONE_THREAD) $(BIN)/corpus-tools bench $(if $(CORPUS),--corpus "$(CORPUS)") --out $(RESULTS)/latest-stages.json
	$(ONE_THREAD) $(BIN)/python -m pytest -q tests/benchmarks --override-ini "addopts=--import-mode=importlib" \
	  --benchmark-only --benchmark-columns=min,median,rounds
	$(ONE_THREAD) $(BIN)/python tests/benchmarks/browser_latency.py $(if $(CORPUS),--corpus "$(CORPUS)") \
	  --json $(RESULTS)/latest-browser.json
	$(ONE_THREAD) $(BIN)/python tests/benchmarks/hosts_latency.py $(if $(CORPUS),--corpus "$(CORPUS)") \
	  --json $(RESULTS)/latest-hosts.json

# the notebooks are .py files: JupyterLab opens them as notebooks, and asks no server for news
lab: setup
	@mkdir -p .venv/share/jupyter/lab/settings
	@cp .ci/lab-overrides.json .venv/share/jupyter/lab/settings/overrides.json
	PANEL_INLINE=true $(BIN)/jupyter lab --notebook-dir=notebooks $(ARGS)
